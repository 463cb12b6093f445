// Discrete channels through pipeline and codec: exact times, in order, each once, in time; what is
// missing is counted and flagged; damage to events costs no curve, and the other way round.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "fairlead/imu_pipeline.hpp"
#include "fairlead/pipeline.hpp"
#include "fairlead/reduce/evaluate.hpp"
#include "fairlead/wire/decoder.hpp"

namespace {

using namespace fairlead;

constexpr std::size_t queue = 8;
constexpr std::int64_t period_ns = 8'333'333;

bool same(const Event& a, const Event& b) {
    return a.t_ns == b.t_ns && a.channel == b.channel && a.value == b.value;
}

struct Config : PipelineConfig {
    static constexpr std::size_t window = 32;
    static constexpr std::size_t events = queue;
};

/// A swing, given in float as a tracker does.
Pose swing(std::int64_t i) {
    Pose pose;
    pose.t_ns = 5'000'000'000 + i * period_ns;
    const double x = 0.03 * static_cast<double>(i);
    pose.p_w_m = {static_cast<float>(0.3 * std::sin(x)), static_cast<float>(0.2 * std::cos(x)), 1};
    pose.q_wb = from_rotation_vector(Vec3{0, 0, static_cast<float>(std::sin(x))});
    pose.flags = flag::position_valid | flag::orientation_valid;
    return pose;
}

/// A time of any size, with the extremes among them.
std::int64_t any_time(std::mt19937_64& random) {
    constexpr std::int64_t edge[] = {0, 1, -1, INT64_MAX, INT64_MIN, INT64_MAX - 1};
    const std::uint64_t bits = random();
    if (bits % 5 == 0) return edge[bits / 5 % 6];
    return static_cast<std::int64_t>(random()) >> (bits % 64);
}

Event any_event(std::mt19937_64& random, std::uint16_t channels) {
    Event event;
    event.t_ns = any_time(random);
    event.channel = static_cast<std::uint16_t>(random() % channels);
    event.value = static_cast<std::uint16_t>(random() >> random() % 64);
    return event;
}

struct Heard {
    std::vector<Event> events;
    EventReader::Counters counters;
    Decoder::Counters curves;
};

void drain(Decoder& decoder, std::vector<Event>& events) {
    Decoder::Update update;
    while (decoder.next(update)) {
    }
    Event event;
    while (decoder.next_event(event)) events.push_back(event);
}

Heard hear(const std::vector<std::uint8_t>& bytes) {
    const auto decoder = std::make_unique<Decoder>();
    Heard heard;
    for (const std::uint8_t byte : bytes)
        if (decoder->push(byte)) drain(*decoder, heard.events);
    while (decoder->finish()) drain(*decoder, heard.events);
    heard.counters = decoder->event_counters();
    heard.curves = decoder->counters();
    return heard;
}

struct Sent {
    std::vector<std::uint8_t> bytes;
    std::vector<Event> events;           // accepted ones
    std::vector<std::uint32_t> refused;  // per event: so many before it, for the queue was full
    std::vector<std::size_t> due;        // per event: the bytes by which it must have left
    std::vector<std::size_t> present;    // bytes after each record
};

void append(std::vector<std::uint8_t>& bytes, const Bytes& more) {
    bytes.insert(bytes.end(), more.data, more.data + more.size);
}

/// Records with a random number of events between them.
Sent send(std::uint64_t seed, std::int64_t records, std::uint32_t hold, std::uint16_t channels = 4,
          double per_record = 0.3) {
    std::mt19937_64 random{seed};
    std::poisson_distribution<int> count{per_record};
    Pipeline<Config>::Params params;
    params.encoder.tick_ns = 4'000'000;
    params.encoder.delay_max = 30;
    params.encoder.event_delay_max = hold;
    params.encoder.restart_interval_ns = 700'000'000;
    const auto pipeline = std::make_unique<Pipeline<Config>>(params);
    Sent sent;
    std::vector<std::int64_t> before;  // per event: the record that follows it
    std::uint32_t refused = 0;
    for (std::int64_t i = 0; i < records; ++i) {
        for (int k = std::min(count(random), static_cast<int>(queue)); k > 0; --k) {
            const Event event = any_event(random, channels);
            if (!pipeline->push_event(event)) {
                ++refused;
                continue;
            }
            sent.refused.push_back(refused);
            refused = 0;
            sent.events.push_back(event);
            before.push_back(i);
        }
        Pose pose = swing(i);
        if (random() % 40 == 0) pose.t_ns -= period_ns;  // the intake refuses it
        append(sent.bytes, pipeline->push(pose));
        sent.present.push_back(sent.bytes.size());
    }
    for (Bytes b = pipeline->flush(); !b.empty(); b = pipeline->flush()) append(sent.bytes, b);
    for (const std::int64_t i : before) {
        const auto by = static_cast<std::size_t>(i + hold);
        sent.due.push_back(by < sent.present.size() ? sent.present[by] : sent.bytes.size());
    }
    return sent;
}

struct Frame {
    std::size_t begin, size;
    bool event, restart;
};
std::vector<Frame> frames_of(const std::vector<std::uint8_t>& bytes) {
    std::vector<Frame> frames;
    for (std::size_t at = 0; at < bytes.size();) {
        const unsigned first = bytes[at];
        const bool event = first >= 0xE0, restart = first >= 0xC0 && !event;
        const std::size_t n =
            first < 0x80 ? first + 3 : (first & (event ? 0x1f : 0x3f)) * 256u + bytes[at + 1] + 4;
        frames.push_back({at, n, event, restart});
        at += n;
    }
    return frames;
}
std::vector<std::uint8_t> without(const std::vector<std::uint8_t>& bytes, const Frame& frame) {
    auto rest = bytes;
    const auto at = rest.begin() + static_cast<std::ptrdiff_t>(frame.begin);
    rest.erase(at, at + static_cast<std::ptrdiff_t>(frame.size));
    return rest;
}

/// All that was heard was sent, in this order, none twice; where something is missing the event
/// behind it says so. @return how many were heard.
void expect_part_of(const std::vector<Event>& sent, const std::vector<Event>& heard) {
    std::size_t at = 0;
    for (const Event& event : heard) {
        const std::size_t before = at;
        while (at < sent.size() && !same(sent[at], event)) ++at;
        ASSERT_LT(at, sent.size()) << "an event that was not sent, or twice: t " << event.t_ns;
        ASSERT_EQ(at != before, (event.flags & flag::gap_before) != 0) << "event " << at;
        ++at;
    }
}

}  // namespace

