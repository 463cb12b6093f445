// Discrete events beside the curves: exact, in order, in time; what damage and loss cost them, what
// a late reader learns. By whole pipelines, and by sender and reader alone.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "fairlead/pipeline.hpp"
#include "fairlead/wire/decoder.hpp"

namespace {

using namespace fairlead;

constexpr std::size_t queue = 6;
constexpr std::int64_t period_ns = 8'333'333;
using Stream = std::vector<std::uint8_t>;
using Sender = wire::EventSender<queue>;
using Reader = wire::EventReader;
using Decoder = wire::Decoder<>;

bool same(const Event& a, const Event& b) {
    return a.t_ns == b.t_ns && a.channel == b.channel && a.value == b.value;
}

template <std::size_t Events, class AFilter = NoFilter>
struct BoardOf {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, Orientation>;
    using Filter = AFilter;
    static constexpr std::size_t delay_records_max = 30;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = Events;
};
using Board = BoardOf<queue>;

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
    Reader::Counters counters;
    std::uint32_t frames{0}, losses{0};  // of curves
};

void drain(Decoder& decoder, std::vector<Event>& events) {
    wire::CurvePiece piece;
    while (decoder.next(piece)) {
    }
    Event event;
    while (decoder.next_event(event)) events.push_back(event);
}

Heard hear(const Stream& bytes) {
    const auto decoder = std::make_unique<Decoder>();
    Heard heard;
    for (const std::uint8_t byte : bytes)
        if (decoder->push(byte)) drain(*decoder, heard.events);
    while (decoder->finish()) drain(*decoder, heard.events);
    heard.counters = decoder->event_counters();
    heard.frames = decoder->frame_counters().frames;
    heard.losses = decoder->frame_counters().losses;
    return heard;
}

void append(Stream& bytes, const Bytes& more) {
    for (const std::uint8_t byte : more) bytes.push_back(byte);
}
template <class Pipeline>
void flush(Pipeline& pipeline, Stream& bytes) {
    for (bool more = true; more;) {
        const Bytes out = pipeline.flush();
        append(bytes, out);
        more = out.status != Status::end;
    }
}

template <class ABoard>
typename Pipeline<ABoard>::Params params(std::int64_t header_ns = 1'000'000'000) {
    typename Pipeline<ABoard>::Params params;
    params.sample_period_ns = period_ns;
    params.restart_interval_ns = 700'000'000;
    params.header_interval_ns = header_ns;
    return params;
}

struct Sent {
    Stream bytes;
    std::vector<Event> events;           // accepted ones
    std::vector<std::uint32_t> refused;  // per event: so many before it, for the queue was full
    std::vector<std::size_t> due;        // per event: the bytes by which it must have left
};

/// Records with a random number of events between them.
Sent send(std::uint64_t seed, std::int64_t records, std::uint32_t hold, std::uint16_t channels = 4,
          double per_record = 0.3) {
    std::mt19937_64 random{seed};
    std::poisson_distribution<int> count{per_record};
    auto settings = params<Board>();
    settings.event_delay_records = hold;
    const auto pipeline = std::make_unique<Pipeline<Board>>(settings);
    Sent sent;
    std::vector<std::int64_t> before;  // per event: the record that follows it
    std::vector<std::size_t> present;  // bytes after each record
    std::uint32_t refused = 0;
    for (std::int64_t i = 0; i < records; ++i) {
        for (int k = i == 0 ? 0 : count(random); k > 0; --k) {
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
        present.push_back(sent.bytes.size());
    }
    flush(*pipeline, sent.bytes);
    for (const std::int64_t i : before) {
        const auto by = static_cast<std::size_t>(i + hold);
        sent.due.push_back(by < present.size() ? present[by] : sent.bytes.size());
    }
    return sent;
}

struct Frame {
    std::size_t begin, size;
    bool event, header;
};
std::vector<Frame> frames_of(const Stream& bytes) {
    std::vector<Frame> frames;
    for (std::size_t at = 0; at < bytes.size();) {
        const bool event = bytes[at] == 0xF9, header = bytes[at] == 0xF8;
        const std::size_t n = event || header ? bytes[at + 1] + 6u : bytes[at] + 3u;
        frames.push_back({at, n, event, header});
        at += n;
    }
    return frames;
}
Stream without(const Stream& bytes, const Frame& frame) {
    Stream rest = bytes;
    const auto at = rest.begin() + static_cast<std::ptrdiff_t>(frame.begin);
    rest.erase(at, at + static_cast<std::ptrdiff_t>(frame.size));
    return rest;
}
Stream from(const Stream& bytes, std::size_t begin, std::size_t end) {
    return {bytes.begin() + static_cast<std::ptrdiff_t>(begin),
            bytes.begin() + static_cast<std::ptrdiff_t>(end)};
}

/// All that was heard was sent, in this order, none twice; where something is missing the event
/// behind it says so.
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

/// A sender whose frames go to a reader at once.
struct Line {
    Sender sender{};
    Reader reader{};
    std::vector<Event> heard{};
    std::array<std::uint8_t, Sender::frame_max> bytes{};

    std::size_t frame(std::uint32_t hold = 0) { return sender.frame(bytes.data(), hold, 7, 0); }
    bool parse(std::size_t payload) {
        if (!reader.parse(bytes.data() + 2, payload, 0)) return false;
        Event event;
        while (reader.next(event)) heard.push_back(event);
        return true;
    }
    bool pass() {
        const std::size_t size = frame();
        return size > 6 && parse(size - 6);
    }
};

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
        EXPECT_EQ(heard.losses, 0u);

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
    std::uint32_t frames[2] = {};  // fewer with a longer hold, of the same events
    for (const std::uint32_t hold : {0u, 12u})
        frames[hold > 0] = hear(send(9, 400, hold).bytes).counters.frames;
    EXPECT_LT(2 * frames[1], frames[0]);
}

