// The byte rivals: what they say they sent can be read back, in time, within the tolerance.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "host_sim/study/baselines/compress/deflate.hpp"
#include "host_sim/study/baselines/compress/predictive.hpp"
#include "host_sim/study/baselines/compress/segments.hpp"
#include "host_sim/study/baselines/compress/sweep.hpp"

namespace {

using namespace fairlead::sim;

constexpr unsigned seed = 7;

/// A motion with noise, rests, fast turns and teleports.
Track motion(Channel channel, std::size_t n) {
    std::mt19937 random{seed};
    std::normal_distribution<double> normal{0, 1};
    Track track;
    track.channel = channel;
    track.period_s = 1 / 120.0;
    const Chart chart{channel};
    State at{channel == Channel::orientation ? 1.0 : 0.2, 0, 0, 0};
    Step speed{};
    for (std::size_t i = 0; i < n; ++i) {
        const bool rest = (i / 150) % 3 == 2;
        for (double& v : speed) v = rest ? 0 : 0.98 * v + 0.003 * normal(random);
        if (i % 333 == 332) at = chart.moved(at, {0.7, -0.4, 0.2});
        at = chart.moved(at, speed);
        State noisy = chart.moved(at, {1e-4 * normal(random), 1e-4 * normal(random), 0});
        track.t.push_back(static_cast<double>(i) * track.period_s);
        track.x.insert(track.x.end(), noisy.begin(), noisy.begin() + (track.dim() == 3 ? 3 : 4));
    }
    return track;
}

void expect_in_time(const std::vector<Frame>& frames, std::size_t records, std::size_t delay) {
    std::size_t covered = 0;
    for (const Frame& frame : frames) {
        ASSERT_GT(frame.end, covered);
        ASSERT_GE(frame.sent_at + 1, frame.end) << "a frame knows the future";
        EXPECT_LE(frame.sent_at, covered + delay) << "record " << covered;
        covered = frame.end;
    }
    EXPECT_EQ(covered, records);
}

std::set<std::size_t> restarts(const std::vector<Frame>& frames) {
    std::set<std::size_t> out;
    std::size_t first = 0;
    for (const Frame& frame : frames) {
        if (frame.restart) out.insert(first);
        first = frame.end;
    }
    return out;
}

template <class Params>
void expect_good(Channel channel, double tolerance, const Params& params) {
    const Track track = motion(channel, 1100);
    for (const std::size_t delay : {std::size_t{1}, std::size_t{7}, std::size_t{60},
                                    std::size_t{120}, std::size_t{240}, no_delay_bound}) {
        const auto frames = encode(track, tolerance, params, delay);
        if (delay != no_delay_bound) {
            expect_in_time(frames, track.size(), delay);
            EXPECT_EQ(restarts(frames), (std::set<std::size_t>{0, 240, 480, 720, 960}));
        }
        const auto bytes = write_frames(frames, 16);
        std::size_t size = 0;
        for (const std::string& frame : bytes) size += frame.size() + frame_overhead;
        const std::size_t counted = coded_size(frames, 16);
        EXPECT_GE(counted, size);
        EXPECT_LE(counted, size + contexts_max) << "more than the header's means";
        std::vector<Frame> shape = frames;
        for (Frame& frame : shape)
            for (Symbol& s : frame.symbols)
                if (s.plain_bits != 0) s.value = 0;  // coded values stay: the header's means
        const auto decoded = decode(read_frames(bytes, shape, 16), track, tolerance, params);
        ASSERT_EQ(decoded.size(), track.size());
        EXPECT_LE(largest_error(track, decoded), tolerance) << "delay " << delay;
    }
}

TEST(PeerCoders, PiecesKeepToleranceAndDelayOnWhatWasWritten) {
    for (const Channel channel : {Channel::position, Channel::orientation})
        for (const Pieces pieces :
             {Pieces::swing, Pieces::door, Pieces::peucker, Pieces::dead_band})
            for (const Choice choice : {Choice::near_prediction, Choice::least_squares})
                expect_good(channel, 0.004, SegmentParams{pieces, 0.5, choice, 0.5, true});
}

TEST(PeerCoders, PredictionKeepsToleranceAndDelayOnWhatWasWritten) {
    for (const Channel channel : {Channel::position, Channel::orientation})
        for (const Predictor predictor :
             {Predictor::last, Predictor::line, Predictor::tracker, Predictor::adaptive})
            for (const bool runs : {false, true})
                expect_good(channel, 0.004, PredictiveParams{predictor, 1, 0.5, 0.2, 1, 4, runs});
}

TEST(PeerCoders, FoldingIsOneToOne) {
    for (long v = -1000; v <= 1000; ++v) EXPECT_EQ(unfold(fold(v)), v);
}

TEST(PeerCoders, AbsoluteValuesStandAlone) {
    std::mt19937 random{seed};
    std::normal_distribution<double> normal{0, 1};
    for (const Channel channel : {Channel::position, Channel::orientation}) {
        Track track = motion(channel, 50);
        for (const double error_max : {0.1, 0.003, 1e-5}) {
            const Absolute absolute{track, error_max};
            for (std::size_t i = 0; i < track.size(); ++i) {
                std::vector<Symbol> symbols;
                absolute.put(symbols, i, Chart{channel}.sample(track, i));
                const Symbol* next = symbols.data();
                EXPECT_LE(track.error(i, absolute.get(next).data()), error_max);
                EXPECT_EQ(next, symbols.data() + symbols.size());
                for (const Symbol& s : symbols) EXPECT_LT(s.value, 1ull << s.plain_bits);
            }
        }
    }
}

TEST(PeerCoders, EveryRivalIsSweptAndKeepsItsTolerance) {
    for (const Channel channel : {Channel::position, Channel::orientation}) {
        std::multiset<std::string> rivals;
        std::set<std::string> settings;
        for (const Tried& tried : sweep(motion(channel, 500), 0.005, 120)) {
            rivals.insert(tried.rival);
            EXPECT_TRUE(settings.insert(tried.rival + tried.setting).second) << tried.setting;
            EXPECT_TRUE(tried.within) << tried.rival << ' ' << tried.setting;
        }
        EXPECT_EQ(std::set<std::string>(rivals.begin(), rivals.end()).size(), 7u);
        for (const std::string& rival : rivals) EXPECT_GE(rivals.count(rival), 20u) << rival;
    }
}

}  // namespace
