// From poses through stream, feed, registers and reader: the decoder's curve, or nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "examples/gateway/clock_map.hpp"
#include "examples/gateway/follower.hpp"
#include "examples/gateway/reader.hpp"
#include "examples/gateway/register_map.hpp"
#include "examples/gateway/unit_table.hpp"
#include "fairlead/math/quat.hpp"
#include "fairlead/pipeline.hpp"
#include "fairlead/wire/live.hpp"

namespace fairlead::gateway {
namespace {

using port::CurveChannel;
using port::CurveSpan;
namespace reg = register_map;

constexpr std::int64_t period_ns = 2'500'000;
constexpr float tolerance_m = 0.001f;
constexpr float tolerance_rad = 0.0043633f;

struct Config {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, fairlead::Orientation>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::medium;
    static constexpr std::size_t events_max = 0;
};

Pose pose_at(std::int64_t i, std::int64_t start_ns) {
    const double t = static_cast<double>(i) * 0.0025;
    const bool rest = std::fmod(t, 10.0) > 8.0;  // two seconds of rest in every ten
    const double s = rest ? std::floor(t / 10) * 10 + 8.0 : t;
    Pose pose;
    pose.t_ns = start_ns + i * period_ns;
    pose.p_w_m = {static_cast<float>(std::sin(1.3 * s)),
                  static_cast<float>(0.4 * std::cos(2.9 * s)),
                  static_cast<float>(1 + 0.1 * std::sin(7 * s))};
    const double a = 1.5 * std::sin(0.9 * s);
    const double b = 0.6 * std::cos(2.3 * s);
    pose.q_wb = normalised(Quat{static_cast<float>(std::cos(a) * std::cos(b)),
                                static_cast<float>(std::sin(a) * std::cos(b)),
                                static_cast<float>(std::cos(a) * std::sin(b)),
                                static_cast<float>(std::sin(a) * std::sin(b))});
    pose.flags = flag::position_valid | flag::orientation_valid;
    return pose;
}

/// A board, the gateway's side of one unit, and a reader, without sockets between them.
class Chain {
  public:
    explicit Chain(std::int64_t start_ns) : start_ns_{start_ns} {
        state.epoch = 42;
        table->begin(1, "test", SourceKind::serial, state.epoch, 2'000'000'000);
        server.counters = &counters;
    }
    std::vector<std::uint8_t> next() {
        const Pose pose = pose_at(sent_++, start_ns_);
        poses.push_back(pose);
        const Bytes bytes = board->push(pose);
        return {bytes.data, bytes.data + bytes.size};
    }
    void arrive(const std::vector<std::uint8_t>& bytes) {
        if (follower->take(bytes.data(), bytes.size())) follower->evaluate();
        feed->state.write(state);
        table->collect(*feed);
    }
    void reboot(std::int64_t start_ns) {
        board = std::make_unique<Pipeline<Config>>(params());
        start_ns_ = start_ns;
        sent_ = 0;
        poses.clear();
    }
    CurveReader make_reader() {
        return CurveReader{[this](std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
            table->refresh(server, 0);
            std::copy_n(table->registers() + address, count, out);
            return true;
        }};
    }
    static Pipeline<Config>::Params params() {
        Pipeline<Config>::Params p;
        p.sample_period_ns = period_ns;
        p.tolerance.position_m = tolerance_m;
        p.tolerance.orientation_rad = tolerance_rad;
        p.header_interval_ns = 5'000'000'000;  // a damaged one is not waited for so long
        return p;
    }

    std::vector<Pose> poses;
    UnitState state;
    std::unique_ptr<UnitFeed> feed = std::make_unique<UnitFeed>();
    std::unique_ptr<UnitTable> table = std::make_unique<UnitTable>();
    std::unique_ptr<CurveFollower> follower =
        std::make_unique<CurveFollower>(*feed, state, CurveFollower::WhenFull::drop);
    std::unique_ptr<Pipeline<Config>> board = std::make_unique<Pipeline<Config>>(params());
    port::ModbusCounters counters;
    ServerState server;

  private:
    std::int64_t start_ns_;
    std::int64_t sent_{};
};

/// How many of the poses the reader's curves cover; every one that they cover is within tolerance.
std::size_t covered(const CurveReader& reader, const std::vector<Pose>& poses) {
    std::size_t n = 0;
    for (const Pose& pose : poses) {
        const CurveSpan* o = reader.covering(CurveChannel::orientation, pose.t_ns);
        const CurveSpan* p = reader.covering(CurveChannel::position, pose.t_ns);
        if (o != nullptr) {
            EXPECT_LE(rotation_angle(port::curve::orientation(*o, pose.t_ns), pose.q_wb),
                      tolerance_rad + 2e-6f);
        }
        if (p != nullptr) {
            const Vec3 d = port::curve::position(*p, pose.t_ns) - pose.p_w_m;
            // floats of about 1: a unit in the last place of the curve, and one of the difference
            EXPECT_LE(std::abs(d.x), tolerance_m + 2.5e-7f);
            EXPECT_LE(std::abs(d.y), tolerance_m + 2.5e-7f);
            EXPECT_LE(std::abs(d.z), tolerance_m + 2.5e-7f);
        }
        n += o != nullptr && p != nullptr ? 1 : 0;
    }
    return n;
}

/// The pieces of a stream by a decoder of their own, evaluated in double.
struct Reference {
    wire::Decoder<3, 1> decoder{};
    std::array<std::vector<wire::CurvePiece>, 4> tracks{};  // three axes, the rotation

