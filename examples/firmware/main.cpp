// A complete firmware: records from an interrupt, through the pipeline, out of the UART as frames.
// Everything that needs memory is static: RAM is what the linker says.
#include "examples/firmware/config.hpp"
#include "examples/firmware/run.hpp"

namespace {

Config::Pipeline pipeline{Config::params()};

}  // namespace

int main() { board::run<fairlead::Pose>(pipeline); }