TEST(Events, ComeOutExactlyInOrderAndInTime) {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const auto hold = static_cast<std::uint32_t>(seed % 4 * 3);
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", hold " << hold);
        const Sent sent = send(seed, 300, hold, static_cast<std::uint16_t>(seed));
        const Heard heard = hear(sent.bytes);
        ASSERT_EQ(heard.events.size(), sent.events.size());
        std::uint32_t lost = 0;
        for (std::size_t i = 0; i < sent.events.size(); ++i) {
            ASSERT_TRUE(same(heard.events[i], sent.events[i])) << "event " << i;
            const bool gap = (heard.events[i].flags & flag::gap_before) != 0;
            ASSERT_EQ(gap, sent.refused[i] > 0) << "event " << i;
            lost += sent.refused[i];
        }
        EXPECT_EQ(heard.counters.lost, lost);
        EXPECT_EQ(heard.curves.damaged, 0u);

        const auto decoder = std::make_unique<Decoder>();
        std::vector<Event> early;
        std::size_t fed = 0;
        for (std::size_t i = 0; i < sent.events.size(); ++i) {
            for (; fed < sent.due[i]; ++fed)
                if (decoder->push(sent.bytes[fed])) drain(*decoder, early);
            ASSERT_GT(early.size(), i) << "not in the bytes in time";
        }
    }
}

