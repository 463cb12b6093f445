#pragma once
// How one frame hands over to the next.
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead::reduce {

enum class Seam : std::uint8_t {
    carry,    // the next frame goes on with the state of this one
    restart,  // the frame tells where it ends; who joins draws from the second piece of the next
    independent,  // likewise, and the next frame tells its slope too: it can be decoded alone
};

}  // namespace fairlead::reduce
