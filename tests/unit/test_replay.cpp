// The replay's accounting, on motions with rests, gaps, drop-outs, teleports and faults. The heap
// is sealed around every push, so that an allocation in the pipeline would end the test.
#include "host_sim/replay/replay.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fairlead/math/quat.hpp"
#include "host_sim/generate/faults.hpp"
#include "host_sim/generate/generate.hpp"
#include "host_sim/generate/random.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/replay/attitude_run.hpp"
#include "host_sim/replay/curve_store.hpp"
#include "host_sim/report/summary.hpp"

using namespace fairlead;
using namespace fairlead::sim;

namespace {

Recording motion(std::uint64_t seed) {
    return generate(
        "model:optical+rest:1+reach:0.7:4+gap:0.3+oscillate:2:2+lose:position:0.4+turn:0.8:12+jump+"
        "lose:orientation:0.3+reach:0.6:3+rest:1",
        seed);
}

void expect_guarantee(const Replay& r) {
    for (const ChannelResult* c : {&r.position, &r.orientation}) {
        EXPECT_EQ(c->violations, 0u);
        EXPECT_EQ(c->changed, 0u);
        EXPECT_LE(c->max_delay, r.options.delay_max);
        EXPECT_EQ(c->control_points, 3 * c->curves + c->knots);
    }
    EXPECT_LE(r.position.max_error, r.options.tol_pos_m);
    EXPECT_LE(r.orientation.max_error, r.options.tol_rot_rad);
    EXPECT_EQ(r.position.bytes + r.orientation.bytes + r.events.bytes, r.stream.size());
    EXPECT_EQ(r.overflows, 0u);
    EXPECT_EQ(r.events.wrong, 0u);
    EXPECT_EQ(r.events.late, 0u);
    EXPECT_EQ(r.events.decoded.size() + r.events.refused, r.events.offered);
}

}  // namespace

TEST(Replay, HoldsItsGuaranteeOverMotionsTolerancesAndDelays) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        ReplayOptions options;
        options.delay_max = seed % 2 == 0 ? 30 : 120;
        options.tol_pos_m = seed < 3 ? 1e-3 : 5e-3;
        options.filter = seed < 3 ? "" : "binomial:9+csg:7:2";
        const Recording recording = motion(seed);
        const Replay r = replay(recording, options);
        expect_guarantee(r);
        EXPECT_EQ(r.input.size(), recording.size());
        EXPECT_EQ(r.bytes_after_record.size(), recording.size());
        EXPECT_EQ(r.position.curves, 3u) << "the gap and the lost channel start new curves";
        if (options.filter.empty()) {
            EXPECT_EQ(r.position.max_raw, r.position.max_error);
        } else {
            EXPECT_GT(r.position.max_raw, r.position.max_error);
        }
    }
}

TEST(Replay, CarriesDiscreteEventsWhateverHappensToTheMotion) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Recording recording = generate(
            "model:optical+press:0:6:20+press:7:3:5+rest:1+reach:0.7:4+gap:0.3+turn:0.8:12+rest:1",
            seed);
        ASSERT_EQ(recording.events.size(), 50u);
        for (const SpecItem& item : parse_spec("nan:3+repeat:5+backward:3"))
            spoil_records(recording, item, seed);
        recording.events.push_back({recording.poses.back().t_ns + 5'000'000'000, 9, 500, 0});
        ReplayOptions options;
        options.filter = seed == 2 ? "binomial:17" : "";
        const Replay r = replay(recording, options);
        expect_guarantee(r);
        EXPECT_EQ(r.events.refused, 0u);
        ASSERT_EQ(r.events.decoded.size(), recording.events.size());
        for (std::size_t i = 0; i < recording.events.size(); ++i) {
            EXPECT_EQ(r.events.decoded[i].t_ns, recording.events[i].t_ns);
            EXPECT_EQ(r.events.decoded[i].channel, recording.events[i].channel);
            EXPECT_EQ(r.events.decoded[i].value, recording.events[i].value);
        }
        EXPECT_LT(r.events.bytes, 24 * recording.events.size());
    }
    Recording burst = generate("rest:1", 1);
    for (int i = 0; i < 30; ++i) burst.events.push_back({500'000'000, 1, 1, 0});
    const Replay r = replay(burst, {});
    EXPECT_EQ(r.events.refused, 24u);
    EXPECT_EQ(r.events.wrong + r.events.late, 0u);
}