TEST(Events, WaitForCompanyOnlyAsLongAsAllowed) {
    // fewer frames with a longer hold, from the same events
    std::size_t frames[2] = {};
    for (const std::uint32_t hold : {0u, 12u})
        frames[hold > 0] = hear(send(9, 400, hold).bytes).counters.frames;
    EXPECT_LT(2 * frames[1], frames[0]);
}

TEST(Events, AFullQueueWaitsForNoCompany) {
    EventSender<queue> sender;
    std::array<std::uint8_t, EventSender<queue>::frame_size_max> frame{};
    for (std::size_t i = 0; i < queue; ++i) {
        EXPECT_EQ(sender.frame(frame.data(), 100), 0u) << i;
        ASSERT_TRUE(sender.push({1, 1, 1, 0}));
    }
    EXPECT_GT(sender.frame(frame.data(), 100), 0u);
}

TEST(Events, NonsenseBehindARightChecksumIsRefused) {
    EventSender<queue> sender;
    std::vector<std::uint8_t> bytes(EventSender<queue>::frame_size_max + 1);
    ASSERT_TRUE(sender.push({1, 1, 1, 0}));
    const std::size_t size = sender.frame(bytes.data(), 0);
    const auto sealed = [&](std::size_t payload) {
        auto frame = bytes;
        frame[1] = static_cast<std::uint8_t>(payload);
        frame.resize(append_crc16(frame.data(), 2 + payload, wire::event_seed));
        return hear(frame).events.size();
    };
    EXPECT_EQ(sealed(size - 4), 1u);
    EXPECT_EQ(sealed(size - 3), 0u) << "a byte too many";
    EXPECT_EQ(sealed(size - 5), 0u) << "a byte too few";
    bytes[2] ^= 1;
    EXPECT_EQ(sealed(size - 4), 0u) << "of another version";
}

TEST(Events, AFullQueueRefusesAndTheReaderKnows) {
    EventSender<queue> sender;
    std::array<std::uint8_t, EventSender<queue>::frame_size_max> frame{};
    std::vector<std::uint8_t> bytes;
    const auto put = [&](int count, std::int64_t t) {
        int taken = 0;
        for (int i = 0; i < count; ++i) taken += sender.push({t + i, 1, 7, 0});
        const std::size_t size = sender.frame(frame.data(), 0);
        bytes.insert(bytes.end(), frame.data(), frame.data() + size);
        return taken;
    };
    EXPECT_EQ(put(3, 0), 3);
    EXPECT_EQ(put(20, 100), 8);
    EXPECT_EQ(sender.refused(), 12u);
    Heard heard = hear(bytes);
    EXPECT_EQ(heard.counters.lost, 12u) << "known at once, not only with the next event";
    EXPECT_EQ(put(2, 200), 2);
    heard = hear(bytes);
    EXPECT_EQ(heard.counters.lost, 12u);
    ASSERT_EQ(heard.events.size(), 13u);
    for (std::size_t i = 0; i < 13; ++i)
        EXPECT_EQ(heard.events[i].flags, i == 11 ? flag::gap_before : 0u) << i;
    EXPECT_EQ(heard.events[10].t_ns, 107);
    EXPECT_EQ(heard.events[11].t_ns, 200);
}

TEST(Events, ASourceThatMissedSomeSaysSo) {
    EventSender<queue> sender;
    std::vector<std::uint8_t> bytes(EventSender<queue>::frame_size_max);
    ASSERT_TRUE(sender.push({1, 0, 1, 0}));
    ASSERT_TRUE(sender.push({2, 0, 0, flag::gap_before | flag::rest}));
    bytes.resize(sender.frame(bytes.data(), 0));
    const Heard heard = hear(bytes);
    ASSERT_EQ(heard.events.size(), 2u);
    EXPECT_EQ(heard.events[0].flags, 0u);
    EXPECT_EQ(heard.events[1].flags, flag::gap_before);
    EXPECT_EQ(heard.counters.lost, 0u);
}

