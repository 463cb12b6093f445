// What fairlead-record leaves on the disk when it is cut at any byte.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdio>
#include <cstring>
#include <string>

#include "examples/record/rotation.hpp"
#include "examples/record/writer.hpp"
#include "host_sim/recording/imu2.hpp"
#include "host_sim/recording/recording.hpp"

namespace fairlead {
namespace {

constexpr std::uint32_t all_fields = sim::imu_field::gyro | sim::imu_field::accel |
                                     sim::imu_field::mag | sim::imu_field::temperature;

std::vector<Sample> samples(int n) {
    std::vector<Sample> out;
    for (int i = 0; i < n; ++i) {
        Sample s;
        s.t_ns = 5000000000 + i * 2399877LL;  // not in whole microseconds, as sensors have them
        const auto v = static_cast<float>(i);
        s.gyro_rad_s = {0.1f * v, 1, -2};
        s.accel_m_s2 = {v, 0.5f, 9.8f};
        s.flags = flag::gyro_valid | flag::accel_valid | flag::temperature_valid;
        s.temperature_c = 20 + 0.25f * v;
        if (i % 3 == 0) {  // a slower sensor
            s.mag_uT = {20, -0.5f * v, -40};
            s.flags |= flag::mag_valid;
        }
        if (i == 5) s.flags |= flag::gap_before;
        if (i == 6) s.flags |= flag::clipped | flag::accel_clipped;
        out.push_back(s);
    }
    return out;
}

class RecordFile : public ::testing::TestWithParam<const char*> {
  protected:
    std::string path = ::testing::TempDir() + "fairlead_record" + GetParam();
    RecordFile() { std::remove(path.c_str()); }
    ~RecordFile() override { std::remove(path.c_str()); }
};

TEST_P(RecordFile, HoldsWhatWasAppended) {
    record::Writer writer;
    const auto all = samples(20);
    ASSERT_TRUE(writer.open(path, "LSM6DSO", 0.0024, all_fields)) << writer.error();
    ASSERT_TRUE(writer.append({all.begin(), all.begin() + 7}));
    ASSERT_TRUE(writer.append({}));
    ASSERT_TRUE(writer.append({all.begin() + 7, all.end()}));
    ASSERT_TRUE(writer.close());
    const sim::Recording r = sim::read_recording(path);
    ASSERT_EQ(r.samples.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Sample &a = r.samples[i], &b = all[i];
        EXPECT_EQ(a.t_ns, b.t_ns);
        EXPECT_EQ(a.flags, b.flags) << i;
        EXPECT_EQ(std::memcmp(&a, &b, offsetof(Sample, temperature_c) + sizeof(float)), 0) << i;
    }
    EXPECT_FALSE(writer.open(path, "again", 0.0024, all_fields)) << "it must not overwrite";
}

TEST_P(RecordFile, ACutAtAnyByteKeepsEveryCompleteRecord) {
    const bool binary = std::string{GetParam()} == ".imu";
    std::string bytes;
    {
        record::Writer writer;  // killed: copied while it is open
        ASSERT_TRUE(writer.open(path, "LSM6DSO", 0.0024, all_fields));
        ASSERT_TRUE(writer.append(samples(12)));
        bytes = sim::read_bytes(path);
    }
    const std::size_t header = binary ? 128 : bytes.find('\n') + 1;
    for (std::size_t cut = header; cut <= bytes.size(); ++cut) {
        const std::size_t size = sim::imu2_record_size(all_fields);
        const std::string_view kept{bytes.data(), cut};
        std::size_t complete = binary ? (cut - 128) / size : 0;
        for (std::size_t i = header; !binary && i < cut; ++i)
            complete += bytes[i] == '\n' ? 1u : 0u;
        std::size_t got = 0;
        try {
            got = sim::parse_recording(kept, "cut", sim::Salvage::yes).samples.size();
        } catch (const sim::BadData&) {
            EXPECT_LE(complete, 1u) << "refused at " << cut;
            continue;
        }
        EXPECT_GE(got, complete) << "cut at " << cut;
        EXPECT_LE(got, complete + (binary ? 0u : 1u)) << "cut at " << cut;
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, RecordFile, ::testing::Values(".imu", ".csv"));

TEST(Record, RefusesOtherFormats) {
    record::Writer writer;
    EXPECT_FALSE(writer.open("/tmp/x.txt", "", 0.01, all_fields));
    EXPECT_NE(writer.error().find(".imu or .csv"), std::string::npos);
}

TEST(Rotation, FilesAreNumberedBeforeTheirEnd) {
    EXPECT_EQ(record::file_name("motion.imu", 1), "motion.imu");
    EXPECT_EQ(record::file_name("motion.imu", 2), "motion-0002.imu");
    EXPECT_EQ(record::file_name("/a.b/motion", 3), "/a.b/motion-0003");
    EXPECT_EQ(record::file_name("/a.b/motion.csv", 12345), "/a.b/motion-12345.csv");
}

TEST(Rotation, IsDueByTimeOrBySize) {
    EXPECT_FALSE(record::Rotation{}.is_due(1e9, 1u << 30));
    EXPECT_TRUE((record::Rotation{10, 0}.is_due(10, 0)));
    EXPECT_FALSE((record::Rotation{10, 0}.is_due(9.9, 1u << 30)));
    EXPECT_TRUE((record::Rotation{0, 2}.is_due(0, 2000000)));
    EXPECT_FALSE((record::Rotation{0, 2}.is_due(1e6, 1999999)));
}

}  // namespace
}  // namespace fairlead
