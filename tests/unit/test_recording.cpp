// Every reader of the host simulator: what it takes, what it refuses, and what a cut file leaves.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/writers.hpp"

using namespace fairlead;
using namespace fairlead::sim;

namespace {

constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();

Recording tracker_recording() {
    Recording r;
    r.name = "three";
    r.format = Format::trk;
    r.period_s = 1 / 120.0;
    const std::uint32_t p = flag::position_valid, q = flag::orientation_valid;
    r.poses = {{8333000, {0.1f, -0.2f, 1.0f / 3}, {0.6f, 0.8f, 0, 0}, p | q},
               {16667000, {1e-7f, 0, 5}, {}, p},
               {25000000, {}, {0, 0, -0.6f, 0.8f}, q}};
    r.poses[2].p_w_m = {};
    return r;
}

Recording imu_recording() {
    Recording r;
    r.name = "imu";
    r.format = Format::imu;
    r.period_s = 0.0035;
    const std::uint32_t all = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    for (int i = 0; i < 3; ++i) {
        const float x = static_cast<float>(i) / 7;
        r.samples.push_back({i * 3500000, {x, 1, -2}, {0, x, 9.81f}, {20, 3, -x}, all});
        r.truth.push_back({i * 3500000, {x, x, 1}, {0.8f, 0, 0.6f, 0}, 0});
        r.moving.push_back(i == 1 ? 1 : 0);
    }
    r.truth[0].flags = flag::position_valid | flag::orientation_valid;
    r.truth[1].flags = flag::position_valid;
    r.truth[1].q_wb = {};
    r.truth[2].flags = 0;
    r.truth[2].p_w_m = {};
    r.truth[2].q_wb = {};
    return r;
}

/// Without what pads a type at its end.
template <class T>
constexpr std::size_t used = sizeof(T);
template <>
constexpr std::size_t used<Sample> = offsetof(Sample, temperature_c) + sizeof(float);

template <class T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        EXPECT_EQ(std::memcmp(&a[i], &b[i], used<T>), 0) << "record " << i;
}

std::string message_of(const std::string& bytes) {
    try {
        parse_recording(bytes, "x");
    } catch (const BadData& error) {
        return error.what();
    }
    return {};
}

template <class T>
void patch(std::string& bytes, std::size_t offset, T value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// Cut at every byte: an error that names the place, and with salvage exactly the complete records.
void cut_binary_everywhere(const std::string& whole, std::size_t record_size) {
    for (std::size_t cut = 0; cut < whole.size(); ++cut) {
        const std::string part = whole.substr(0, cut);
        ASSERT_NE(message_of(part), "") << cut;
        const std::size_t complete = cut < 64 ? 0 : (cut - 64) / record_size;
        if (complete == 0) {
            ASSERT_THROW(parse_recording(part, "x", Salvage::yes), BadData) << cut;
            continue;
        }
        const Recording r = parse_recording(part, "x", Salvage::yes);
        ASSERT_EQ(r.size(), complete) << cut;
        const std::string offset = "byte " + std::to_string(64 + complete * record_size) + ":";
        ASSERT_NE(r.damage.find(offset), std::string::npos) << r.damage;
    }
}

}  // namespace

TEST(Recordings, TrkComesBackBitForBit) {
    const Recording written = tracker_recording();
    const Recording read = parse_recording(to_trk(written), "file.trk");
    EXPECT_EQ(read.name, "three");
    EXPECT_EQ(read.format, Format::trk);
    EXPECT_EQ(read.period_s, written.period_s);
    expect_same_bits(read.poses, written.poses);
}