struct NoEvents : Config {
    static constexpr std::size_t events = 0;
};

TEST(Events, APipelineWithoutThemSendsTheSameCurves) {
    Pipeline<Config>::Params params;
    params.encoder.delay_max = 30;
    const auto with = std::make_unique<Pipeline<Config>>(params);
    const auto without = std::make_unique<Pipeline<NoEvents>>(
        Pipeline<NoEvents>::Params{params.intake, params.filter, params.encoder});
    std::vector<std::uint8_t> a, b;
    for (std::int64_t i = 0; i < 400; ++i) {
        ASSERT_FALSE(without->push_event({i, 1, 1, 0}));
        append(a, with->push(swing(i)));
        append(b, without->push(swing(i)));
    }
    EXPECT_EQ(without->encoder().refused_events(), 400u);
    EXPECT_TRUE(without->idle().empty());
    EXPECT_GT(a.size(), 100u);
    EXPECT_EQ(a, b);
    EXPECT_LT(sizeof *without + 500, sizeof *with);
}

TEST(Events, TheLargestFrameFits) {
    std::mt19937_64 random{3};
    for (int trial = 0; trial < 200; ++trial) {
        SCOPED_TRACE(testing::Message() << "trial " << trial);
        EventSender<14> sender;
        std::vector<std::uint8_t> frame(EventSender<14>::frame_size_max);
        static_assert(EventSender<14>::frame_size_max <= wire::max_frame);
        Decoder decoder;
        std::vector<Event> sent, heard;
        for (int round = 0; round < 6; ++round) {
            for (std::uint16_t i = 0; i < 14; ++i) {
                const auto far = random() % 2 ? INT64_MAX : INT64_MIN;
                sent.push_back({i % 2 ? far : any_time(random),
                                static_cast<std::uint16_t>(0xffff - random() % 20), 0xffff, 0});
                ASSERT_TRUE(sender.push(sent.back()));
            }
            for (int refused = 0; refused < 70000 * (round == 1); ++refused)
                ASSERT_FALSE(sender.push(sent.back()));  // numbers of more than 16 bits back
            const std::size_t size = sender.frame(frame.data(), 0);
            ASSERT_LE(size, frame.size());
            for (std::size_t i = 0; i < size; ++i)
                if (decoder.push(frame[i])) drain(decoder, heard);
            sender.repeat();
        }
        ASSERT_EQ(heard.size(), sent.size());
        for (std::size_t i = 0; i < sent.size(); ++i) ASSERT_TRUE(same(heard[i], sent[i]));
    }
}

TEST(Events, AFlippedBitNeverMakesAnEvent) {
    const Sent sent = send(11, 400, 0);
    std::mt19937_64 random{12};
    std::size_t damaged = 0;
    for (int trial = 0; trial < 1500; ++trial) {
        auto bytes = sent.bytes;
        const std::size_t at = random() % bytes.size();
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << random() % 8));
        const Heard heard = hear(bytes);
        SCOPED_TRACE(testing::Message() << "byte " << at << " of " << bytes.size());
        expect_part_of(sent.events, heard.events);
        if (HasFatalFailure()) return;
        const std::size_t missing = sent.events.size() - heard.events.size();
        ASSERT_LE(missing, queue) << "one frame's events at most";
        damaged += missing > 0;
        const bool ends_known = same(heard.events.front(), sent.events.front()) &&
                                same(heard.events.back(), sent.events.back());
        if (ends_known) {
            ASSERT_EQ(heard.counters.lost, missing);
        }
    }
    EXPECT_GT(damaged, 100u);
}

TEST(Events, ALostEventFrameCostsNoCurve) {
    const Sent sent = send(21, 400, 0);
    const Heard whole = hear(sent.bytes);
    for (const Frame& frame : frames_of(sent.bytes)) {
        if (!frame.event) continue;
        const Heard heard = hear(without(sent.bytes, frame));
        expect_part_of(sent.events, heard.events);
        if (HasFatalFailure()) return;
        EXPECT_EQ(heard.curves.damaged, 0u);
        EXPECT_EQ(heard.curves.frames, whole.curves.frames);
    }
}

