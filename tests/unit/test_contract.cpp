// The contract of a whole pipeline, from the bytes: what is accepted is covered, within tolerance,
// in time. One test for each way in which it was once broken.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/pipeline/pipeline_check.hpp"

namespace {

using namespace fairlead;

constexpr std::int64_t ms = 1'000'000, s = 1000 * ms;
constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();

struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, Orientation>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 60;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = 0;
};
using Check60 = test::PipelineCheck<Board>;

/// A hand that moves and rests, with a little noise.
Pose motion(std::int64_t t_ns, double seconds, std::mt19937_64& random) {
    const auto rough = [&random] {
        return static_cast<float>(static_cast<double>(random() >> 11) * 0x1p-53 - 0.5);
    };
    const double u = std::sin(seconds) > 0.5 ? std::floor(seconds) : seconds;
    const auto f = [](double x) { return static_cast<float>(x); };
    return {
        t_ns,
        {f(0.3 * std::sin(2 * u)) + 2e-4f * rough(), f(0.2 * std::cos(3 * u)), 1 + 2e-4f * rough()},
        from_rotation_vector(Vec3{f(0.5 * std::sin(2 * u)), 1e-3f * rough(), f(0.1 * u)}),
        flag::position_valid | flag::orientation_valid};
}

/// Feeds times; each is its own record. @return the verdict after the end.
test::Verdict feed(Check60& check, const std::vector<std::int64_t>& times, double period_s) {
    std::mt19937_64 random{7};
    double seconds = 0;
    for (const std::int64_t t : times) check.push(motion(t, seconds += period_s, random));
    check.finish();
    return check.verdict();
}
test::Verdict feed(const std::vector<std::int64_t>& times, std::int64_t period_ns) {
    Check60::Params params;
    params.sample_period_ns = period_ns;
    Check60 check{params};
    return feed(check, times, static_cast<double>(period_ns) * 1e-9);
}
void expect_all(const test::Verdict& v, std::uint64_t accepted) {
    EXPECT_TRUE(v.good()) << v.first;
    EXPECT_EQ(v.accepted, accepted);
    EXPECT_GT(v.worst, 0.1);  // the check looks at something
    EXPECT_LE(v.worst, 1.0);
}

std::vector<std::int64_t> even(std::int64_t from, std::int64_t period, int n) {
    std::vector<std::int64_t> times;
    for (int i = 0; i < n; ++i)
        times.push_back(static_cast<std::int64_t>(static_cast<std::uint64_t>(from) +
                                                  static_cast<std::uint64_t>(i * period)));
    return times;
}
template <class... More>
std::vector<std::int64_t> joined(std::vector<std::int64_t> a, const More&... more) {
    (a.insert(a.end(), more.begin(), more.end()), ...);
    return a;
}

}  // namespace

// Nothing given but the period, or not even that: rates from 25 Hz to 1 kHz, jitter of 30 %.
TEST(Contract, HoldsAtEveryUsualRateByDefault) {
    for (const std::int64_t hz : {25, 60, 100, 120, 200, 400, 1000})
        for (const bool told : {true, false})
            for (const bool jitter : {false, true}) {
                SCOPED_TRACE(std::to_string(hz) + (told ? " Hz" : " Hz, measured") +
                             (jitter ? ", jitter" : ""));
                std::mt19937_64 random{static_cast<unsigned>(hz)};
                const std::int64_t period = s / hz;
                std::vector<std::int64_t> times = even(s, period, 500);
                if (jitter)
                    for (std::int64_t& t : times)
                        t += static_cast<std::int64_t>(random() % 601) * period / 1000 -
                             300 * period / 1000;
                Check60::Params params;
                if (told) params.sample_period_ns = period;
                Check60 check{params};
                expect_all(feed(check, times, 1.0 / static_cast<double>(hz)), 500);
            }
}