TEST(Recordings, ImuComesBackBitForBitWithTruthBeside) {
    const Recording written = imu_recording();
    const Recording read = parse_recording(to_imu(written), "file.imu");
    EXPECT_EQ(read.format, Format::imu);
    EXPECT_DOUBLE_EQ(read.period_s, 0.0035);
    expect_same_bits(read.samples, written.samples);
    expect_same_bits(read.truth, written.truth);
    EXPECT_EQ(read.moving, written.moving);
    EXPECT_TRUE(read.poses.empty()) << "the reference is truth, never input";
    EXPECT_THROW(poses_of(read), BadData);
}

TEST(Recordings, BinaryCutAtEveryByte) {
    cut_binary_everywhere(to_trk(tracker_recording()), 36);
    cut_binary_everywhere(to_imu(imu_recording()), 72);
}

TEST(Recordings, BinaryHeaderIsChecked) {
    const std::string good = to_trk(tracker_recording());
    const auto with = [&](std::size_t offset, auto value) {
        std::string bytes = good;
        patch(bytes, offset, value);
        return message_of(bytes);
    };
    EXPECT_NE(with(0, 'X').find("byte 0: neither text nor"), std::string::npos);
    EXPECT_NE(with(4, std::uint32_t{2}).find("byte 4: version 2 of .trk is not known"),
              std::string::npos);
    EXPECT_NE(with(12, std::uint32_t{72}).find("byte 12: records of 72"), std::string::npos);
    EXPECT_NE(with(16, std::nan("")).find("byte 16"), std::string::npos);
    EXPECT_NE(with(8, std::uint32_t{4}).find("byte 172: record 3 of 4"), std::string::npos);
    EXPECT_NE(with(8, std::uint32_t{2}).find("byte 136: bytes after"), std::string::npos);
    EXPECT_NE(with(8, std::uint32_t{0}), "");
}

TEST(Recordings, ValuesThatAreNoNumbersArePassedOn) {  // Intake meets them, not the reader
    std::string bytes = to_trk(tracker_recording());
    patch(bytes, 64 + 8, nan_f);
    EXPECT_TRUE(std::isnan(parse_recording(bytes, "x").poses[0].p_w_m.x));
    const Recording text = parse_recording("t_ns,px,py,pz,qw,qx,qy,qz\n1,nan,0,0,1,0,0,inf\n", "x");
    EXPECT_TRUE(std::isnan(text.poses[0].p_w_m.x));
    EXPECT_TRUE(std::isinf(text.poses[0].q_wb.z));
}

TEST(Recordings, TimeOf32BitsIsUnwrapped) {
    Recording r = tracker_recording();
    const std::int64_t wrap_ns = (std::int64_t{1} << 32) * 1000;
    for (Pose& pose : r.poses) pose.t_ns += wrap_ns - 20000000;
    r.poses.push_back(r.poses.back());
    r.poses.back().t_ns -= 3000000;  // backward stays backward
    const Recording read = parse_recording(to_trk(r), "x");
    for (std::size_t i = 1; i < r.size(); ++i)
        EXPECT_EQ(read.t_ns(i) - read.t_ns(0), r.t_ns(i) - r.t_ns(0));
}

/// 40 minutes without a record are a pause, not a step back by 31 minutes.
TEST(Recordings, LongPauseOf32BitsGoesForward) {
    for (const std::int64_t pause_s : {100, 2000, 2200, 2400, 3600, 4000}) {
        Recording r = tracker_recording();
        r.poses[2].t_ns = r.poses[1].t_ns + pause_s * 1000000000;
        const Recording read = parse_recording(to_trk(r), "x");
        EXPECT_EQ(read.t_ns(2) - read.t_ns(1), pause_s * 1000000000) << pause_s;
        r.poses[2].t_ns = r.poses[1].t_ns - 100000000000;  // a step back of some minutes is one
        const Recording back = parse_recording(to_trk(r), "x");
        EXPECT_EQ(back.t_ns(2) - back.t_ns(1), -100000000000);
    }
}

