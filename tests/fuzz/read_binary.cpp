// The readers of .trk and .imu, with any bytes behind a magic: they read or refuse.
#include <cstddef>
#include <cstdint>
#include <string>

#include "host_sim/recording/imu2.hpp"
#include "host_sim/recording/plausible.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/writers.hpp"

using namespace fairlead::sim;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    ReadOptions options{(data[0] & 1) != 0 ? Salvage::yes : Salvage::no};
    if ((data[0] & 2) != 0) options.sensors = "gyro,accel";
    std::string bytes = (data[0] & 4) != 0 ? "TRK1" : "IMR1";
    bytes.append(reinterpret_cast<const char*>(data + 1), size - 1);
    try {
        const Recording recording = parse_recording(bytes, "x", options);
        static_cast<void>(doubts(recording));
        if (recording.samples.empty()) return 0;
        try {
            const Recording again = parse_recording(to_imu2(recording), "again");
            if (again.samples.size() != recording.samples.size()) __builtin_trap();
        } catch (const BadData&) {
            if (recording.version2 && recording.damage.empty()) __builtin_trap();
        }
    } catch (const BadData&) {
    } catch (const BadSpec&) {
    }
    return 0;
}