TEST(Events, ALostCurveFrameCostsNoEvent) {
    const Sent sent = send(22, 400, 0);
    for (const Frame& frame : frames_of(sent.bytes)) {
        if (frame.event) continue;
        const Heard heard = hear(without(sent.bytes, frame));
        ASSERT_EQ(heard.events.size(), sent.events.size());
        ASSERT_EQ(heard.counters.lost, 0u);
        expect_part_of(sent.events, heard.events);
        if (HasFatalFailure()) return;
    }
}

TEST(Events, ACutFileGivesAllEventsBeforeTheCut) {
    const Sent sent = send(23, 150, 0);
    const auto frames = frames_of(sent.bytes);
    const auto decoder = std::make_unique<Decoder>();
    std::vector<Event> growing;
    for (std::size_t cut = 0; cut < sent.bytes.size(); ++cut) {
        const Heard heard =
            hear({sent.bytes.begin(), sent.bytes.begin() + static_cast<std::ptrdiff_t>(cut)});
        ASSERT_EQ(heard.events.size(), growing.size()) << "cut at " << cut;
        if (decoder->push(sent.bytes[cut])) drain(*decoder, growing);
    }
    EXPECT_EQ(growing.size(), sent.events.size());
}

TEST(Events, ALateJoinerHearsAllFromThereAndLearnsEveryChannel) {
    const Sent sent = send(24, 900, 0, 3);
    const auto frames = frames_of(sent.bytes);
    std::mt19937_64 random{25};
    for (int trial = 0; trial < 60; ++trial) {
        const std::size_t at = 1 + random() % (sent.bytes.size() / 2);
        SCOPED_TRACE(testing::Message() << "joins at byte " << at);
        const std::vector<std::uint8_t> rest(sent.bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                             sent.bytes.end());
        const Heard heard = hear(rest);
        expect_part_of(sent.events, heard.events);
        if (HasFatalFailure()) return;
        std::size_t after = 0;  // events in the frames that begin after the joining
        for (const Frame& frame : frames) {
            if (!frame.event || frame.begin < at) continue;
            const auto begin = sent.bytes.begin() + static_cast<std::ptrdiff_t>(frame.begin);
            after = std::max(after, hear({begin, sent.bytes.end()}).events.size());
            break;
        }
        ASSERT_GE(heard.events.size(), after);

        // at the second restart point from here every channel's value is known
        std::size_t restarts = 0, end = sent.bytes.size();
        for (const Frame& frame : frames)
            if (frame.restart && frame.begin >= at && ++restarts == 2) end = frame.begin;
        const Heard early = hear({sent.bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                  sent.bytes.begin() + static_cast<std::ptrdiff_t>(end)});
        const Heard full =
            hear({sent.bytes.begin(), sent.bytes.begin() + static_cast<std::ptrdiff_t>(end)});
        std::map<std::uint16_t, Event> known, truth;
        for (const Event& event : early.events) known[event.channel] = event;
        for (const Event& event : full.events) truth[event.channel] = event;
        for (const auto& [channel, event] : truth) {
            ASSERT_EQ(known.count(channel), 1u) << "channel " << channel;
            ASSERT_TRUE(same(known[channel], event)) << "channel " << channel;
        }
    }
}

