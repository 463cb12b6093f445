// A complete firmware for a bare IMU: samples from an interrupt, orientation, frames out of the
// UART. Everything that needs memory is static: RAM is what the linker says.
#include "examples/firmware/config_imu.hpp"
#include "examples/firmware/run.hpp"

namespace {

Config::Pipeline pipeline{Config::params()};

}  // namespace

int main() { board::run<fairlead::Sample>(pipeline); }