TEST(Replay, CountsFaultsAndGoesOn) {
    Recording recording = motion(9);
    for (const SpecItem& item : parse_spec("nan:3+spike:2+repeat:5+backward:3+zero:2"))
        spoil_records(recording, item, 4);
    const Replay r = replay(recording, {});
    expect_guarantee(r);
    EXPECT_LT(r.input.size(), recording.size());
    const std::string faults = faults_text(r);
    for (const char* kind : {"5 repeated time", "3 backward time", "not finite", "out of range"})
        EXPECT_NE(faults.find(kind), std::string::npos) << faults;
}

// The pipeline of a board: what enters the reducer is what the attitude filter says.
TEST(Replay, AnImuRunsThroughTheAttitudeFilter) {
    const Recording recording =
        generate("model:icm42688p+rest:3+turn:2:3+gap:0.2+turn:2+rest:1", 7);
    for (const auto mode : {AttitudeMode::gyro, AttitudeMode::imu, AttitudeMode::imu_mag}) {
        SCOPED_TRACE(static_cast<int>(mode));
        ReplayOptions options;
        options.mode = mode;
        const Replay r = replay(recording, options);
        const auto expected = run_attitude(recording, mode);
        ASSERT_EQ(r.raw.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            ASSERT_EQ(r.raw[i].t_ns, expected[i].t_ns);
            ASSERT_LT(rotation_angle(r.raw[i].q_wb, expected[i].q_wb), 1e-6f) << i;
        }
        EXPECT_EQ(r.position.samples, 0u);
        EXPECT_EQ(r.orientation.samples, recording.size());
        EXPECT_EQ(r.orientation.violations + r.orientation.changed, 0u);
        EXPECT_LE(r.orientation.max_error, r.options.tol_rot_rad);
        EXPECT_EQ(r.orientation.curves, 2u) << "the gap starts a new curve";
        EXPECT_EQ(r.bytes_after_record.size(), recording.size());
        ASSERT_TRUE(r.attitude);
        EXPECT_EQ(r.attitude->points.size(), recording.size());
        EXPECT_EQ(std::isnan(r.attitude->points.back().heading_sigma),
                  mode != AttitudeMode::imu_mag);
    }
}

TEST(Replay, TellsTheErrorOfAnImuFromItsReference) {
    const Recording recording = generate("model:icm42688p+rest:4+turn:2:3+rest:1", 3);
    ReplayOptions options;
    for (const auto mode : {AttitudeMode::imu_mag, AttitudeMode::imu, AttitudeMode::gyro}) {
        SCOPED_TRACE(static_cast<int>(mode));
        options.mode = mode;
        const Replay r = replay(recording, options);
        ASSERT_TRUE(r.attitude && r.attitude->has_truth);
        const AttitudePoint& last = r.attitude->points.back();
        EXPECT_LT(std::abs(last.turn_error), 0.1);
        EXPECT_LT(std::abs(last.heading_error), 0.1);
        EXPECT_LT(last.inclination_error, 0.06);
        EXPECT_GE(last.turn_error + 1e-9, std::abs(last.heading_error));
    }
}

// Widths, channels and restarts change the bytes, and the guarantee for none of them.
TEST(Replay, HoldsItsGuaranteeForEveryChoice) {
    const Recording recording = motion(5);
    for (const Beam beam : {Beam::narrow, Beam::medium, Beam::wide}) {
        for (const double restart_s : {0.0, 0.25, 2.0, 1e6}) {
            SCOPED_TRACE(std::string{to_string(beam)} + " " + std::to_string(restart_s));
            ReplayOptions options;
            options.beam = beam;
            options.restart_s = restart_s;
            options.delay_max = restart_s > 1 ? 60 : 16;
            const Replay r = replay(recording, options);
            expect_guarantee(r);
            EXPECT_EQ(r.restarts == r.frames, !(restart_s > 0));
        }
    }
    ReplayOptions one;
    one.orientation = false;
    const Replay p = replay(recording, one);
    EXPECT_EQ(p.position.violations + p.orientation.samples, 0u);
    EXPECT_GT(p.position.samples, 0u);
    EXPECT_EQ(p.position.bytes, p.stream.size());
    one = {};
    one.position = false;
    const Replay q = replay(recording, one);
    EXPECT_EQ(q.orientation.violations + q.position.samples, 0u);
    EXPECT_EQ(q.orientation.bytes, q.stream.size());
}

