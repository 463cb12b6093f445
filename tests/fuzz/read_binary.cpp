// The readers of .trk and .imu, with any bytes behind a magic: what is read can be written as .imu
// of version 2, and reads back to as many samples.
#include "host_sim/recording/imu2.hpp"
#include "tests/fuzz/recordings.hpp"

using namespace fairlead;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    sim::ReadOptions options{(data[0] & 1) != 0 ? sim::Salvage::yes : sim::Salvage::no};
    if ((data[0] & 2) != 0) options.sensors = "gyro,accel";
    std::string bytes = (data[0] & 4) != 0 ? "TRK1" : "IMR1";
    bytes.append(reinterpret_cast<const char*>(data + 1), size - 1);
    const auto recording = fuzz::read(bytes, "x.imu", options);
    if (!recording || recording->samples.empty()) return 0;
    try {
        const sim::Recording again = sim::parse_recording(sim::to_imu2(*recording), "again");
        FUZZ_EXPECT(again.samples.size() == recording->samples.size());
    } catch (const sim::BadData&) {
        FUZZ_EXPECT(!recording->version2 || !recording->damage.empty());
    }
    return 0;
}
