// A complete firmware: records from an interrupt, through the pipeline, out of the UART as frames.
// Everything that needs memory is static: RAM is what the linker says.
#include "examples/firmware/config.hpp"
#include "examples/firmware/retarget.hpp"

namespace {

fairlead::Pipeline<Config> pipeline{Config::params()};

}  // namespace

int main() {
    board::start();
    fairlead::Pose record;
    while (board::next(record)) {
        const fairlead::Bytes frames = pipeline.push(record);
        board::send(frames.data, frames.size);
    }
    for (auto frames = pipeline.flush(); !frames.empty(); frames = pipeline.flush())
        board::send(frames.data, frames.size);
    board::stop();
}
