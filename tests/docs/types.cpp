// The frame around the example of docs/types.md.
#include <cstdint>

#include "fairlead/base/types.hpp"

struct Raw {
    std::int64_t t_us;
    float gx, gy, gz, ax, ay, az;
};

#include "example.inc"