TEST(Events, ALostLastEventComesAgainAtTheNextRestart) {
    Pipeline<Config>::Params params;
    params.encoder.tick_ns = 4'000'000;
    params.encoder.delay_max = 30;
    params.encoder.restart_interval_ns = 500'000'000;
    const auto pipeline = std::make_unique<Pipeline<Config>>(params);
    std::vector<std::uint8_t> bytes;
    for (std::int64_t i = 0; i < 200; ++i) {
        if (i == 10) {
            EXPECT_TRUE(pipeline->push_event({111, 2, 1, 0}));
        }
        if (i == 15) {
            EXPECT_TRUE(pipeline->push_event({222, 2, 0, 0}));
        }
        append(bytes, pipeline->push(swing(i)));
    }
    std::size_t seen = 0;
    for (const Frame& frame : frames_of(bytes)) {
        if (!frame.event || ++seen != 2) continue;
        const Heard heard = hear(without(bytes, frame));
        ASSERT_EQ(heard.events.size(), 2u);
        EXPECT_EQ(heard.events[1].t_ns, 222);
        EXPECT_EQ(heard.events[1].value, 0);
        EXPECT_EQ(heard.events[1].flags, 0u) << "nothing is missing any more";
        EXPECT_EQ(heard.counters.lost, 0u);
    }
    EXPECT_GT(seen, 2u);
}

TEST(Events, ChannelsThatHaveBeenStillForLongAreToldAgain) {
    EventSender<queue> sender;
    std::vector<std::uint8_t> frame(EventSender<queue>::frame_size_max);
    for (std::uint16_t channel = 0; channel < 3; ++channel)
        ASSERT_TRUE(sender.push({channel, channel, 1, 0}));
    ASSERT_GT(sender.frame(frame.data(), 0), 0u);
    for (int i = 0; i < 70000; ++i) {  // more than the numbers on the wire can tell
        ASSERT_TRUE(sender.push({i, 2, 0, 0}));
        ASSERT_GT(sender.frame(frame.data(), 0), 0u);
    }
    sender.repeat();
    frame.resize(sender.frame(frame.data(), 0));
    const Heard heard = hear(frame);
    ASSERT_EQ(heard.events.size(), 3u);
    EXPECT_EQ(heard.events[1].t_ns, 1);
    EXPECT_EQ(heard.events[2].t_ns, 69999);
}

TEST(Events, OfTooManyChannelsTheOldestIsNotToldAgain) {
    EventSender<queue> sender;
    std::vector<std::uint8_t> frame(EventSender<queue>::frame_size_max);
    for (std::uint16_t i = 0; i < 25; ++i) {
        const auto channel = static_cast<std::uint16_t>(i == 24 ? 17 : i);
        ASSERT_TRUE(sender.push({i, channel, 1, 0}));
        ASSERT_GT(sender.frame(frame.data(), 0), 0u);
    }
    sender.repeat();
    frame.resize(sender.frame(frame.data(), 0));
    const Heard heard = hear(frame);
    ASSERT_EQ(heard.events.size(), queue);
    const std::int64_t times[] = {16, 18, 19, 20, 21, 22, 23, 24};  // 17's first event is replaced
    for (std::size_t i = 0; i < queue; ++i) EXPECT_EQ(heard.events[i].t_ns, times[i]);
}

TEST(Events, LeaveWithoutRecords) {
    const auto pipeline = std::make_unique<Pipeline<Config>>(Pipeline<Config>::Params{});
    std::vector<std::uint8_t> bytes;
    ASSERT_TRUE(pipeline->push_event({-5, 1, 2, 0}));
    append(bytes, pipeline->idle());
    EXPECT_EQ(hear(bytes).events.size(), 1u);
    ASSERT_TRUE(pipeline->push_event({-4, 1, 2, 0}));
    Pose bad;
    bad.p_w_m.x = std::numeric_limits<float>::quiet_NaN();
    bad.flags = flag::position_valid;
    append(bytes, pipeline->push(bad));
    EXPECT_EQ(hear(bytes).events.size(), 2u);
    ASSERT_TRUE(pipeline->push_event({-3, 1, 2, 0}));
    append(bytes, pipeline->flush());
    EXPECT_TRUE(pipeline->flush().empty());
    EXPECT_EQ(hear(bytes).events.size(), 3u);
    EXPECT_EQ(hear(bytes).counters.lost, 0u);

    const auto imu = std::make_unique<ImuPipeline<Config>>(ImuPipeline<Config>::Params{});
    bytes.clear();
    ASSERT_TRUE(imu->push_event({7, 0, 1, 0}));
    append(bytes, imu->push(Sample{}));
    ASSERT_TRUE(imu->push_event({8, 0, 1, 0}));
    append(bytes, imu->idle());
    EXPECT_EQ(hear(bytes).events.size(), 2u);
}

