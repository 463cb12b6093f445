// The contract of the stream: every accepted sample within tolerance of the decoded curve, in time,
// bit for bit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "fairlead/pipeline.hpp"
#include "fairlead/reduce/evaluate.hpp"
#include "fairlead/wire/decoder.hpp"

using namespace fairlead;

namespace {

struct Config : PipelineConfig {
    static constexpr std::size_t window = 120;
};

template <class Channel>
struct Store {  // all pieces that a decoder has told, on the host
    struct Piece {
        Curve<Channel> curve;
        bool begins;
    };
    std::vector<Piece> pieces;
    std::vector<std::int64_t> covered;  // per piece: final before this

    void take(const wire::Link<Channel>& link, const Decoder::Update& update,
              std::uint32_t tick_ns) {
        const std::int64_t t0 = link.curve.span.t0_ns;
        if (update.piece) {
            if (!update.begins && !update.rejoined && !covered.empty()) covered.back() = t0;
            pieces.push_back({link.curve, update.begins || update.rejoined});
            covered.push_back(t0);
        }
        covered.back() = t0 + std::int64_t{link.cover_ticks} * tick_ns;
    }

    bool at(std::int64_t t, std::uint32_t tick_ns, const typename Channel::Scale& scale,
            typename Channel::Value& value) const {
        for (std::size_t i = pieces.size(); i-- > 0;) {
            if (pieces[i].curve.span.t0_ns > t) continue;
            if (t >= covered[i]) return false;
            value = value_at(pieces[i].curve, scale, tick_ns, t);
            return true;
        }
        return false;
    }
};

struct Player {
    std::unique_ptr<Decoder> decoder = std::make_unique<Decoder>();
    Store<VectorChannel<3>> position;
    Store<OrientationChannel> orientation;

    void push(const std::uint8_t* data, std::size_t size) {
        for (std::size_t i = 0; i < size; ++i)
            if (decoder->push(data[i])) drain();
    }
    void finish() {
        while (decoder->finish()) drain();
    }
    void drain() {
        Decoder::Update update;
        while (decoder->next(update)) {
            if (update.channel == Decoder::Channel::position)
                position.take(decoder->position(), update, decoder->tick_ns());
            else
                orientation.take(decoder->orientation(), update, decoder->tick_ns());
        }
    }
    bool at(std::int64_t t, std::array<float, 3>& p) const {
        return position.at(t, decoder->tick_ns(), decoder->position().scale, p);
    }
    bool at(std::int64_t t, Quat& q) const {
        return orientation.at(t, decoder->tick_ns(), decoder->orientation().scale, q);
    }
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

        Player final_curve, prefix;
        final_curve.push(out.bytes.data(), out.bytes.size());
        ASSERT_EQ(final_curve.decoder->counters().damaged, 0u);
        std::size_t fed = 0;
        for (std::size_t i = 0; i < poses.size() + params.delay_max; ++i) {
            const std::size_t to = i < poses.size() ? out.present[i] : out.bytes.size();
            prefix.push(out.bytes.data() + fed, to - fed);
            fed = to;
            if (i < params.delay_max) continue;
            const Pose& in = out.accepted[i - params.delay_max];
            if (in.flags & flag::position_valid) {
                std::array<float, 3> p, early;
                ASSERT_TRUE(final_curve.at(in.t_ns, p)) << "record " << i - params.delay_max;
                ASSERT_TRUE(prefix.at(in.t_ns, early)) << "record " << i - params.delay_max;
                ASSERT_EQ(std::memcmp(&p, &early, sizeof p), 0);
                const float s[3] = {in.p_w_m.x, in.p_w_m.y, in.p_w_m.z};
                const double tol[3] = {double{params.tol_position_m[0]},
                                       double{params.tol_position_m[1]},
                                       double{params.tol_position_m[2]}};
                for (std::size_t d = 0; d < 3; ++d)
                    ASSERT_LE(std::fabs(double{p[d]} - double{s[d]}), tol[d]);
            }
            if (in.flags & flag::orientation_valid) {
                Quat q, early;
                ASSERT_TRUE(final_curve.at(in.t_ns, q));
                ASSERT_TRUE(prefix.at(in.t_ns, early));
                ASSERT_EQ(std::memcmp(&q, &early, sizeof q), 0);
                ASSERT_LE(angle(q, in.q_wb), double{params.tol_orientation_rad});
            }
        }
    }
}

TEST(Stream, NoticesEveryFlippedBitAndComesBackAtTheNextRestart) {
    const auto poses = motion(3, 900);
    EncoderParams params;
    params.restart_interval_ns = 1000000000;
    const Encoded out = run(poses, params);
    Player clean;
    clean.push(out.bytes.data(), out.bytes.size());
    std::mt19937 random{5};
    for (int trial = 0; trial < 300; ++trial) {
        auto bytes = out.bytes;
        const std::size_t at = random() % bytes.size();
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << random() % 8));
        Player player;
        player.push(bytes.data(), bytes.size());
        player.finish();
        SCOPED_TRACE(testing::Message() << "byte " << at << " of " << bytes.size());
        ASSERT_LT(player.decoder->counters().frames, clean.decoder->counters().frames);
        std::size_t known = 0;
        for (const Pose& pose : out.accepted) {
            std::array<float, 3> p, q;
            if (!(pose.flags & flag::position_valid) || !player.at(pose.t_ns, p)) continue;
            ++known;
            ASSERT_TRUE(clean.at(pose.t_ns, q));
            ASSERT_EQ(std::memcmp(&p, &q, sizeof p), 0) << "a wrong value was believed";
        }
        if (at + 800 < bytes.size()) {
            ASSERT_GT(known, 0u);
        }
    }
}

TEST(Stream, CutAnywhereGivesAllFramesBeforeTheCut) {
    const Encoded out = run(motion(4, 400), {});
    Player growing;
    for (std::size_t cut = 0; cut < out.bytes.size(); ++cut) {
        Player player;
        player.push(out.bytes.data(), cut);
        player.finish();
        ASSERT_EQ(player.decoder->counters().frames, growing.decoder->counters().frames);
        ASSERT_EQ(player.position.pieces.size(), growing.position.pieces.size());
        growing.push(&out.bytes[cut], 1);
    }
}