TEST(Events, AFullQueueWaitsForNoCompany) {
    Line line;
    for (std::size_t i = 0; i < queue; ++i) {
        EXPECT_EQ(line.frame(100), 0u) << i;
        ASSERT_TRUE(line.sender.push({1, 1, 1, 0}));
    }
    EXPECT_GT(line.frame(100), 0u);
}

TEST(Events, NonsenseBehindARightChecksumIsRefused) {
    Line line;
    ASSERT_TRUE(line.sender.push({1, 1, 1, 0}));
    const std::size_t payload = line.frame() - 6;
    EXPECT_FALSE(line.parse(payload + 1)) << "a byte too many";
    EXPECT_FALSE(line.parse(payload - 1)) << "a byte too few";
    EXPECT_FALSE(line.parse(0));
    EXPECT_TRUE(line.heard.empty());
    EXPECT_TRUE(line.parse(payload));
    EXPECT_EQ(line.heard.size(), 1u);
}

TEST(Events, AFullQueueRefusesAndTheReaderKnows) {
    Line line;
    const auto put = [&](int count, std::int64_t t) {
        int taken = 0;
        for (int i = 0; i < count; ++i) taken += line.sender.push({t + i, 1, 7, 0});
        EXPECT_TRUE(line.pass());
        return taken;
    };
    EXPECT_EQ(put(3, 0), 3);
    EXPECT_EQ(put(20, 100), 6);
    EXPECT_EQ(line.sender.refused(), 14u);
    EXPECT_EQ(line.reader.counters().lost, 14u) << "known at once, not with the next event";
    EXPECT_EQ(put(2, 200), 2);
    EXPECT_EQ(line.reader.counters().lost, 14u);
    ASSERT_EQ(line.heard.size(), 11u);
    for (std::size_t i = 0; i < 11; ++i)
        EXPECT_EQ(line.heard[i].flags, i == 9 ? flag::gap_before : 0u) << i;
    EXPECT_EQ(line.heard[8].t_ns, 105);
    EXPECT_EQ(line.heard[9].t_ns, 200);
}

TEST(Events, ASourceThatMissedSomeSaysSo) {
    Line line;
    ASSERT_TRUE(line.sender.push({1, 0, 1, 0}));
    ASSERT_TRUE(line.sender.push({2, 0, 0, flag::gap_before | flag::rest}));
    ASSERT_TRUE(line.pass());
    ASSERT_EQ(line.heard.size(), 2u);
    EXPECT_EQ(line.heard[0].flags, 0u);
    EXPECT_EQ(line.heard[1].flags, flag::gap_before);
    EXPECT_EQ(line.reader.counters().lost, 0u);
}

TEST(Events, APipelineWithoutThemSendsTheSameCurves) {
    const auto with = std::make_unique<Pipeline<Board>>(params<Board>());
    const auto none = std::make_unique<Pipeline<BoardOf<0>>>(params<BoardOf<0>>());
    Stream a, b;
    for (std::int64_t i = 0; i < 400; ++i) {
        ASSERT_FALSE(none->push_event({i, 1, 1, 0}));
        append(a, with->push(swing(i)));
        append(b, none->push(swing(i)));
    }
    EXPECT_EQ(none->encoder().inner().refused_events(), 400u);
    EXPECT_TRUE(none->idle().empty());
    EXPECT_GT(a.size(), 100u);
    EXPECT_EQ(a, b);
    EXPECT_LT(sizeof *none + 200, sizeof *with);
}

