// Version 2 of .imu: what is written is read bit for bit; every header and flag is checked.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <random>

#include "host_sim/recording/imu2.hpp"
#include "host_sim/recording/writers.hpp"

using namespace fairlead;
using namespace fairlead::sim;

namespace {

/// Without what pads a type at its end.
template <class T>
constexpr std::size_t used = sizeof(T);
template <>
constexpr std::size_t used<Sample> = offsetof(Sample, temperature_c) + sizeof(float);

template <class T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_EQ(std::memcmp(&a[i], &b[i], used<T>), 0) << "record " << i;
}

/// Random sensors, random validity, events among the records.
Recording random_recording(std::mt19937& random, bool reference) {
    Recording r;
    r.name = "zwölf";
    r.period_s = 0.25;
    r.full_scale = {34.9f, 156.9f, 0};
    r.frame = reference ? ReferenceFrame::level : ReferenceFrame::none;
    const auto real = [&] { return static_cast<float>(random() % 2000) / 7 - 100; };
    const auto some = [&](std::uint32_t flag) { return random() % 3 != 0 ? flag : 0u; };
    std::int64_t t = 1700000000123456789;
    for (int i = 0; i < 40; ++i) {
        t += static_cast<std::int64_t>(random() % 5000000);
        Sample s;
        s.t_ns = t;
        s.flags = some(flag::gyro_valid) | some(flag::accel_valid) | some(flag::mag_valid) |
                  some(flag::temperature_valid) | (random() % 5 == 0 ? flag::gap_before : 0u);
        if (s.flags & flag::gyro_valid) s.gyro_rad_s = {real(), 0, real()};
        if (s.flags & flag::accel_valid) s.accel_m_s2 = {real(), real(), real()};
        if (s.flags & flag::mag_valid) s.mag_uT = {0, 0, 0};  // zero is a measurement
        if (s.flags & flag::temperature_valid) s.temperature_c = real();
        if (random() % 4 == 0) s.flags |= flag::accel_clipped | flag::clipped;
        r.samples.push_back(s);
        if (random() % 6 == 0)
            r.events.push_back({t + 1, 7, static_cast<std::uint16_t>(random()),
                                random() % 2 ? flag::gap_before : 0u});
        if (!reference) continue;
        Pose truth;
        truth.t_ns = t;
        truth.flags = some(flag::orientation_valid) | some(flag::position_valid);
        if (truth.flags & flag::orientation_valid) truth.q_wb = {0.6f, 0, -0.8f, 0};
        if (truth.flags & flag::position_valid) truth.p_w_m = {real(), real(), 1};
        r.truth.push_back(truth);
        r.moving.push_back(random() % 2 ? 1 : 0);
    }
    return r;
}

std::string message_of(const std::string& bytes) {
    try {
        parse_recording(bytes, "x");
    } catch (const BadData& error) {
        return error.what();
    }
    return "accepted";
}

template <class T>
std::string patched(std::string bytes, std::size_t offset, T value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    return bytes;
}

}  // namespace

TEST(Imu2, ComesBackBitForBit) {
    std::mt19937 random{3};
    for (int trial = 0; trial < 200; ++trial) {
        const Recording written = random_recording(random, trial % 2 == 0);
        const Recording read = parse_recording(to_imu(written), "f");
        EXPECT_TRUE(read.version2);
        EXPECT_EQ(read.name, written.name);
        EXPECT_EQ(read.period_s, written.period_s);
        EXPECT_EQ(read.full_scale.y, written.full_scale.y);
        EXPECT_EQ(read.frame, written.frame);
        expect_same_bits(read.samples, written.samples);
        expect_same_bits(read.events, written.events);
        expect_same_bits(read.truth, written.truth);
        EXPECT_EQ(read.moving, written.moving);
    }
}

