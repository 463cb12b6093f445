// A complete firmware for a bare IMU: samples from an interrupt, orientation, frames out of the
// UART. Everything that needs memory is static: RAM is what the linker says.
#include "examples/firmware/retarget.hpp"
#include "fairlead/pipeline2.hpp"

namespace {

struct Board {
    using Input = fairlead::Imu<fairlead::AttitudeMode::imu>;  // gyro and accelerometer
    using Channels = fairlead::Channels<fairlead::Orientation>;
    using Filter = fairlead::PoseFilter<5>;               // centred: 2 samples late
    static constexpr std::size_t delay_records_max = 32;  // samples: 0.32 s
    static constexpr fairlead::Beam beam = fairlead::Beam::narrow;
    static constexpr std::size_t events_max = 0;  // a board without buttons
};
using Pipeline = fairlead::Pipeline2<Board>;

Pipeline::Params params() {
    Pipeline::Params p;
    p.sample_period_ns = 10'000'000;           // 100 samples a second
    p.tolerance.orientation_rad = 0.0087266f;  // 0.5 degrees
    p.filter = Board::Filter{fairlead::binomial_mask<5>()};
    p.calibration.gyro.offset = {0.01f, -0.02f, 0.005f};  // rad/s, found on this board
    return p;
}

Pipeline pipeline{params()};

}  // namespace

int main() {
    board::start();
    if (!pipeline.check()) board::stop();  // a parameter is refused; check().field names it
    fairlead::Sample sample;
    while (board::next(sample)) {
        const fairlead::Bytes frames = pipeline.push(sample);
        board::send(frames.data, frames.size);
    }
    for (;;) {
        const fairlead::Bytes frames = pipeline.flush();
        board::send(frames.data, frames.size);
        if (frames.status == fairlead::Status::end) break;
    }
    board::stop();
}