TEST(Events, ASenderThatBeganAgainIsHeard) {
    const Sent first = send(31, 60, 0), second = send(32, 60, 0);
    std::vector<std::uint8_t> bytes = first.bytes;
    bytes.insert(bytes.end(), second.bytes.begin(), second.bytes.end());
    const Heard heard = hear(bytes);
    EXPECT_EQ(heard.events.size(), first.events.size() + second.events.size());
    EXPECT_EQ(heard.counters.lost, 0u);
    for (const Event& event : heard.events) EXPECT_EQ(event.flags, 0u);
}

/// A motion of constant velocity passes a symmetric filter unchanged, so that the decoded curve at
/// an event's time must show where the body was when the button went down.
TEST(Events, AFiltersLatencyDoesNotShiftThemAgainstTheMotion) {
    struct Filtered : Config {
        using Filter = PoseFilter<17>;  // 8 records of latency: 67 ms
    };
    constexpr double speed_m_s = 2;
    Pipeline<Filtered>::Params params{{}, Filtered::Filter{binomial_mask<17>()}, {}};
    params.encoder.tick_ns = 4'000'000;
    params.encoder.delay_max = 30;
    const auto pipeline = std::make_unique<Pipeline<Filtered>>(params);
    const auto decoder = std::make_unique<Decoder>();
    std::mt19937_64 random{41};
    struct Piece {
        Curve<VectorChannel<3>> curve;
        std::uint32_t tick_ns;
        VectorChannel<3>::Scale scale;
    };
    std::vector<Piece> pieces;
    std::vector<Event> events;
    const auto take = [&](const Bytes& bytes) {
        for (std::size_t i = 0; i < bytes.size; ++i) {
            if (!decoder->push(bytes.data[i])) continue;
            Decoder::Update update;
            while (decoder->next(update))
                if (update.piece && update.channel == Decoder::Channel::position)
                    pieces.push_back(
                        {decoder->position().curve, decoder->tick_ns(), decoder->position().scale});
            Event event;
            while (decoder->next_event(event)) events.push_back(event);
        }
    };
    for (std::int64_t i = 0; i < 240; ++i) {
        Pose pose = swing(i);
        const std::int64_t since_ns = pose.t_ns - swing(0).t_ns;
        pose.p_w_m = {static_cast<float>(speed_m_s * 1e-9 * static_cast<double>(since_ns)), 0, 0};
        if (i % 20 == 19) {  // a button between this record and the one before
            const auto ago_ns = static_cast<std::int64_t>(random() % period_ns);
            ASSERT_TRUE(pipeline->push_event({pose.t_ns - ago_ns, 0, 1, 0}));
        }
        take(pipeline->push(pose));
    }
    for (Bytes b = pipeline->flush(); !b.empty(); b = pipeline->flush()) take(b);
    ASSERT_EQ(events.size(), 12u);
    for (const Event& event : events) {
        const auto later = [&](const Piece& p) { return p.curve.span.t0_ns <= event.t_ns; };
        const auto piece = std::find_if(pieces.rbegin(), pieces.rend(), later);
        ASSERT_NE(piece, pieces.rend());
        const double x = static_cast<double>(
            value_at(piece->curve, piece->scale, piece->tick_ns, event.t_ns)[0]);
        const double truth = speed_m_s * 1e-9 * static_cast<double>(event.t_ns - swing(0).t_ns);
        // 8 records of latency would be 133 mm; half a record 8 mm
        EXPECT_NEAR(x, truth, 0.0011) << "at " << event.t_ns;
    }
}
