// Every reader of files: whatever the bytes are, they are read, or refused with a text that names
// the file. Text, .imu and .trk by content; with and without salvage, with columns and units given.
#include "host_sim/recording/recording.hpp"

#include <string>

#include "host_sim/recording/event_file.hpp"
#include "host_sim/recording/spec.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::sim;

void read(std::string_view bytes, const ReadOptions& options) {
    try {
        const Recording r = parse_recording(bytes, "fuzz", options);
        FUZZ_EXPECT(r.poses.empty() || r.samples.empty());
        FUZZ_EXPECT(r.truth.empty() || r.truth.size() == r.samples.size());
        FUZZ_EXPECT(options.salvage == Salvage::yes || r.damage.empty());
        FUZZ_EXPECT(r.size() <= bytes.size());
    } catch (const BadData& e) {
        FUZZ_EXPECT(std::string{e.what()}.find("fuzz") != std::string::npos);
    } catch (const BadSpec&) {
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view bytes{reinterpret_cast<const char*>(data + 1), size - 1};
    ReadOptions options;
    if (data[0] & 1) options.salvage = Salvage::yes;
    if (data[0] & 2) options.columns = "t_ns,gx,gy,gz,ax,ay,az";
    if (data[0] & 4) options.units = "t=us,gyro=deg/s,accel=g";
    if (data[0] & 8) options.rate_hz = 100;
    if (data[0] & 16) options.sensors = "gyro,accel";
    read(bytes, options);
    if (data[0] & 32) {
        try {
            static_cast<void>(parse_events(bytes, "fuzz"));
        } catch (const BadData&) {
        }
    }
    return 0;
}
