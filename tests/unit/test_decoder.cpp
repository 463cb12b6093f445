// How the decoder finds frames: the same ones as a plain search of all bytes, in bounded steps, and
// late by no more than it says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "host_sim/study/baselines/earlier/wire/decoder.hpp"
#include "host_sim/study/baselines/earlier/wire/encoder.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::earlier;
using Bytes8 = std::vector<std::uint8_t>;

/// A stream of curves, restarts and events of every second or so.
Bytes8 stream(unsigned seed) {
    std::mt19937 random{seed};
    EncoderParams params;
    params.delay_max = 30;
    params.restart_interval_ns = 400'000'000;
    const auto encoder = std::make_unique<Encoder<32, slice_medium, 4>>(params);
    Bytes8 out;
    const auto append = [&out](const Bytes& b) { out.insert(out.end(), b.data, b.data + b.size); };
    for (std::int64_t i = 0; i < 700; ++i) {
        Pose pose;
        pose.t_ns = i * 8'333'333;
        const double x = 0.05 * static_cast<double>(i);
        pose.p_w_m = {static_cast<float>(std::sin(x)), static_cast<float>(std::cos(2 * x)), 1};
        pose.q_wb = from_rotation_vector(Vec3{0, static_cast<float>(std::sin(3 * x)), 0});
        pose.flags = flag::position_valid | flag::orientation_valid;
        if (random() % 20 == 0)
            encoder->push_event({pose.t_ns, static_cast<std::uint16_t>(random() % 3), 1, 0});
        append(encoder->push(pose));
    }
    for (Bytes b = encoder->flush(); !b.empty(); b = encoder->flush()) append(b);
    return out;
}

struct Found {
    std::vector<std::size_t> curves, events;  // where frames begin
    std::uint32_t skipped{0}, damaged{0};
};

/// What wire/layout.hpp says, tried at every byte, each checksum computed anew.
Found plain_search(const Bytes8& bytes) {
    Found found;
    bool in_step = false;
    std::uint32_t sequence = 0;
    for (std::size_t at = 0; at < bytes.size();) {
        const unsigned first = bytes[at], second = at + 1 < bytes.size() ? bytes[at + 1] : 0u;
        const std::size_t head = first < 0x80 ? 1 : 2;
        const bool event = first >= 0xE0, restart = first >= 0xC0 && !event;
        const std::size_t n = head == 1 ? first : (first & (event ? 31u : 63u)) * 256 + second;
        const std::size_t size = head + n + 2;
        const auto seed = event ? wire::event_seed : restart ? wire::restart_seed : sequence;
        const bool fits = n > 0 && n <= wire::max_payload && at + size <= bytes.size();
        const bool version = fits && bytes[at + 2] == (event ? 0xE1 : 0xF2);
        if (fits && (event || restart ? version : in_step) &&
            crc16(&bytes[at], size, static_cast<std::uint16_t>(seed)) == 0) {
            (event ? found.events : found.curves).push_back(at);
            if (restart) sequence = bytes[at + 3];
            if (!event) in_step = true;
            if (!event) sequence = (sequence + 1) & 0xffu;
            at += size;
            continue;
        }
        found.damaged += in_step;
        in_step = false;
        ++found.skipped;
        ++at;
    }
    return found;
}

/// A whole frame's length of heads of restart frames, whose frames all end with the last byte.
Bytes8 false_heads() {
    Bytes8 out;
    for (std::size_t payload = wire::max_payload; payload >= 3; payload -= 3) {
        out.push_back(static_cast<std::uint8_t>(0xC0 | payload >> 8));
        out.push_back(static_cast<std::uint8_t>(payload & 255));
        out.push_back(wire::version);
    }
    out.resize(wire::max_frame, 0);
    return out;
}

Bytes8 damaged(Bytes8 bytes, std::mt19937& random) {
    const auto anywhere = [&] { return random() % bytes.size(); };
    const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
    for (std::size_t n = random() % 6; n > 0; --n) {
        const std::size_t at = anywhere();
        const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        switch (random() % 6) {
            case 0: bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << random() % 8)); break;
            case 1:
                bytes.erase(here, here + static_cast<std::ptrdiff_t>(std::min(
                                             bytes.size() - at, random() % std::size_t{40})));
                break;
            case 2: bytes.insert(here, random() % 600, byte()); break;
            case 3: {  // a head that holds back what follows
                const std::uint8_t head[] = {0xC1, 0xE0, wire::version};
                bytes.insert(here, head, head + 3);
                break;
            }
            case 4: {
                const Bytes8 heads = false_heads();
                bytes.insert(here, heads.begin(), heads.end());
                break;
            }
            default:
                for (std::size_t i = at; i < bytes.size() && i < at + 300; ++i) bytes[i] = byte();
        }
    }
    return bytes;
}

void drain(Decoder& decoder) {
    Decoder::Update update;
    while (decoder.next(update)) {
    }
    Event event;
    while (decoder.next_event(event)) {
    }
}

TEST(Decoder, FindsTheFramesOfAPlainSearchWhateverTheDamage) {
    const std::random_device::result_type seed = std::random_device{}();
    std::mt19937 random{seed};
    for (int trial = 0; trial < 400; ++trial) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", trial " << trial);
        static const Bytes8 clean[] = {stream(1), stream(2)};
        const Bytes8 bytes = damaged(clean[trial % 2], random);
        const Found plain = plain_search(bytes);
        const auto decoder = std::make_unique<Decoder>();
        for (const std::uint8_t b : bytes)
            if (decoder->push(b)) drain(*decoder);
        while (decoder->finish()) drain(*decoder);
        ASSERT_EQ(decoder->counters().frames, plain.curves.size());
        ASSERT_EQ(decoder->event_counters().frames, plain.events.size());
        ASSERT_EQ(decoder->counters().skipped_bytes, plain.skipped);
        ASSERT_EQ(decoder->counters().damaged, plain.damaged);
    }
}