// One pose kilometres away: refused where the lattice ends, covered up to there.
TEST(Contract, AnOutlierIsCoveredOrRefused) {
    for (const float far : {0.5f, 5000.0f, 3e5f, 4e5f, 1e30f})
        for (const float tolerance : {1e-6f, 1e-3f, 0.5f}) {
            SCOPED_TRACE(std::to_string(far) + " m at " + std::to_string(tolerance));
            Check60::Params params;
            params.sample_period_ns = 8 * ms;
            params.tolerance.position_m = tolerance;
            Check60 check{params};
            std::mt19937_64 random{1};
            for (int i = 0; i < 400; ++i) {
                Pose pose = motion(i * 8 * ms, i * 0.008, random);
                if (i == 200) pose.p_w_m.y = far;
                check.push(pose);
            }
            check.finish();
            EXPECT_TRUE(check.verdict().good()) << check.verdict().first;
            EXPECT_EQ(check.verdict().accepted, 400u);
            const float range = check.chain().intake().limits().position_max_m;
            EXPECT_EQ(check.chain().intake().faults()[Fault::out_of_range], far > range ? 1u : 0u);
            EXPECT_NEAR(range / (1.2f * tolerance * curve::value_steps_max), 1, 0.01);
        }
}

// The clock goes back, by an hour, by one record, to the ends of time; it leaps from 1970 to now.
TEST(Contract, AClockThatStartsAnewLosesNothing) {
    const std::int64_t now = 1'700'000'000 * s;
    for (const std::int64_t start :
         {now - 3600 * s, now - 20 * ms, now + std::int64_t{365} * 86400 * s, std::int64_t{0},
          least, most - 400 * 8 * ms}) {
        SCOPED_TRACE(start);
        const auto v = feed(joined(even(now, 8 * ms, 300), even(start, 8 * ms, 300)), 8 * ms);
        expect_all(v, 600);
        EXPECT_EQ(v.runs, 2u);
    }
    const auto v = feed(joined(even(5 * s, 8 * ms, 300), even(now, 8 * ms, 300)), 8 * ms);
    expect_all(v, 600);
    EXPECT_EQ(v.runs, 2u);
}

TEST(Contract, ALoneWrongStampCostsItself) {
    const std::int64_t now = 1'700'000'000 * s;
    for (const std::int64_t wrong : {least, std::int64_t{0}, now - 50 * s, now + 30 * s, most}) {
        SCOPED_TRACE(wrong);
        std::vector<std::int64_t> times = even(now, 8 * ms, 600);
        times[300] = wrong;
        // up to a minute ahead it passes as a record after a pause; else it is refused
        expect_all(feed(times, 8 * ms), wrong == now + 30 * s ? 600 : 599);
    }
}

// Two wrong stamps that agree are a run of their own; a wrong first stamp is one, too.
TEST(Contract, WrongStampsThatAgreeLoseNothing) {
    std::vector<std::int64_t> two = even(1'700'000'000 * s, 8 * ms, 400);
    two[200] += 90 * s;
    two[201] += 90 * s;
    const auto v = feed(two, 8 * ms);
    expect_all(v, 400);
    EXPECT_EQ(v.runs, 3u);
    std::vector<std::int64_t> first = even(1'700'000'000 * s, 8 * ms, 400);
    first[0] += 1'000'000 * s;
    expect_all(feed(first, 8 * ms), 400);
}

// At any time of an int64, with pauses of any length up to leap_ns, and beyond it.
TEST(Contract, PausesBeginCurves) {
    for (const std::int64_t pause :
         {90 * ms, 110 * ms, 600 * ms, 59 * s, 61 * s, std::int64_t{4000} * 86400 * s}) {
        SCOPED_TRACE(pause);
        const auto v =
            feed(joined(even(s, 8 * ms, 200), even(s + 199 * 8 * ms + pause, 8 * ms, 200)), 8 * ms);
        expect_all(v, 400);
        EXPECT_EQ(v.runs, pause > 60 * s ? 2u : 1u);
    }
}

TEST(Contract, ShortStreamsAreCovered) {
    for (int n = 1; n <= 70; ++n) {
        SCOPED_TRACE(n);
        const auto v = feed(even(s, 8 * ms, n), 8 * ms);
        EXPECT_TRUE(v.good()) << v.first;
        EXPECT_EQ(v.accepted, static_cast<std::uint64_t>(n));
    }
}
