// Generated recordings: the truth is a motion with exact derivatives, the same bytes everywhere.
#include "host_sim/generate/generate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/generate/faults.hpp"
#include "host_sim/generate/motion.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/writers.hpp"

using namespace fairlead;
using namespace fairlead::sim;

namespace {

const char* const everything =
    "model:optical+jitter:100+rest:1+reach:0.8:5+gap:0.3+oscillate:4:2+jump+lose:position:0.5+"
    "turn:1:15+rest:1";

std::uint64_t fnv1a(const std::string& bytes) {
    std::uint64_t hash = 14695981039346656037u;
    for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    return hash;
}

Motion every_motion() {
    Motion motion{Random{5}};
    motion.rest(0.5);
    motion.reach(0.7, 0.5, 1.2);
    motion.reach(0.9, 0.5, 3);
    motion.oscillate(3, 2, 0.1, 0.4);
    motion.turn(0.8, 20);
    return motion;
}

double distance(const Vec3d& a, const Vec3d& b) { return norm(a - b); }

}  // namespace

TEST(Motion, DerivativesAreThoseOfTheCourse) {  // against central differences
    const Motion motion = every_motion();
    const double h = 1e-4;
    for (double t = h; t < motion.duration_s() - h; t += 0.00317) {
        const MotionState a = motion.at(t - h), b = motion.at(t), c = motion.at(t + h);
        const Vec3d accel = (1 / (h * h)) * ((a.p_w_m - b.p_w_m) + (c.p_w_m - b.p_w_m));
        const Vec3d rate = (1 / (2 * h)) * rotation_vector(conj(a.q_wb) * c.q_wb);
        EXPECT_LT(distance(accel, b.accel_w_m_s2), 2e-2) << t;  // up to 16 m/s^2, jerk at ends
        EXPECT_LT(distance(rate, b.rate_b_rad_s), 2e-3) << t;   // up to 20 rad/s
        EXPECT_NEAR(dot(b.q_wb, b.q_wb), 1, 1e-12);
    }
}

TEST(Motion, TurnReachesItsPeakRate) {
    Motion motion{Random{1}};
    motion.turn(2, 20);
    EXPECT_NEAR(norm(motion.at(1).rate_b_rad_s), 20, 1e-9);
}

TEST(Motion, StartsAndEndsAtRestAndJumpsAtOnce) {
    Motion motion = every_motion();
    const double before_s = motion.duration_s();
    motion.jump(0.25, 0.5);
    motion.rest(1);
    EXPECT_LT(norm(motion.at(before_s - 1e-6).rate_b_rad_s), 1e-6);
    const MotionState a = motion.at(before_s - 1e-6), b = motion.at(before_s + 1e-6);
    EXPECT_NEAR(distance(a.p_w_m, b.p_w_m), 0.25, 1e-9);
    EXPECT_NEAR(rotation_angle(a.q_wb, b.q_wb), 0.5, 1e-9);
}

TEST(Generate, SameSeedSameBytesWithEveryCompiler) {
    const std::string bytes = to_trk(generate(everything, 7));
    EXPECT_EQ(bytes, to_trk(generate(everything, 7)));
    EXPECT_NE(bytes, to_trk(generate(everything, 8)));
    // the figures guard against a compiler, a flag or a C library that changes a bit
    EXPECT_EQ(fnv1a(bytes), 3938017638904409612u);
    EXPECT_EQ(fnv1a(to_imu(generate("model:lsm6dso+rest:1+turn:1:20+reach:1:3", 3))),
              7458486475889570967u);
}

TEST(Generate, EventsTakeRecordsAndChannelsAway) {
    const Recording r =
        generate("model:ideal+rate:100+rest:1+gap:0.5+rest:1+lose:orientation:0.25+rest:1", 1);
    EXPECT_EQ(r.size(), 250u);
    std::size_t lost = 0;
    std::int64_t longest_ns = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
        lost += (r.poses[i].flags & flag::orientation_valid) == 0 ? 1u : 0u;
        EXPECT_NE(r.poses[i].flags & flag::position_valid, 0u);
        if (i > 0) longest_ns = std::max(longest_ns, r.t_ns(i) - r.t_ns(i - 1));
    }
    EXPECT_EQ(lost, 25u);
    EXPECT_EQ(longest_ns, 510000000);
}

