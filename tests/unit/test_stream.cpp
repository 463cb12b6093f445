// The contract of the stream: every accepted sample within tolerance of the decoded curve, in time,
// bit for bit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

#include "fairlead/pipeline.hpp"
#include "host_sim/curve_store.hpp"

using namespace fairlead;

namespace {

struct Config : PipelineConfig {
    static constexpr std::size_t window = 120;
};

/// Smooth motion with rests, one-channel drop-outs, gaps, teleports and noise.
std::vector<Pose> motion(unsigned seed, std::size_t n) {
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    std::vector<Pose> out;
    double t = 100, a[3] = {}, v[3] = {}, p[3] = {0.3, -1, 0.8}, w[3] = {};
    Quat q;
    std::size_t position_off = 0, orientation_off = 0, rest = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double h = (1 + 0.2 * (uniform(random) - 0.5)) / 120;
        t += h;
        if (uniform(random) < 0.002) t += 0.5 * uniform(random);
        if (uniform(random) < 0.003) rest = 150;
        if (uniform(random) < 0.001) p[0] += normal(random);
        if (uniform(random) < 0.003) position_off = 30;
        if (uniform(random) < 0.003) orientation_off = 5;
        const double move = rest > 0 ? 0.0 : 1.0;
        for (int d = 0; d < 3; ++d) {
            a[d] += (-a[d] * 3 - v[d] * 4) * h + 6 * std::sqrt(h) * normal(random);
            v[d] = move * (v[d] + a[d] * h);
            p[d] += v[d] * h;
            w[d] = move * (w[d] * (1 - h) + 4 * std::sqrt(h) * normal(random));
        }
        q = normalised(q * from_rotation_vector(Vec3{static_cast<float>(w[0] * h),
                                                     static_cast<float>(w[1] * h),
                                                     static_cast<float>(w[2] * h)}));
        Pose pose;
        pose.t_ns = static_cast<std::int64_t>(t * 1e9);
        pose.p_w_m = {static_cast<float>(p[0] + 1e-4 * normal(random)),
                      static_cast<float>(p[1] + 1e-4 * normal(random)),
                      static_cast<float>(p[2] + 1e-4 * normal(random))};
        pose.q_wb = q;
        if (position_off == 0) pose.flags |= flag::position_valid;
        if (orientation_off == 0) pose.flags |= flag::orientation_valid;
        position_off -= position_off > 0;
        orientation_off -= orientation_off > 0;
        rest -= rest > 0;
        out.push_back(pose);
    }
    return out;
}

struct Encoded {
    std::vector<std::uint8_t> bytes;
    std::vector<std::size_t> present;  // bytes after each record
    std::vector<Pose> accepted;        // per record; no flags where refused
};

Encoded run(const std::vector<Pose>& poses, const EncoderParams& encoder) {
    Pipeline<Config>::Params params;
    params.encoder = encoder;
    const auto pipeline = std::make_unique<Pipeline<Config>>(params);
    Encoded out;
    const auto take = [&](const Bytes& b) {
        out.bytes.insert(out.bytes.end(), b.data, b.data + b.size);
    };
    for (const Pose& pose : poses) {
        take(pipeline->push(pose));
        out.present.push_back(out.bytes.size());
        out.accepted.push_back(pipeline->filtered() ? *pipeline->filtered() : Pose{});
    }
    for (Bytes b = pipeline->flush(); !b.empty(); b = pipeline->flush()) take(b);
    return out;
}

std::string_view view(const std::vector<std::uint8_t>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

double angle(const Quat& a, const Quat& b) {
    const BasicQuat<double> p{a.w, a.x, a.y, a.z}, q{b.w, b.x, b.y, b.z};
    return rotation_angle(normalised(p), normalised(q));
}

}  // namespace

