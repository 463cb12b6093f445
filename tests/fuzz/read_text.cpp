// The readers of text, with any bytes and options: what is read can be written, and reads back to
// as many records.
#include "tests/fuzz/recordings.hpp"

using namespace fairlead;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    sim::ReadOptions options{(data[0] & 1) != 0 ? sim::Salvage::yes : sim::Salvage::no};
    if ((data[0] & 2) != 0) options.rate_hz = 100;
    if ((data[0] & 4) != 0) options.columns = "t_us,gx,gy,gz,ax,ay,az";
    if ((data[0] & 8) != 0) options.units = "t=us,gyro=deg/s,accel=g";
    const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
    const auto recording = fuzz::read(text, "Gyroscope.csv", options);
    if (!recording || recording->size() == 0) return 0;
    const bool imu = !recording->samples.empty();
    const std::string written =
        imu ? sim::to_imu_csv(*recording) : sim::to_poses_csv(recording->poses);
    const auto again = fuzz::read(written, "again");
    // samples may hold what the reader of a file must refuse; poses may not
    FUZZ_EXPECT(again || imu);
    FUZZ_EXPECT(!again || again->size() == recording->size());
    return 0;
}