TEST(Events, TheLargestFrameFits) {
    std::mt19937_64 random{3};
    for (int trial = 0; trial < 200; ++trial) {
        SCOPED_TRACE(testing::Message() << "trial " << trial);
        Line line;
        std::vector<Event> sent;
        for (int round = 0; round < 6; ++round) {
            for (std::size_t i = 0; i < queue; ++i) {
                const auto edge = random() % 2 ? INT64_MAX : INT64_MIN;
                sent.push_back({i % 2 ? edge : any_time(random),
                                static_cast<std::uint16_t>(0xffff - random() % 20), 0xffff, 0});
                ASSERT_TRUE(line.sender.push(sent.back()));
            }
            for (int refused = 0; refused < 70000 * (round == 1); ++refused)
                ASSERT_FALSE(line.sender.push(sent.back()));  // numbers of more than 16 bits back
            const std::size_t size = line.frame();
            ASSERT_LE(size, Sender::frame_max);
            ASSERT_TRUE(line.parse(size - 6));
            line.sender.repeat();
        }
        ASSERT_EQ(line.heard.size(), sent.size());
        for (std::size_t i = 0; i < sent.size(); ++i) ASSERT_TRUE(same(line.heard[i], sent[i]));
    }
}

TEST(Events, AFlippedBitNeverMakesAnEvent) {
    const Sent sent = send(11, 300, 0);
    std::mt19937_64 random{12};
    std::size_t damaged = 0;
    for (int trial = 0; trial < 500; ++trial) {
        Stream bytes = sent.bytes;
        const std::size_t at = random() % bytes.size();
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << random() % 8));
        const Heard heard = hear(bytes);
        SCOPED_TRACE(testing::Message() << "byte " << at << " of " << bytes.size());
        expect_part_of(sent.events, heard.events);
        if (HasFatalFailure()) return;
        damaged += sent.events.size() > heard.events.size();
    }
    EXPECT_GT(damaged, 30u);
}

TEST(Events, ALostEventFrameCostsNoCurve) {
    const Sent sent = send(21, 400, 0);
    const Heard whole = hear(sent.bytes);
    for (const Frame& frame : frames_of(sent.bytes)) {
        if (!frame.event) continue;
        const Heard heard = hear(without(sent.bytes, frame));
        expect_part_of(sent.events, heard.events);
        if (HasFatalFailure()) return;
        EXPECT_EQ(heard.losses, 0u);
        EXPECT_EQ(heard.frames, whole.frames);
    }
}

TEST(Events, ALostCurveFrameCostsNoEvent) {
    const Sent sent = send(22, 400, 0);
    for (const Frame& frame : frames_of(sent.bytes)) {
        if (frame.event || frame.header) continue;
        const Heard heard = hear(without(sent.bytes, frame));
        ASSERT_EQ(heard.events.size(), sent.events.size());
        ASSERT_EQ(heard.counters.lost, 0u);
        expect_part_of(sent.events, heard.events);
        if (HasFatalFailure()) return;
    }
}

TEST(Events, ACutFileGivesAllEventsBeforeTheCut) {
    const Sent sent = send(23, 150, 0);
    const auto decoder = std::make_unique<Decoder>();
    std::vector<Event> growing;
    for (std::size_t cut = 0; cut < sent.bytes.size(); ++cut) {
        const Heard heard = hear(from(sent.bytes, 0, cut));
        ASSERT_EQ(heard.events.size(), growing.size()) << "cut at " << cut;
        if (decoder->push(sent.bytes[cut])) drain(*decoder, growing);
    }
    EXPECT_EQ(growing.size(), sent.events.size());
}