TEST(Generate, DropoutsAreShortManyAndWithinTheirTime) {
    const std::string spec = "model:ideal+rate:100+rest:1+dropouts:position:8:20:0.2+rest:10";
    const Recording r = generate(spec, 4);
    ASSERT_EQ(r.size(), 1100u);
    std::size_t lost = 0, runs = 0, run = 0, longest = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
        EXPECT_NE(r.poses[i].flags & flag::orientation_valid, 0u);
        const bool there = (r.poses[i].flags & flag::position_valid) != 0;
        run = there ? 0 : run + 1;
        runs += run == 1 ? 1u : 0u;
        lost += there ? 0u : 1u;
        longest = std::max(longest, run);
        if (!there) {
            EXPECT_GE(r.t_ns(i), 1'000'000'000);
            EXPECT_LT(r.t_ns(i), 9'200'000'000);
        }
    }
    EXPECT_GE(runs, 10u);  // 20, but for those that touch
    EXPECT_LE(runs, 20u);
    EXPECT_GE(lost, 100u);  // 20 of 0.1 s in the mean are 200 records
    EXPECT_LE(lost, 300u);
    EXPECT_LE(longest, 60u);
    const Recording other = generate(spec, 5), plain = generate("model:ideal+rate:100+rest:11", 4);
    EXPECT_NE(to_trk(r), to_trk(other)) << "the times follow the seed";
    for (std::size_t i = 0; i < r.size(); ++i) EXPECT_EQ(r.t_ns(i), plain.t_ns(i));
}

TEST(Generate, PressesGoDownAndUpWithinTheirTime) {
    const Recording r = generate("rest:1+press:5:0.5:4+press:2:1+rest:2", 8);
    ASSERT_EQ(r.events.size(), 10u);
    std::uint16_t value[6] = {};
    for (std::size_t i = 0; i < r.events.size(); ++i) {
        const Event& event = r.events[i];
        ASSERT_TRUE(event.channel == 5 || event.channel == 2);
        EXPECT_EQ(event.value, 1 - value[event.channel]);
        value[event.channel] = event.value;
        EXPECT_GE(event.t_ns, 1'000'000'000);
        EXPECT_LT(event.t_ns, event.channel == 5 ? 1'500'000'000 : 2'000'000'000);
        if (i > 0) {
            EXPECT_GE(event.t_ns, r.events[i - 1].t_ns);
        }
    }
    const Recording plain = generate("rest:1+rest:2", 8);
    EXPECT_EQ(to_trk(plain), to_trk(r)) << "presses change no record";
}

TEST(Generate, NoiseIsThatOfTheModel) {
    const Recording r = generate("model:optical+rest:100", 11);
    ASSERT_EQ(r.size(), 12000u);
    double sum2 = 0, angle2 = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
        const Vec3 e = r.poses[i].p_w_m - r.truth[i].p_w_m;
        sum2 += static_cast<double>(dot(e, e));
        const double angle = static_cast<double>(rotation_angle(r.truth[i].q_wb, r.poses[i].q_wb));
        angle2 += angle * angle;
    }
    const double n = 3 * static_cast<double>(r.size());
    EXPECT_NEAR(std::sqrt(sum2 / n), 1e-4, 2e-6);  // 4 sigma of the estimate are 1.5 %
    EXPECT_NEAR(std::sqrt(angle2 / n) * 180 / 3.14159265, 0.05, 0.001);
}

TEST(Generate, ImuAtRestShowsGravityAndClipsAtItsRange) {
    const Recording rest = generate("model:icm42688p+rest:20", 2);
    double up = 0;
    for (const Sample& s : rest.samples) up += static_cast<double>(s.accel_m_s2.z);
    EXPECT_NEAR(up / static_cast<double>(rest.size()), 9.80665, 0.3);
    const Recording fast = generate("model:icm42688p+turn:2:100", 2);
    float most = 0;
    for (const Sample& s : fast.samples)
        for (const float w : {s.gyro_rad_s.x, s.gyro_rad_s.y, s.gyro_rad_s.z})
            most = std::max(most, std::fabs(w));
    EXPECT_NEAR(static_cast<double>(most), 32768 / 16.4 * 3.14159265 / 180, 1e-3);
}

TEST(Generate, BadSpecsAreUsageErrors) {
    for (const char* spec : {"",
                             "reach",
                             "reach:x",
                             "reach:1:0",
                             "reach:1:2.5",
                             "rest:-1",
                             "rest:nan",
                             "jog:1",
                             "rest:1++rest:1",
                             "model:none+rest:1",
                             "rate:100",
                             "gap:2+rest:1",
                             "rest:1:2",
                             "model:mpu6050+lose:position:1+rest:1",
                             "rest:1+lose:left:1",
                             "dropouts:both:1+rest:1",
                             "dropouts:both:1:0+rest:1",
                             "dropouts:left:1:2+rest:1",
                             "model:lsm6dso+dropouts:both:1:2+rest:1",
                             "rest:86400+rate:100000",
                             "jitter:9000+rest:1"})
        EXPECT_THROW(generate(spec, 1), BadSpec) << spec;
}

TEST(Faults, DoWhatTheySay) {
    const auto spoiled = [](const std::string& spec) {
        Recording r = generate("model:ideal+rest:1+reach:1:3", 1);
        for (const SpecItem& item : parse_spec(spec)) spoil_records(r, item, 3);
        return r;
    };
    const Recording clean = spoiled("nan:0");
    std::size_t nans = 0;
    for (const Pose& p : spoiled("nan:5").poses)
        nans += is_finite(p.p_w_m) && is_finite(p.q_wb) ? 0u : 1u;
    EXPECT_GE(nans, 4u);
    EXPECT_EQ(spoiled("gap:2:10").size(), clean.size() - 20);
    EXPECT_EQ(spoiled("repeat:7").size(), clean.size() + 7);
    std::size_t backward = 0;
    const Recording b = spoiled("backward:1");
    for (std::size_t i = 1; i < b.size(); ++i) backward += b.t_ns(i) <= b.t_ns(i - 1) ? 1u : 0u;
    EXPECT_EQ(backward, 1u);
    EXPECT_EQ(to_trk(spoiled("nan:3+spike:2")), to_trk(spoiled("nan:3+spike:2")));
    std::string bytes(100, 'x');
    spoil_bytes(bytes, parse_spec("flip:1")[0], 1);
    EXPECT_NE(bytes, std::string(100, 'x'));
    spoil_bytes(bytes, parse_spec("cut:10")[0], 1);
    EXPECT_EQ(bytes.size(), 10u);
    for (const char* spec : {"nan", "gap:1", "melt:1", "nan:1.5", "flip:-1"})
        EXPECT_THROW(
            {
                const SpecItem item = parse_spec(spec)[0];
                if (is_byte_fault(item))
                    spoil_bytes(bytes, item, 1);
                else
                    spoiled(spec);
            },
            BadSpec)
            << spec;
}