TEST(Imu2, CutAnywhereKeepsTheCompleteRecords) {
    std::mt19937 random{4};
    Recording r = random_recording(random, true);
    r.events.clear();
    const std::string whole = to_imu(r);
    const std::size_t size = (whole.size() - 128) / r.size();
    for (std::size_t cut = 0; cut < whole.size(); ++cut) {
        const std::string part = whole.substr(0, cut);
        ASSERT_NE(message_of(part), "accepted") << cut;
        const std::size_t complete = cut < 128 ? 0 : (cut - 128) / size;
        if (complete == 0) {
            ASSERT_THROW(parse_recording(part, "x", Salvage::yes), BadData);
            continue;
        }
        ASSERT_EQ(parse_recording(part, "x", Salvage::yes).size(), complete);
        // a recorder that could not go back: whole records to the end are no damage
        const std::string open = patched(part, 16, Imu2Header::open);
        const bool whole_records = (cut - 128) % size == 0;
        ASSERT_EQ(message_of(open) == "accepted", whole_records) << cut;
    }
}

TEST(Imu2, EveryFieldIsChecked) {
    std::mt19937 random{5};
    const std::string good = to_imu(random_recording(random, true));
    const auto refused = [&](std::size_t offset, auto value, const char* says) {
        const std::string message = message_of(patched(good, offset, value));
        EXPECT_NE(message.find(says), std::string::npos) << offset << ": " << message;
    };
    refused(4, 3u, "version 3 of .imu is not known; this program reads 1 and 2");
    refused(8, 64u, "byte 8: a header of 64 bytes");
    refused(12, 20u, "byte 12: records of 20");
    refused(24, 127u, "byte 24: unknown fields");
    refused(28, 3u, "byte 28: frame 3");
    refused(28, 0u, "byte 28: a reference orientation without its frame");
    refused(32, -1.0, "byte 32");
    refused(40, -1.0f, "byte 40");
    refused(48, std::nanf(""), "byte 48");
    refused(52, 1u, "byte 52");
    refused(128, std::uint64_t{1} << 63, "byte 128: a time of 2^63");
    refused(128 + 8, 1u << 13, "byte 136: unknown flags");
    refused(16, std::uint64_t{1}, "bytes after the last record");
    refused(16, std::uint64_t{1} << 60, "is cut or missing");
    Recording negative;
    negative.samples.resize(1);
    negative.samples[0].t_ns = -1;
    EXPECT_THROW(to_imu(negative, 2), BadData);
}

TEST(Imu2, VersionOneIsWrittenOnlyWhereItHoldsEverything) {
    Recording r;
    const std::uint32_t all = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    for (int i = 0; i < 5; ++i)
        r.samples.push_back({i * 1000000, {1, 2, 3}, {0, 0, 9.8f}, {20, 0, -40}, all, 0});
    EXPECT_FALSE(parse_recording(to_imu(r), "x").version2);
    EXPECT_TRUE(parse_recording(to_imu(r, 2), "x").version2);
    Recording finer = r, absent = r, paused = r;
    finer.samples[3].t_ns += 1;
    absent.samples[2].flags &= ~flag::mag_valid;
    paused.samples[4].t_ns += 72 * 60 * std::int64_t{1000000000};
    for (const Recording& beyond : {finer, absent, paused}) {
        EXPECT_THROW(to_imu(beyond, 1), BadData);
        const Recording read = parse_recording(to_imu(beyond), "x");
        EXPECT_TRUE(read.version2);
        for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(read.t_ns(i), beyond.t_ns(i));
    }
}

TEST(Imu1, SaysWhichSensorsItTakesAsPresent) {
    Recording r;
    const std::uint32_t all = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    for (int i = 0; i < 5; ++i)
        r.samples.push_back(
            {i * 1000000, {1, 2, 3}, {0, 0, 9.8f}, {i == 2 ? 20.0f : 0, 0, 0}, all, 0});
    const std::string some = to_imu(r, 1);
    const Recording once = parse_recording(some, "x");
    for (std::size_t i = 0; i < 5; ++i)
        EXPECT_EQ((once.samples[i].flags & flag::mag_valid) != 0, i == 2) << "zero is no field";
    EXPECT_TRUE(once.notes.empty());
    r.samples[2].mag_uT = {};
    const Recording none = parse_recording(to_imu(r, 1), "x");
    ASSERT_EQ(none.notes.size(), 1u);
    EXPECT_NE(none.notes[0].find("present: gyro, accel; absent: mag (zero or not finite in all 5"),
              std::string::npos);
    ReadOptions options;
    options.sensors = "gyro";
    const Recording gyro = parse_recording(some, "x", options);
    EXPECT_EQ(gyro.samples[2].flags, flag::gyro_valid);
}