TEST(Events, ALateReaderHearsAllBehindAHeaderAndLearnsEveryChannel) {
    const Sent sent = send(24, 900, 0, 3);
    const std::vector<Frame> frames = frames_of(sent.bytes);
    std::size_t headers = 0;
    for (const Frame& frame : frames) {
        if (!frame.header) continue;
        ++headers;
        SCOPED_TRACE(testing::Message() << "reads from byte " << frame.begin);
        const Heard heard = hear(from(sent.bytes, frame.begin, sent.bytes.size()));
        const Heard missed = hear(from(sent.bytes, 0, frame.begin));
        std::vector<Event> later(
            sent.events.begin() + static_cast<std::ptrdiff_t>(missed.events.size()),
            sent.events.end());
        ASSERT_GE(heard.events.size(), later.size());
        for (std::size_t i = 1; i <= later.size(); ++i)
            ASSERT_TRUE(same(later[later.size() - i], heard.events[heard.events.size() - i]));
        std::map<std::uint16_t, Event> known, truth;
        for (const Event& event : heard.events) known[event.channel] = event;
        for (const Event& event : sent.events) truth[event.channel] = event;
        for (const auto& [channel, event] : truth) {
            ASSERT_EQ(known.count(channel), 1u) << "channel " << channel;
            ASSERT_TRUE(same(known[channel], event)) << "channel " << channel;
        }
    }
    EXPECT_GE(headers, 6u);
}

TEST(Events, ALostLastEventComesAgain) {
    const auto pipeline = std::make_unique<Pipeline<Board>>(params<Board>());
    Stream bytes;
    for (std::int64_t i = 0; i < 400; ++i) {
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
        EXPECT_EQ(heard.events[1].flags, 0u) << "nothing is missing any more";
        EXPECT_EQ(heard.counters.lost, 0u);
    }
    EXPECT_GT(seen, 2u);
}

TEST(Events, AFrameIsWrittenIntoItsOwnBytes) {
    for (std::uint16_t events = 1; events <= queue; ++events) {
        Line line;
        for (std::uint16_t i = 0; i < events; ++i) ASSERT_TRUE(line.sender.push({i, i, 1, 0}));
        line.bytes.fill(0x5a);
        const std::size_t size = line.frame();
        ASSERT_LT(size, line.bytes.size());
        for (std::size_t i = size; i < line.bytes.size(); ++i) ASSERT_EQ(line.bytes[i], 0x5a);
    }
}

TEST(Events, ALostFrameOfSeveralComesAgainAsOften) {
    Line line;
    ASSERT_TRUE(line.sender.push({1, 0, 1, 0}));
    ASSERT_TRUE(line.pass());
    for (std::uint16_t channel = 1; channel < 5; ++channel)
        ASSERT_TRUE(line.sender.push({10 + channel, channel, 1, 0}));
    ASSERT_GT(line.frame(), 0u);  // lost
    for (int times = 0; times < 2; ++times) {
        line.sender.repeat();
        ASSERT_TRUE(line.pass());
        ASSERT_EQ(line.heard.size(), 5u) << "each is new once, and what came before is not";
    }
    for (std::size_t i = 1; i < 5; ++i) {
        EXPECT_EQ(line.heard[i].t_ns, 10 + static_cast<std::int64_t>(i));
        EXPECT_EQ(line.heard[i].channel, i);
        EXPECT_EQ(line.heard[i].flags, 0u);
    }
    EXPECT_EQ(line.reader.counters().events, 5u);
    EXPECT_EQ(line.reader.counters().lost, 0u);
}

TEST(Events, ChannelsThatHaveBeenStillForLongAreToldAgain) {
    Line line;
    for (std::uint16_t channel = 0; channel < 3; ++channel)
        ASSERT_TRUE(line.sender.push({channel, channel, 1, 0}));
    ASSERT_GT(line.frame(), 0u);
    for (int i = 0; i < 70000; ++i) {  // more than the numbers on the wire can tell
        ASSERT_TRUE(line.sender.push({i, 2, 0, 0}));
        ASSERT_GT(line.frame(), 0u);
    }
    line.sender.repeat();
    ASSERT_TRUE(line.pass());
    ASSERT_EQ(line.heard.size(), 3u);
    EXPECT_EQ(line.heard[1].t_ns, 1);
    EXPECT_EQ(line.heard[2].t_ns, 69999);
}

TEST(Events, OfTooManyChannelsTheOldestIsNotToldAgain) {
    Line line;
    for (std::uint16_t i = 0; i < 25; ++i) {
        const auto channel = static_cast<std::uint16_t>(i == 24 ? 21 : i);
        ASSERT_TRUE(line.sender.push({i, channel, 1, 0}));
        ASSERT_GT(line.frame(), 0u);
    }
    line.sender.repeat();
    ASSERT_TRUE(line.pass());
    ASSERT_EQ(line.heard.size(), queue);
    const std::int64_t times[] = {18, 19, 20, 22, 23, 24};  // 21's first event is replaced
    for (std::size_t i = 0; i < queue; ++i) EXPECT_EQ(line.heard[i].t_ns, times[i]);
}