    void take(const std::vector<std::uint8_t>& bytes) {
        for (const std::uint8_t byte : bytes) {
            if (!decoder.push(byte)) continue;
            for (wire::CurvePiece piece; decoder.next(piece);)
                tracks[piece.rotates ? 3 : piece.axis].push_back(piece);
        }
    }
};

double apart(const BasicQuat<double>& a, const Quat& b) {
    const BasicQuat<double> wide{b.w, b.x, b.y, b.z};
    return 2 * norm(vec(conj(a) * wide));
}

TEST(Curve, APollerOfOnceASecondHasTheDecodersCurve) {
    Chain chain{123'456'789};
    CurveReader reader = chain.make_reader();
    ASSERT_EQ(reader.identify(), PollResult::ok);
    Reference reference;
    for (int i = 0; i < 400 * 60; ++i) {
        const auto bytes = chain.next();
        chain.arrive(bytes);
        reference.take(bytes);
        if (i % 400 == 399) {
            ASSERT_EQ(reader.poll(), PollResult::ok);
        }
    }
    EXPECT_EQ(reader.counters().lost_spans, 0u);
    const curve::Grid& grid = reference.decoder.grid();
    std::size_t compared = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        for (const wire::CurvePiece& piece : reference.tracks[k]) {
            // both ends, and places that are no vertex of any axis
            for (std::int64_t at = piece.start + 1; at <= piece.end; at += 61) {
                const std::int64_t t = grid.time_ns(at == piece.start + 1 ? piece.end : at);
                const auto channel = k < 3 ? CurveChannel::position : CurveChannel::orientation;
                if (t > reader.covered_until_ns(channel)) continue;
                const CurveSpan* span = reader.covering(channel, t);
                ASSERT_NE(span, nullptr) << "track " << k << " time " << t;
                ++compared;
                if (k == 3) {
                    const auto told = wire::orientation_motion<double>(piece, grid, t).q_wb;
                    ASSERT_LT(apart(told, port::curve::orientation(*span, t)), 1.5e-6);
                    continue;
                }
                const double told = wire::axis_motion<double>(piece, grid, t).value;
                const Vec3 got = port::curve::position(*span, t);
                ASSERT_NEAR(told, static_cast<double>(component(got, k)), 2e-7);
            }
        }
    }
    EXPECT_GT(compared, 50000u);
}

TEST(Curve, JumpsAndLonelyRecordsArriveAsTheyAre) {
    Chain chain{0};
    CurveReader reader = chain.make_reader();
    std::vector<Pose> poses;
    const auto push = [&](Pose pose) {
        poses.push_back(pose);
        const Bytes bytes = chain.board->push(pose);
        chain.arrive({bytes.begin(), bytes.end()});
    };
    for (std::int64_t i = 0; i < 6000; ++i) {
        Pose pose = pose_at(i, 0);
        if (i % 50 > 40) pose.p_w_m.y += i % 2 == 0 ? 3.0f : -3.0f;                // teleports
        if (i % 700 > 600 && i % 700 != 650) pose.flags &= ~flag::position_valid;  // one alone
        push(pose);
    }
    for (Bytes bytes; bytes.status != Status::end;) {
        bytes = chain.board->flush();
        chain.arrive({bytes.begin(), bytes.end()});
    }
    chain.follower->finish();
    chain.table->collect(*chain.feed);
    ASSERT_EQ(reader.poll(), PollResult::ok);
    std::size_t lone = 0;
    for (std::size_t i = poses.size() - 100; i < poses.size(); ++i) {
        const auto* span = reader.covering(CurveChannel::position, poses[i].t_ns);
        if ((poses[i].flags & flag::position_valid) == 0) continue;
        ASSERT_NE(span, nullptr) << "record " << i;
        const Vec3 d = port::curve::position(*span, poses[i].t_ns) - poses[i].p_w_m;
        EXPECT_LE(norm(d), 1.733f * tolerance_m + 1e-6f) << "record " << i;
        ++lone;
    }
    EXPECT_GT(lone, 20u);
    EXPECT_GT(chain.state.breaks, 100u);
    EXPECT_GT(chain.state.gaps, 5u);
}

TEST(Curve, PolledOnceASecondNothingIsMissingBetweenFirstAndLast) {
    Chain chain{0};
    CurveReader reader = chain.make_reader();
    for (int i = 0; i < 400 * 60; ++i) {
        chain.arrive(chain.next());
        if (i % 400 == 399) {
            ASSERT_EQ(reader.poll(), PollResult::ok);
        }
    }
    for (Bytes bytes; bytes.status != Status::end;) {
        bytes = chain.board->flush();
        chain.arrive({bytes.begin(), bytes.end()});
    }
    ASSERT_EQ(reader.poll(), PollResult::ok);
    EXPECT_EQ(covered(reader, chain.poses), chain.poses.size());
    EXPECT_EQ(chain.state.gaps, 0u);
}

TEST(Curve, DamagedBytesCostTimeButNeverGiveAWrongValue) {
    const unsigned seed = 4711;
    std::mt19937 random{seed};
    Chain chain{0};
    CurveReader reader = chain.make_reader();
    for (int i = 0; i < 400 * 120; ++i) {
        auto bytes = chain.next();
        for (auto& byte : bytes) {
            if (random() % 100 == 0) byte ^= static_cast<std::uint8_t>(1 + random() % 255);
        }
        chain.arrive(bytes);
        if (i % 400 == 399) {
            ASSERT_EQ(reader.poll(), PollResult::ok);
        }
    }
    const std::size_t n = covered(reader, chain.poses);
    EXPECT_GT(n, chain.poses.size() / 50) << "seed " << seed;
    EXPECT_LT(n, chain.poses.size());
    EXPECT_GT(chain.state.frames_damaged, 0u);
    EXPECT_GT(chain.state.resyncs, 0u);
}

TEST(Curve, AfterDamageTheNextWholeRestartFrameIsEnough) {
    std::mt19937 random{99};
    Chain chain{0};
    for (int trial = 0; trial < 20; ++trial) {
        for (int i = 0; i < 200 + trial * 37; ++i) chain.arrive(chain.next());
        for (int i = 0; i < 50; ++i) {  // the line breaks down for an eighth of a second
            auto bytes = chain.next();
            for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
            chain.arrive(bytes);
        }
        int records = 0;
        while (chain.follower->decoder().in_step() && records < 10) {  // not noticed yet
            chain.arrive(chain.next());
            ++records;
        }
        while (!chain.follower->decoder().in_step() && records < 10000) {
            chain.arrive(chain.next());
            ++records;
        }
        EXPECT_LE(records, 800 + 3 * 120)
            << "2 s, the restart interval, and two frames that confirm it";
    }
}

TEST(Curve, ABoardThatBeginsAnewIsANewRun) {
    Chain chain{5'000'000'000};
    CurveReader reader = chain.make_reader();
    for (int i = 0; i < 2000; ++i) chain.arrive(chain.next());
    ASSERT_EQ(reader.poll(), PollResult::ok);
    const std::uint32_t first = reader.epoch();
    EXPECT_EQ(first, 42u);
    chain.reboot(0);
    for (int i = 0; i < 2000; ++i) chain.arrive(chain.next());
    EXPECT_EQ(reader.poll(), PollResult::new_run);
    reader.begin_run();
    ASSERT_EQ(reader.poll(), PollResult::ok);
    EXPECT_NE(reader.epoch(), first);
    EXPECT_GT(covered(reader, chain.poses), 1500u);
    EXPECT_EQ(reader.covering(CurveChannel::position, 5'000'000'000), nullptr);
}

TEST(Curve, TooLateAPollCountsWhatItLost) {
    Chain chain{0};
    CurveReader reader = chain.make_reader();
    chain.arrive(chain.next());
    ASSERT_EQ(reader.poll(), PollResult::ok);
    std::size_t spans = 0;
    for (int i = 0; spans < 500; ++i) {
        chain.arrive(chain.next());
        chain.table->refresh(chain.server, 0);
        spans = reg::get_word(chain.table->registers(), reg::field("orientation.next"));
    }
    ASSERT_EQ(reader.poll(), PollResult::ok);
    EXPECT_GT(reader.counters().lost_spans, 0u);
    covered(reader, chain.poses);
}

TEST(Curve, LiveRatesAreTheCurvesDerivatives) {
    Chain chain{0};
    for (int i = 0; i < 2000; ++i) chain.arrive(chain.next());
    const std::int64_t t = chain.state.source_ns;
    const auto at = [](std::int64_t t_ns) { return pose_at(t_ns / period_ns, 0); };
    const Vec3 v = 200.0f * (at(t + period_ns).p_w_m - at(t - period_ns).p_w_m);
    const Vec3 w = 200.0f * rotation_vector(conj(at(t - period_ns).q_wb) * at(t + period_ns).q_wb);
    EXPECT_NEAR(chain.state.v_w_m_s.x, v.x, 0.1);
    EXPECT_NEAR(chain.state.v_w_m_s.y, v.y, 0.1);
    EXPECT_NEAR(chain.state.v_w_m_s.z, v.z, 0.1);
    EXPECT_NEAR(chain.state.rate_rad_s.x, w.x, 0.3);
    EXPECT_NEAR(chain.state.rate_rad_s.y, w.y, 0.3);
    EXPECT_NEAR(chain.state.rate_rad_s.z, w.z, 0.3);
}

TEST(ClockMap, TheSmallestDelayWinsAndTheErrorIsBounded) {
    const unsigned seed = 9;
    std::mt19937 random{seed};
    ClockMap map;
    const std::int64_t truth = 987'654'321'000;
    for (std::int64_t i = 0; i < 100; ++i) {
        const std::int64_t t = i * 2'000'000'000;
        const std::int64_t drift = i * 100'000;  // 50 ppm
        const std::int64_t delay =
            50'000 + static_cast<std::int64_t>(random() % 900'000) + (i % 5 == 0 ? 30'000'000 : 0);
        const std::int64_t arrival = t + truth + drift + 200'000 + delay;
        map.mark(t, arrival, 200'000, 2'500'000);
        if (i < 8) continue;
        const std::int64_t error = map.offset_ns() - (truth + drift);
        EXPECT_LE(std::abs(error), map.error_ns(arrival)) << "seed " << seed << " at " << i;
        EXPECT_LT(map.error_ns(arrival), 8'000'000);
    }
}

}  // namespace
}  // namespace fairlead::gateway