// The earlier search stands behind the same intake, filter and judge.
TEST(Replay, TheEarlierSearchFindsFewerKnots) {
    const Recording recording = generate("model:optical+rest:1+reach:0.7:4+gap:0.3+turn:0.8:8", 2);
    ReplayOptions options;
    options.delay_max = 60;
    const Replay bytes = replay(recording, options);
    options.objective = Objective::knots;
    const Replay knots = replay(recording, options);
    for (const Replay* r : {&bytes, &knots}) {
        EXPECT_EQ(r->position.violations + r->orientation.violations, 0u);
        EXPECT_EQ(r->position.changed + r->orientation.changed, 0u);
        EXPECT_LE(std::max(r->position.max_delay, r->orientation.max_delay), 60u);
    }
    EXPECT_EQ(knots.position.control_points, 4 * knots.position.curves + knots.position.knots);
    EXPECT_LT(knots.position.control_points, bytes.position.control_points);
    EXPECT_LT(knots.orientation.control_points, bytes.orientation.control_points);
    EXPECT_LT(bytes.stream.size(), knots.stream.size());
}

// A board whose clock starts anew: the same times again, and neither curve is taken for the other.
TEST(Replay, TellsRunsOfTheClockApart) {
    Recording recording = generate("model:optical+rest:0.5+reach:0.7:2", 3);
    const std::vector<Pose> again = generate("model:optical+turn:0.5:4+rest:0.5", 4).poses;
    const std::size_t first = recording.size();
    recording.poses.insert(recording.poses.end(), again.begin(), again.end());
    const Replay r = replay(recording, {});
    expect_guarantee(r);
    EXPECT_EQ(r.runs, 2u);
    ASSERT_EQ(r.input.size(), recording.size());
    CurveStore store;
    store.push(r.stream);
    store.finish();
    ASSERT_EQ(store.runs().size(), 2u);
    const std::int64_t t_ns = again[30].t_ns;
    const CurvePoint a = store.point_at(1, t_ns), b = store.point_at(2, t_ns);
    EXPECT_GT(rotation_angle(a.q, b.q), 0.05) << "two motions at one time";
    EXPECT_EQ(store.runs()[0].begin_ns(), recording.poses[0].t_ns);
    EXPECT_EQ(store.runs()[1].begin_ns(), recording.poses[first].t_ns);
}

TEST(CurveStore, CountsBytesByTheKindOfTheirFrames) {
    Recording recording = motion(3);
    for (int i = 0; i < 5; ++i) recording.events.push_back({i * 300'000'000, 1, 7, 0});
    const Replay r = replay(recording, {});
    const StreamBytes bytes = stream_bytes(r.stream);
    EXPECT_TRUE(bytes.whole);
    EXPECT_EQ(bytes.frames, r.frames);
    EXPECT_EQ(bytes.data + bytes.headers + bytes.events, r.stream.size());
    EXPECT_GT(bytes.events, 0u);
    EXPECT_EQ(bytes.version, wire::stream_version);
    const StreamBytes cut = stream_bytes(std::string_view(r.stream).substr(0, r.stream.size() - 1));
    EXPECT_FALSE(cut.whole);
    EXPECT_LT(cut.counted, r.stream.size() - 1);
}

TEST(CurveStore, TakesBytesInAnyPortions) {
    const Recording recording = motion(3);
    const Replay r = replay(recording, {});
    CurveStore whole, single;
    whole.push(r.stream);
    whole.finish();
    for (const char byte : r.stream) single.push(std::string_view(&byte, 1));
    single.finish();
    EXPECT_EQ(whole.damage(), "");
    for (const Pose& pose : recording.poses) {
        const Pose a = whole.at(pose.t_ns), b = single.at(pose.t_ns);
        EXPECT_EQ(a.flags, b.flags);
        EXPECT_EQ(a.p_w_m.x, b.p_w_m.x);
        EXPECT_EQ(a.q_wb.w, b.q_wb.w);
    }
}

TEST(CurveStore, NoticesEveryFlippedBitAndNeverInventsACurve) {
    const Recording recording = motion(3);
    const Replay r = replay(recording, {});
    sim::Random random{8};
    for (int round = 0; round < 40; ++round) {
        std::string bytes = r.stream;
        const auto at = static_cast<std::size_t>(random.below(bytes.size()));
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        CurveStore store;
        store.push(bytes);
        store.finish();
        SCOPED_TRACE("byte " + std::to_string(at));
        EXPECT_NE(store.damage(), "");
        for (std::size_t i = 0; i < recording.size(); i += 7) {
            const Pose a = store.at(r.input[i].t_ns);
            const Pose& b = r.decoded[i];
            EXPECT_EQ(a.flags & ~b.flags, 0u);
            if ((a.flags & flag::position_valid) != 0) {
                EXPECT_EQ(a.p_w_m.y, b.p_w_m.y) << i;
            }
            if ((a.flags & flag::orientation_valid) != 0) {
                EXPECT_EQ(a.q_wb.x, b.q_wb.x) << i;
            }
        }
    }
}