TEST(Events, LeaveWithoutRecordsOnceTheStreamHasBegun) {
    const auto pipeline = std::make_unique<Pipeline<Board>>(params<Board>());
    Stream bytes;
    ASSERT_TRUE(pipeline->push_event({-6, 1, 2, 0}));
    append(bytes, pipeline->idle());
    EXPECT_TRUE(bytes.empty()) << "no header yet: a reader could not tell whose it is";
    append(bytes, pipeline->push(swing(0)));
    append(bytes, pipeline->push(swing(1)));
    EXPECT_EQ(hear(bytes).events.size(), 1u);
    ASSERT_TRUE(pipeline->push_event({-5, 1, 2, 0}));
    append(bytes, pipeline->idle());
    EXPECT_EQ(hear(bytes).events.size(), 2u);
    ASSERT_TRUE(pipeline->push_event({-4, 1, 2, 0}));
    Pose bad = swing(2);
    bad.p_w_m.x = std::numeric_limits<float>::quiet_NaN();
    bad.flags = flag::position_valid;
    append(bytes, pipeline->push(bad));
    EXPECT_EQ(hear(bytes).events.size(), 3u);
    ASSERT_TRUE(pipeline->push_event({-3, 1, 2, 0}));
    flush(*pipeline, bytes);
    EXPECT_EQ(hear(bytes).events.size(), 4u);
    EXPECT_EQ(hear(bytes).counters.lost, 0u);
}

TEST(Events, ASenderThatBeganAgainIsHeard) {
    const Sent first = send(31, 60, 0), second = send(32, 60, 0);
    Stream bytes = first.bytes;
    bytes.insert(bytes.end(), second.bytes.begin(), second.bytes.end());
    const Heard heard = hear(bytes);
    EXPECT_EQ(heard.events.size(), first.events.size() + second.events.size());
    EXPECT_EQ(heard.counters.lost, 0u);
    for (const Event& event : heard.events) EXPECT_EQ(event.flags, 0u);
}

/// A motion of constant velocity passes a symmetric filter unchanged, so that the decoded curve at
/// an event's time must show where the body was when the button went down.
TEST(Events, AFiltersLatencyDoesNotShiftThemAgainstTheMotion) {
    using Filtered = BoardOf<queue, PoseFilter<17>>;  // 8 records of latency: 67 ms
    constexpr double speed_m_s = 2;
    auto settings = params<Filtered>();
    settings.filter = PoseFilter<17>{binomial_mask<17>()};
    const auto pipeline = std::make_unique<Pipeline<Filtered>>(settings);
    const auto decoder = std::make_unique<Decoder>();
    std::mt19937_64 random{41};
    std::vector<std::pair<wire::CurvePiece, curve::Grid>> pieces;  // of the first axis
    std::vector<Event> events;
    Stream bytes;
    for (std::int64_t i = 0; i < 600; ++i) {
        Pose pose = swing(i);
        pose.p_w_m = {static_cast<float>(speed_m_s * 1e-9 * static_cast<double>(i * period_ns)), 0,
                      0};
        if (i > 60 && i < 500 && i % 20 == 0) {
            const auto late = static_cast<std::int64_t>(random() % period_ns);
            ASSERT_TRUE(pipeline->push_event({pose.t_ns - late, 0, 1, 0}));
        }
        append(bytes, pipeline->push(pose));
    }
    flush(*pipeline, bytes);
    for (const std::uint8_t byte : bytes) {
        if (!decoder->push(byte)) continue;
        wire::CurvePiece piece;
        while (decoder->next(piece))
            if (!piece.rotates && piece.axis == 0) pieces.emplace_back(piece, decoder->grid());
        Event event;
        while (decoder->next_event(event)) events.push_back(event);
    }
    ASSERT_GT(events.size(), 20u);
    for (const Event& event : events) {
        const double truth = speed_m_s * 1e-9 * static_cast<double>(event.t_ns - 5'000'000'000);
        bool found = false;
        for (const auto& [piece, grid] : pieces) {
            if (event.t_ns <= grid.time_ns(piece.start) || event.t_ns > grid.time_ns(piece.end))
                continue;
            const double ticks = static_cast<double>(event.t_ns - grid.time_ns(piece.start)) /
                                 static_cast<double>(grid.tick_ns());
            EXPECT_NEAR(piece.steps_at(ticks) * piece.scale.step(), truth, 0.0011);
            found = true;
        }
        EXPECT_TRUE(found) << event.t_ns;
    }
}