TEST(Recordings, PosesCsvComesBackBitForBit) {
    const Recording written = tracker_recording();
    const Recording read = parse_recording(to_poses_csv(written.poses), "some/where/file.csv");
    EXPECT_EQ(read.name, "file");
    EXPECT_EQ(read.format, Format::pose_text);
    expect_same_bits(read.poses, written.poses);
}

TEST(Recordings, EurocImuComesBackBitForBit) {
    Recording written = imu_recording();
    for (Sample& s : written.samples) {
        s.mag_uT = {};
        s.flags = flag::gyro_valid | flag::accel_valid;
    }
    const Recording read = parse_recording(to_euroc_imu(written.samples), "x");
    EXPECT_EQ(read.format, Format::imu_text);
    expect_same_bits(read.samples, written.samples);
    EXPECT_DOUBLE_EQ(read.period_s, 0.0035);
}

TEST(Recordings, ImuTextComesBackBitForBit) {
    Recording written = imu_recording();
    const std::uint32_t all = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    for (Sample& s : written.samples) s.temperature_c = 31.25f, s.flags |= flag::temperature_valid;
    written.samples[1].mag_uT = {};
    written.samples[1].temperature_c = 0;
    written.samples[1].flags = (all & ~flag::mag_valid) | flag::gap_before;
    written.samples[2].flags |= flag::clipped | flag::gyro_clipped | flag::mag_clipped;
    const Recording read = parse_recording(to_imu_csv(written), "x");
    expect_same_bits(read.samples, written.samples);
    expect_same_bits(read.truth, written.truth);
    EXPECT_EQ(read.moving, written.moving);
}

TEST(Recordings, EurocGroundTruthHasMoreColumns) {
    const Recording read = parse_recording(
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
        "q_RS_z [], v_RS_R_x [m s^-1], bw, ba\r\n"
        "1403636580838555648,4.688319,-1.786938,0.783338,0.534108,-0.153029,-0.827383,-0.082152,"
        "-0.027876,0.033207,0.800006\r\n",
        "x");
    ASSERT_EQ(read.poses.size(), 1u);
    EXPECT_EQ(read.poses[0].t_ns, 1403636580838555648);
    EXPECT_EQ(read.poses[0].p_w_m.y, -1.786938f);
    EXPECT_EQ(read.poses[0].q_wb.w, 0.534108f);
    EXPECT_EQ(read.poses[0].q_wb.z, -0.082152f);
}

TEST(Recordings, TumKeepsNanosecondsAndWritesScalarLast) {
    std::vector<Pose> poses = tracker_recording().poses;
    poses[0].t_ns = 1403636579763555584;
    poses.resize(1);
    const std::string text = to_tum(poses);
    EXPECT_EQ(text,
              "# t tx ty tz qx qy qz qw\n"
              "1403636579.763555584 0.100000001 -0.200000003 0.333333343 0.800000012 0 0 "
              "0.600000024\n");
    expect_same_bits(parse_recording(text, "x").poses, poses);
    EXPECT_EQ(parse_recording("-0.5 0 0 0 0 0 0 1\n", "x").poses[0].t_ns, -500000000);
    EXPECT_EQ(parse_recording("1.4e9 0 0 0 0 0 0 1\n", "x").poses[0].t_ns, 1400000000000000000);
    EXPECT_EQ(parse_recording("3 0 0 0 0 0 0 1\n", "x").poses[0].t_ns, 3000000000);
    EXPECT_EQ(parse_recording("0.0000000006 0 0 0 0 0 0 1\n", "x").poses[0].t_ns, 1);
}

TEST(Recordings, TumLeavesOutWhatItCannotSay) {
    const auto poses = tracker_recording().poses;  // both, position only, orientation only
    EXPECT_EQ(parse_recording(to_tum(poses), "x").size(), 1u);
    const std::vector<Pose> orientation_only{poses[2]};
    const Recording read = parse_recording(to_tum(orientation_only), "x");
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read.poses[0].p_w_m.x, 0);
    EXPECT_EQ(read.poses[0].q_wb.y, -0.6f);
}

