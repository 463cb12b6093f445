// The frame of the example in docs/port.md.
#include "port/linux/clock.hpp"
#include "port/linux/gpio.hpp"
#include "port/linux/i2c.hpp"
#include "port/linux/sampler.hpp"
#include "port/sensors/lsm6.hpp"

using namespace fairlead;
using namespace fairlead::port;

void use(const Sample& sample);

int example() {
#include "example.inc"
}