TEST(Stream, KeepsEverySampleWithinToleranceAndInTime) {
    for (unsigned seed = 1; seed <= 1000; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        std::minstd_rand random{seed * 77};
        EncoderParams params;
        const float mm = 0.0003f * static_cast<float>(1 + random() % 20);
        params.tol_position_m = {mm, 2 * mm, mm / 3};
        params.tol_orientation_rad = 0.002f * static_cast<float>(1 + random() % 20);
        params.delay_max = static_cast<std::uint32_t>(20 + random() % 100);
        params.slice = static_cast<Credit>(1000 + random() % 100000);
        const auto poses = motion(seed, seed % 10 == 0 ? 1500 : 500);
        const Encoded out = run(poses, params);

        sim::CurveStore final_curve, prefix;
        final_curve.push(view(out.bytes));
        ASSERT_EQ(final_curve.counters().damaged, 0u);
        std::size_t fed = 0;
        for (std::size_t i = 0; i < poses.size() + params.delay_max; ++i) {
            const std::size_t to = i < poses.size() ? out.present[i] : out.bytes.size();
            prefix.push(view(out.bytes).substr(fed, to - fed));
            fed = to;
            if (i < params.delay_max) continue;
            const Pose& in = out.accepted[i - params.delay_max];
            const Pose curve = final_curve.at(in.t_ns), early = prefix.at(in.t_ns);
            if (in.flags & flag::position_valid) {
                ASSERT_TRUE(curve.flags & flag::position_valid) << i;
                ASSERT_TRUE(early.flags & flag::position_valid) << "not in time at record " << i;
                ASSERT_EQ(std::memcmp(&curve.p_w_m, &early.p_w_m, sizeof curve.p_w_m), 0);
                const auto far = [](float p, float q) { return std::fabs(double{p} - double{q}); };
                ASSERT_LE(far(curve.p_w_m.x, in.p_w_m.x), double{params.tol_position_m[0]});
                ASSERT_LE(far(curve.p_w_m.y, in.p_w_m.y), double{params.tol_position_m[1]});
                ASSERT_LE(far(curve.p_w_m.z, in.p_w_m.z), double{params.tol_position_m[2]});
            }
            if (in.flags & flag::orientation_valid) {
                ASSERT_TRUE(curve.flags & flag::orientation_valid) << i;
                ASSERT_TRUE(early.flags & flag::orientation_valid) << "not in time at record " << i;
                ASSERT_EQ(std::memcmp(&curve.q_wb, &early.q_wb, sizeof curve.q_wb), 0);
                ASSERT_LE(angle(curve.q_wb, in.q_wb), double{params.tol_orientation_rad});
            }
        }
    }
}

TEST(Stream, NoticesEveryFlippedBitAndComesBackAtTheNextRestart) {
    const auto poses = motion(3, 900);
    EncoderParams params;
    params.restart_interval_ns = 1000000000;
    const Encoded out = run(poses, params);
    sim::CurveStore clean;
    clean.push(view(out.bytes));
    std::mt19937 random{5};
    for (int trial = 0; trial < 300; ++trial) {
        auto bytes = out.bytes;
        const std::size_t at = random() % bytes.size();
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << random() % 8));
        sim::CurveStore damaged;
        damaged.push(view(bytes));
        damaged.finish();
        SCOPED_TRACE(testing::Message() << "byte " << at << " of " << bytes.size());
        ASSERT_LT(damaged.counters().frames, clean.counters().frames);
        std::size_t known = 0;
        for (const Pose& pose : out.accepted) {
            const Pose told = damaged.at(pose.t_ns), truth = clean.at(pose.t_ns);
            if (!(pose.flags & told.flags & flag::position_valid)) continue;
            ++known;
            ASSERT_TRUE(truth.flags & flag::position_valid);
            ASSERT_EQ(std::memcmp(&told.p_w_m, &truth.p_w_m, sizeof told.p_w_m), 0)
                << "a wrong value was believed";
        }
        if (at + 800 < bytes.size()) {
            ASSERT_GT(known, 0u);
        }
    }
}

TEST(Stream, CutAnywhereGivesAllFramesBeforeTheCut) {
    const Encoded out = run(motion(4, 400), {});
    sim::CurveStore growing;
    for (std::size_t cut = 0; cut < out.bytes.size(); ++cut) {
        sim::CurveStore all;
        all.push(view(out.bytes).substr(0, cut));
        all.finish();
        ASSERT_EQ(all.counters().frames, growing.counters().frames);
        ASSERT_EQ(all.position().pieces().size(), growing.position().pieces().size());
        growing.push(view(out.bytes).substr(cut, 1));
    }
}

TEST(Stream, ALogInWhichTheClockStartsAnewHoldsTwoRuns) {
    const Encoded first = run(motion(6, 500), {}), second = run(motion(7, 300), {});
    auto log = first.bytes;
    log.insert(log.end(), second.bytes.begin(), second.bytes.end());
    sim::CurveStore both, one, two;
    both.push(view(log));
    one.push(view(first.bytes));
    two.push(view(second.bytes));
    ASSERT_EQ(one.runs().size(), 1u);
    ASSERT_EQ(both.runs().size(), 2u);
    EXPECT_EQ(both.runs()[0].position.curves(), one.position().curves());
    EXPECT_EQ(both.runs()[1].position.curves(), two.position().curves());
    for (const Pose& pose : first.accepted) {
        const Pose kept = both.runs()[0].at(pose.t_ns), alone = one.at(pose.t_ns);
        ASSERT_EQ(std::memcmp(&kept, &alone, sizeof kept), 0);
    }
    for (const Pose& pose : second.accepted) {
        const Pose kept = both.runs()[1].at(pose.t_ns), alone = two.at(pose.t_ns);
        ASSERT_EQ(std::memcmp(&kept, &alone, sizeof kept), 0);
    }
}