TEST(Decoder, TakesAFrameOnceAPushAndIsNeverLaterThanItSays) {
    constexpr std::size_t late_max = wire::max_frame / (Decoder::tries_per_byte - 1);
    const Bytes8 clean = stream(3);
    const Found frames = plain_search(clean);
    for (const bool dense : {false, true}) {
        Bytes8 bytes = dense ? false_heads() : Bytes8{0xC1, 0xE0, wire::version};
        const std::size_t before = bytes.size();
        bytes.insert(bytes.end(), clean.begin(), clean.end());
        const auto decoder = std::make_unique<Decoder>();
        std::size_t last = 0, curves = 0;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            const auto counters = decoder->counters();
            const auto events = decoder->event_counters().frames;
            const bool frame = decoder->push(bytes[i]);
            const auto more = decoder->counters().frames - counters.frames +
                              decoder->event_counters().frames - events;
            ASSERT_EQ(more, frame ? 1u : 0u);
            ASSERT_LE(decoder->counters().skipped_bytes - counters.skipped_bytes,
                      Decoder::tries_per_byte);
            if (frame) drain(*decoder);
            if (decoder->counters().frames == counters.frames) continue;
            // due when it is complete and the false head has had its length
            const std::size_t next = ++curves < frames.curves.size() ? frames.curves[curves] : 0;
            const std::size_t end = before + (next > 0 ? next : clean.size());
            last = std::max(end, wire::max_frame) + late_max;
            ASSERT_LE(i, last) << "curve frame " << curves;
        }
        ASSERT_EQ(curves, frames.curves.size());
    }
}

TEST(Decoder, WhatLooksLikeAHeadHoldsNoRestartFrameBack) {
    const Bytes8 clean = stream(5);
    const Found frames = plain_search(clean);
    ASSERT_GT(frames.curves.size(), 2u);
    for (const std::size_t between : {0u, 1u, 2u, 100u, 300u}) {
        Bytes8 bytes{0xC1, 0xE0, wire::version};  // 480 bytes are to come
        bytes.resize(bytes.size() + between, 0x11);
        bytes.insert(bytes.end(), clean.begin(), clean.end());
        std::size_t whole = frames.curves[1];
        for (const std::size_t event : frames.events)
            if (event > frames.curves[0]) whole = std::min(whole, event);
        whole += 3 + between;
        const auto decoder = std::make_unique<Decoder>();
        for (std::size_t i = 0; i < whole; ++i) {
            ASSERT_FALSE(decoder->in_step()) << "byte " << i;
            decoder->push(bytes[i]);
        }
        EXPECT_TRUE(decoder->in_step()) << between << " bytes between";
    }
}

TEST(Decoder, UndamagedFramesComeWithTheirLastByte) {
    const Bytes8 bytes = stream(4);
    const Found frames = plain_search(bytes);
    std::map<std::size_t, bool> begins;
    for (const std::size_t at : frames.curves) begins[at] = true;
    for (const std::size_t at : frames.events) begins[at] = true;
    ASSERT_GT(frames.events.size(), 5u);
    ASSERT_GT(frames.curves.size(), 20u);
    const auto decoder = std::make_unique<Decoder>();
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const bool due = begins.count(i + 1) > 0 || i + 1 == bytes.size();
        ASSERT_EQ(decoder->push(bytes[i]), due) << "byte " << i;
        if (due) drain(*decoder);
    }
}

TEST(Backlog, KnowsTheChecksumOfEveryPieceHoweverBytesCameAndWent) {
    std::mt19937 random{7};
    Bytes8 live;
    wire::Backlog backlog;
    const auto push = [&](std::uint8_t byte) {
        live.push_back(byte);
        backlog.push(byte);
    };
    unsigned right = 0, wrong = 0;
    for (int step = 0; step < 30000; ++step) {
        const auto seed = static_cast<std::uint16_t>(random());
        if (live.size() + 3 > wire::Backlog::live_max || random() % 60 == 0) {
            const std::size_t n = 1 + random() % (live.size() + 1);
            backlog.drop(std::min(n, live.size()));
            live.erase(live.begin(),
                       live.begin() + static_cast<std::ptrdiff_t>(std::min(n, live.size())));
        }
        if (random() % 8 == 0 && !live.empty()) {  // seal what there is
            const std::uint16_t crc = crc16(live.data(), live.size(), seed);
            push(static_cast<std::uint8_t>(crc >> 8));
            push(static_cast<std::uint8_t>(crc & 255));
            ASSERT_TRUE(backlog.sealed(0, live.size() - 2, seed)) << live.size();
            ++right;
        } else {
            push(static_cast<std::uint8_t>(random()));
        }
        ASSERT_EQ(backlog.size(), live.size());
        if (live.size() < 3) continue;
        const std::size_t n = 1 + random() % (live.size() - 2);
        ASSERT_EQ(backlog[n], live[n]);
        ASSERT_EQ(backlog.data()[n], live[n]);
        const bool sealed = crc16(live.data(), n + 2, seed) == 0;
        ASSERT_EQ(backlog.sealed(0, n, seed), sealed);
        wrong += !sealed;
    }
    ASSERT_GT(right, 1000u);
    ASSERT_GT(wrong, 1000u);
}

}  // namespace
