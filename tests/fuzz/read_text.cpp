// The readers of text, with any bytes: they read or refuse, and never do anything else.
#include <cstddef>
#include <cstdint>

#include "host_sim/recording/plausible.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/writers.hpp"

using namespace fairlead::sim;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    ReadOptions options{(data[0] & 1) != 0 ? Salvage::yes : Salvage::no};
    if ((data[0] & 2) != 0) options.rate_hz = 100;
    if ((data[0] & 4) != 0) options.columns = "t_us,gx,gy,gz,ax,ay,az";
    if ((data[0] & 8) != 0) options.units = "t=us,gyro=deg/s,accel=g";
    const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
    try {
        const Recording recording = parse_recording(text, "Gyroscope.csv", options);
        static_cast<void>(doubts(recording));
        // what was read can be written, and reads back to as many records
        const std::string again =
            recording.samples.empty() ? to_poses_csv(recording.poses) : to_imu_csv(recording);
        if (!recording.samples.empty() || !recording.poses.empty()) {
            try {
                if (parse_recording(again, "again").size() != recording.size()) __builtin_trap();
            } catch (const BadData&) {
                if (recording.samples.empty()) __builtin_trap();
            }
        }
    } catch (const BadData&) {
    } catch (const BadSpec&) {
    }
    return 0;
}