TEST(Recordings, TextErrorsNameTheLineAndTheRemedy) {
    const auto says = [](const std::string& text, const std::string& what) {
        const std::string message = message_of(text);
        EXPECT_NE(message.find(what), std::string::npos) << message;
    };
    const std::string good = "t_ns,px,py,pz,qw,qx,qy,qz\n1,0,0,0,1,0,0,0\n";
    says(good + "2,0,zero,0,1,0,0,0\n", "line 3, column 3 (py): 'zero' is not a number; --salvage");
    says("# comment\n\n" + good + "2,0,0,0,1,0,0\n", "line 5: 7 columns, expected 8; --salvage");
    says(good + "x,0,0,0,1,0,0,0\n", "line 3, column 1 (t_ns): 'x' is not a time in ns");
    says(good + "99999999999999999999,0,0,0,1,0,0,0\n", "line 3, column 1");
    says(good + "2,0,0,,1,0,0,0\n", "column 4 (pz): '' is not a number");
    says(good + "2,0,0,0.1.2,1,0,0,0\n", "'0.1.2' is not a number");
    says("1 2 3\n", "line 1: 3 columns without a header; no known layout fits");
    says("1,2,3,4,5,6\n", "--columns t_ns,gx,gy,gz");
    says("1.0 0 0 0 0 0 0 1\n1.x 0 0 0 0 0 0 1\n", "line 2, column 1: '1.x' is not a time in s");
    says("--1 0 0 0 0 0 0 1\n", "'--1' is not a time");
    says("99999999999 0 0 0 0 0 0 1\n", "line 1, column 1");
    says("", "holds no records");
    says("# only a comment\n", "holds no records");
    EXPECT_EQ(parse_recording(good + "2,0,zero,0,1,0,0,0\n", "x", Salvage::yes).size(), 1u);
}

/// A cut text can end in a shorter number that still reads: that record is used, with a note.
TEST(Recordings, TextCutAtEveryByte) {
    for (const std::string& whole :
         {to_poses_csv(tracker_recording().poses), to_tum(tracker_recording().poses),
          to_euroc_imu(imu_recording().samples), to_imu_csv(imu_recording())}) {
        const Recording full = parse_recording(whole, "x");
        for (std::size_t cut = 0; cut < whole.size(); ++cut) {
            const std::string part = whole.substr(0, cut);
            std::size_t complete = 0;
            for (std::size_t i = whole.find('\n') + 1; i < part.size(); ++i)
                if (part[i] == '\n') ++complete;
            Recording r;
            try {
                r = parse_recording(part, "x", Salvage::yes);
            } catch (const BadData&) {
                ASSERT_EQ(complete, 0u) << cut;
                continue;
            }
            ASSERT_TRUE(r.size() == complete || (r.size() == complete + 1 && !r.notes.empty()))
                << cut << ": " << r.size() << " of " << complete;
            for (std::size_t i = 0; i < complete; ++i) ASSERT_EQ(r.t_ns(i), full.t_ns(i));
        }
    }
}

TEST(Recordings, FormatIsChosenByContentAndExtension) {
    const Recording tracker = tracker_recording(), imu = imu_recording();
    EXPECT_EQ(parse_recording(to_file(tracker, "a.trk"), "a.csv").format, Format::trk);
    EXPECT_EQ(parse_recording(to_file(tracker, "a.csv"), "a").format, Format::pose_text);
    EXPECT_EQ(parse_recording(to_file(imu, "a.csv"), "a").format, Format::imu_text);
    EXPECT_EQ(parse_recording(to_file(imu, "a.imu"), "a").format, Format::imu);
    EXPECT_THROW(to_file(imu, "a.trk"), BadSpec);
    EXPECT_THROW(to_file(tracker, "a.imu"), BadSpec);
    EXPECT_THROW(to_file(tracker, "a"), BadSpec);
}
