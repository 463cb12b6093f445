// Damaged bytes, noise, cut streams: nothing wrong is believed, and what is left comes back. The
// odds of docs/stream.md are counted here at checks of a few bits, where wrong frames are many.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>

#include "tests/unit/random_stream.hpp"

namespace fairlead::test {
namespace {

struct Outcome {
    std::size_t sent{0}, told{0}, wrong_frames{0}, wrong_events{0}, losses{0}, bytes{0};
};

template <unsigned Bits>
struct Checks : wire::Everything {
    static constexpr unsigned check_bits = Bits;
};

/// A line with so many damaged bytes, or with noise between some frames, and a reader whose checks
/// count CheckBits bits.
template <unsigned CheckBits>
Outcome run_line(double damage, std::size_t noise, int frames, std::uint64_t seed) {
    Options options;
    options.usual_ticks = 40;
    options.ends = options.jumps = 0;
    options.size = 1;
    RandomStream source{options, seed}, dice{options, seed + 1};
    wire::Decoder<3, 1, Kinds, Checks<CheckBits>> reader;
    std::map<std::int64_t, Writer::States> sent;
    Outcome out;
    bool wrong_before = false;
    const auto take = [&] {
        ++out.told;
        const auto it = sent.find(reader.frame_end());
        bool good = it != sent.end();
        if (good && reader.states().hidden == 0) {
            const Writer::States& a = it->second;
            const auto& b = reader.states();
            good = a.live == b.live;
            for (std::size_t i = 0; i < 3 && (a.live & 1u) != 0; ++i)
                good = good && a.axis[i].v == b.axis[i].v && a.axis[i].s == b.axis[i].s;
            if ((a.live & 2u) != 0)
                good = good && a.rotation[0].anchor.w == b.rotation[0].anchor.w &&
                       a.rotation[0].chart.s == b.rotation[0].chart.s;
        }
        out.wrong_frames += !good;
        out.wrong_events += !good && !wrong_before;
        wrong_before = !good;
    };
    const auto push = [&](const ByteVector& bytes, bool clean) {
        for (std::uint8_t byte : bytes) {
            if (!clean && dice.chance(damage)) byte = dice.below(std::uint8_t{255});
            ++out.bytes;
            if (reader.push(byte)) take();
        }
    };
    push(source.header(true), true);
    for (int i = 0; i < frames; ++i) {
        const ByteVector bytes = source.frame(20 + dice.below(40u));
        if (bytes.empty()) continue;
        ++out.sent;
        sent[source.writer().link().end] = source.writer().states;
        if (sent.size() > 200) sent.erase(sent.begin());
        push(bytes, false);
        if (i % 50 == 49) push(source.header(false), true);
        if (noise == 0 || i % 5 != 4) continue;
        ByteVector some(noise);
        for (auto& byte : some) byte = static_cast<std::uint8_t>(dice.below(256u));
        push(some, true);
    }
    out.losses = reader.frame_counters().losses;
    return out;
}

TEST(StreamDamage, AHeaderWhoseBytesLookLikeHeadsIsFound) {
    wire::Header header;
    wire::StreamShape& s = header.shape;
    s.stream_id = s.run = 0xf0f9;  // heads of event frames of 240 bytes
    s.base_ns = static_cast<std::int64_t>(0xf0f9f0f9f0f9f0f9u);
    s.timing = {130'208, 12, false, 56, 2};
    s.channels = 1;
    s.channel[0].type = wire::ChannelType::vector;
    s.channel[0].kind = 1;
    s.channel[0].axes = wire::axes_max;
    s.channel[0].tolerance = 27'307;
    for (std::size_t i = 0; i < wire::axes_max; ++i)  // exponent and next mantissa: heads as well
        s.channel[0].step[i] = curve::Scale::of_step(1.9f + 0.01f * static_cast<float>(i));
    std::array<std::uint8_t, wire::header_frame_max> bytes{};
    for (const bool starts : {true, false}) {
        header.starts = starts;
        const std::size_t size = wire::write_header(header, bytes.data());
        ASSERT_GT(size, 0u);
        for (std::size_t noise = 0; noise < 40; ++noise) {
            wire::Decoder<wire::axes_max, 0> reader;
            for (std::size_t i = 0; i < noise; ++i) reader.push(static_cast<std::uint8_t>(i));
            for (std::size_t i = 0; i < size; ++i) reader.push(bytes[i]);
            EXPECT_EQ(reader.grid().base_ns, s.base_ns) << noise << " bytes before";
            EXPECT_EQ(reader.counters().refused, 0u);
        }
    }
}

TEST(StreamDamage, NothingWrongIsBelieved) {
    for (const double damage : {0.001, 0.01, 0.03}) {
        const Outcome o = run_line<16>(damage, 0, 4000, 3);
        EXPECT_EQ(o.wrong_frames, 0u) << damage;
        EXPECT_GT(o.losses, damage < 0.02 ? 50u : 10u);
        EXPECT_GT(o.told, damage < 0.005 ? 3200u : damage < 0.02 ? 1000u : 50u) << damage;
    }
    const Outcome o = run_line<16>(0, 1500, 800, 4);
    EXPECT_EQ(o.wrong_frames, 0u);
    EXPECT_GT(o.told, 250u) << "noise between frames must not hide them for long";
}

/// Wrong events on several lines: one that believed a wrong time is out of step until the next
/// header, so a line has few.
template <unsigned CheckBits>
std::size_t wrong_events(std::uint64_t seed) {
    std::size_t sum = 0;
    for (std::uint64_t line = 0; line < 4; ++line)
        sum += run_line<CheckBits>(0.01, 0, 12000, seed + 2 * line).wrong_events;
    return sum;
}

TEST(StreamDamage, WrongFramesFallWithTheSquareOfTheCheck) {
    // two checks vouch for a frame: each bit of the check makes a wrong one four times rarer
    // (docs/stream.md, Odds, has the counts of longer runs)
    const std::size_t four = wrong_events<4>(5), six = wrong_events<6>(25);
    std::printf("%zu wrong events at 4 bits, %zu at 6\n", four, six);
    EXPECT_GE(four, 16u);
    // at 6 bits 1 / 16 of them, and the four trusted frames of each start at 2^-6 each
    EXPECT_LE(six, four / 4 + 4);
    EXPECT_LE(six, 12u);
}

/// The table of docs/stream.md: minutes.
TEST(StreamDamage, DISABLED_Odds) {
    const auto print = [](unsigned bits, double damage, const Outcome& o) {
        std::printf("%u bits, %g damaged: %zu frames, %zu losses, %zu wrong events, %zu bytes\n",
                    bits, damage, o.sent, o.losses, o.wrong_events, o.bytes);
    };
    print(6, 0.01, run_line<6>(0.01, 0, 600000, 6));
    print(7, 0.01, run_line<7>(0.01, 0, 600000, 7));
    print(8, 0.01, run_line<8>(0.01, 0, 1200000, 8));
    print(6, 0.004, run_line<6>(0.004, 0, 600000, 9));
    print(6, 0.03, run_line<6>(0.03, 0, 600000, 9));
    print(4, 0, run_line<4>(0, 2000, 40000, 5));
}

TEST(StreamDamage, NoiseAlone) {
    // a floating line: what looks like frames must also make sense
    const Outcome one = run_line<1>(0, 2000, 500, 7), four = run_line<4>(0, 2000, 500, 8);
    EXPECT_LE(four.wrong_events, 2u);
    EXPECT_LE(one.wrong_events, 20u);
}

TEST(StreamDamage, HeadsThatEndTogetherHideNothingForLong) {
    // each byte of 247 begins a frame, and all of them are complete at the same byte: more than the
    // search of one byte may try (wire/receiver.hpp)
    RandomStream source{{}, 12};
    Reader reader;
    std::size_t sent = 0, told = 0;
    for (const auto b : source.header(true)) reader.push(b);
    for (int i = 0; i < 80; ++i) {  // three times: a reader has four credits
        const ByteVector frame = source.frame();
        sent += !frame.empty();
        for (const auto b : frame) told += reader.push(b);
        for (std::size_t left = i % 25 == 24 ? wire::data_frame_max : 0; left >= 4; --left)
            told += reader.push(static_cast<std::uint8_t>(left - 3));
    }
    while (reader.finish()) ++told;
    EXPECT_EQ(reader.frame_counters().losses, 3u);
    EXPECT_EQ(told, sent);
    EXPECT_EQ(reader.frame_end(), source.writer().link().end);
}

TEST(StreamDamage, TheChecksumGoesBothWays) {
    // docs/stream.md; and bit by bit
    const std::uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
    EXPECT_EQ(crc16(digits, sizeof digits, 0xffff), 0x29b1);
    for (unsigned crc = 0; crc < 0x10000u; crc += 7)
        for (unsigned byte = 0; byte < 256; byte += 3) {
            unsigned slow = crc ^ byte << 8;
            for (int bit = 0; bit < 8; ++bit) slow = slow << 1 ^ ((slow & 0x8000u) ? 0x1021u : 0u);
            slow &= 0xffffu;
            const auto b = static_cast<std::uint8_t>(byte);
            ASSERT_EQ(crc16(b, static_cast<std::uint16_t>(crc)), slow);
            ASSERT_EQ(crc16_before(b, static_cast<std::uint16_t>(slow)), crc);
        }
}

TEST(StreamDamage, CutAtEveryByte) {
    RandomStream source{{}, 9};
    ByteVector bytes = source.header(true);
    std::vector<std::pair<std::size_t, std::int64_t>> ends;
    while (ends.size() < 12) {
        const ByteVector frame = source.frame();
        bytes.insert(bytes.end(), frame.begin(), frame.end());
        if (!frame.empty()) ends.emplace_back(bytes.size(), source.writer().link().end);
    }
    for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
        Reader reader;
        std::size_t told = 0;
        for (std::size_t i = 0; i < cut; ++i) told += reader.push(bytes[i]);
        while (reader.finish()) ++told;
        std::size_t whole = 0;
        while (whole < ends.size() && ends[whole].first <= cut) ++whole;
        ASSERT_EQ(told, whole) << cut;
        ASSERT_TRUE(whole == 0 || reader.frame_end() == ends[whole - 1].second);
    }
}

TEST(StreamDamage, EachBitCounts) {
    // one flipped bit anywhere in a frame: the frame is refused, and the reader comes back
    RandomStream source{{}, 10};
    ByteVector head = source.header(true), tail;
    const ByteVector first = source.frame();
    for (int i = 0; i < 12; ++i) {
        const ByteVector frame = source.frame();
        tail.insert(tail.end(), frame.begin(), frame.end());
    }
    for (std::size_t bit = 0; bit < 8 * first.size(); ++bit) {
        Reader reader;
        std::size_t told = 0;
        for (const auto b : head) told += reader.push(b);
        for (std::size_t i = 0; i < first.size(); ++i) {
            const auto flip = static_cast<std::uint8_t>(i == bit / 8 ? 1u << bit % 8 : 0u);
            told += reader.push(first[i] ^ flip);
        }
        ASSERT_EQ(told, 0u) << bit;
        for (const auto b : tail) told += reader.push(b);
        while (reader.finish()) ++told;
        ASSERT_EQ(reader.frame_counters().losses, 1u);
        ASSERT_GE(told, 5u) << bit;
        ASSERT_EQ(reader.frame_end(), source.writer().link().end);
    }
}

TEST(StreamDamage, AnyBytesAreHarmless) {
    // nonsense with right checks too: a frame writer's chain over random payloads
    std::mt19937_64 random{11};
    for (int run = 0; run < 100; ++run) {
        RandomStream source{{}, random()};
        Reader reader;
        for (const auto b : source.header(true)) reader.push(b);
        wire::Link link = source.writer().link();
        const std::uint32_t digest = source.digest();
        for (int i = 0; i < 20; ++i) {
            ByteVector frame(4 + random() % 60);
            for (auto& b : frame) b = static_cast<std::uint8_t>(random() % 3 == 0 ? 0 : random());
            frame[0] = static_cast<std::uint8_t>(frame.size() - 3);
            append_crc16(frame.data(), frame.size() - 2, wire::seed(digest, link));
            std::size_t told = 0;
            for (const auto b : frame) told += reader.push(b);
            wire::CurvePiece piece;
            while (reader.next(piece)) ++told;
            if (!reader.in_step()) break;
            link.end = reader.frame_end();
            link.previous = crc32(frame.data(), frame.size());
        }
        for (int i = 0; i < 2000; ++i)
            if (reader.push(static_cast<std::uint8_t>(random()))) {
                wire::CurvePiece piece;
                while (reader.next(piece)) {
                }
            }
    }
}

}  // namespace
}  // namespace fairlead::test
