// Frames hold what they are given, number for number, and the dearest contents fit.
#include "fairlead/wire/layout.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

using namespace fairlead;

namespace {

constexpr std::size_t batch_knots = Reducer<OrientationChannel, 60>::batch_knots;
constexpr std::uint32_t tick_ns = 4100000;
constexpr std::int32_t most = 1 << 30;

std::mt19937 random_{19};
std::uint32_t any(std::uint32_t limit) { return static_cast<std::uint32_t>(random_()) % limit; }
/// Any size from 1 bit to `bits`.
std::int32_t coefficient(unsigned bits) {
    const auto v = static_cast<std::int32_t>(random_() >> (32 - bits + any(bits)));
    return any(2) != 0 ? v : -v;
}

template <class Channel>
using Frozen = Batch<Channel, batch_knots>;

template <class Channel>
Frozen<Channel> any_batch(const wire::Link<Channel>& link, bool begins, std::int64_t base_ns) {
    Frozen<Channel> out;
    std::uint32_t covered = link.cover_ticks;
    if (begins) {
        out.begins = true;
        out.breaks = any(2) != 0;
        out.coarse = static_cast<std::uint8_t>(any(10));
        out.start.span.t0_ns =
            (link.active ? link.curve.span.t0_ns : base_ns) + std::int64_t{any(5000)} * tick_ns;
        for (std::size_t m = 0; m < Channel::order; ++m) {
            const int shift = start_shift(m, out.coarse);
            for (auto& c : out.start.span.c[m]) c = coefficient(20) / (1 << shift) * (1 << shift);
        }
        covered = 0;
    }
    out.size = any(batch_knots + 1);
    for (std::size_t i = 0; i < out.size; ++i) {
        auto& k = out.knot[i];
        k.ticks = std::max(covered, 1u) + any(300);
        covered = 0;
        k.shift = static_cast<std::uint8_t>(any(29));
        if (any(8) == 0) {
            k.shift = stop_shift;
        } else {
            for (auto& j : k.jump) j = coefficient(14);
        }
    }
    out.covers = any(4) != 0;
    if (out.covers) out.cover_ticks = (out.size > 0 ? 0 : covered) + any(200);
    return out;
}

template <class Channel>
void expect_equal(const Frozen<Channel>& a, const Frozen<Channel>& b) {
    ASSERT_EQ(a.begins, b.begins);
    ASSERT_EQ(a.covers, b.covers);
    ASSERT_EQ(a.size, b.size);
    if (a.begins) {
        EXPECT_EQ(a.breaks, b.breaks);
        EXPECT_EQ(a.coarse, b.coarse);
        EXPECT_EQ(a.start.span.t0_ns, b.start.span.t0_ns);
        EXPECT_EQ(a.start.span.c, b.start.span.c);
    }
    for (std::size_t i = 0; i < a.size; ++i) {
        EXPECT_EQ(a.knot[i].ticks, b.knot[i].ticks);
        EXPECT_EQ(a.knot[i].shift, b.knot[i].shift);
        EXPECT_EQ(a.knot[i].jump, b.knot[i].jump);
    }
    if (a.covers) {
        EXPECT_EQ(a.cover_ticks, b.cover_ticks);
    }
}

template <class Channel>
void follow(wire::Link<Channel>& link, const Frozen<Channel>& batch) {
    wire::follow_start(link, batch);
    for (std::size_t i = 0; i < batch.size; ++i) wire::follow_knot(link, batch, i, tick_ns);
    if (batch.covers) link.cover_ticks = batch.cover_ticks;
}

/// A chain of frames of one channel, with a restart now and then, from which a fresh reader starts.
template <class Channel>
void survives() {
    for (int chain = 0; chain < 40; ++chain) {
        wire::Link<Channel> sender, reader;
        sender.enabled = true;
        std::vector<std::uint8_t> memory(4000);
        for (int frame = 0; frame < 40; ++frame) {
            const bool restart = frame % 8 == 0;
            BitWriter out{memory.data(), memory.size()};
            wire::Header header{any(256), tick_ns + any(2), 0};
            // the clock: whole microseconds or not, after or before zero, on the grid of the knots
            header.base_ns = sender.active ? sender.curve.span.t0_ns : coefficient(31) - most / 2;
            header.tick_ns = tick_ns;
            if (sender.active)
                header.base_ns += std::int64_t{sender.cover_ticks + any(300)} * tick_ns;
            if (restart) {
                wire::header(out, header);
                wire::state(out, sender, header.base_ns, tick_ns);
            }
            const auto sent = any_batch(sender, frame == 0 || any(10) == 0, header.base_ns);
            auto copy = sent;
            ASSERT_TRUE(wire::content(out, sender, copy, header.base_ns, tick_ns));
            follow(sender, sent);

            BitReader in{memory.data(), out.size()};
            if (restart) {
                wire::Header read;
                reader = {};
                ASSERT_TRUE(wire::header(in, read));
                EXPECT_EQ(read.sequence, header.sequence);
                EXPECT_EQ(read.tick_ns, header.tick_ns);
                EXPECT_EQ(read.base_ns, header.base_ns);
                wire::state(in, reader, read.base_ns, read.tick_ns);
            }
            Frozen<Channel> got;
            ASSERT_TRUE(wire::content(in, reader, got, header.base_ns, tick_ns))
                << "chain " << chain << " frame " << frame;
            expect_equal(sent, got);
            follow(reader, got);
            EXPECT_EQ(reader.curve.span.c, sender.curve.span.c);
            EXPECT_EQ(reader.curve.span.t0_ns, sender.curve.span.t0_ns);
            EXPECT_EQ(reader.cover_ticks, sender.cover_ticks);
            if (testing::Test::HasFailure()) return;
        }
    }
}

/// A link and a batch for which every number is as long as it can be.
template <class Channel>
Frozen<Channel> dearest(wire::Link<Channel>& link) {
    for (RiceModel* m : {&link.models.ticks, &link.models.reach, &link.models.finer,
                         &link.models.jump[0], &link.models.jump[1]})
        m->mean16 = 0;
    Frozen<Channel> out;
    out.begins = out.covers = true;
    out.cover_ticks = ~0u;
    out.start.span.t0_ns = std::int64_t{1} << 40;
    for (auto& row : out.start.span.c) row.fill(-most);
    out.size = batch_knots;
    for (std::size_t i = 0; i < batch_knots; ++i) {
        out.knot[i].ticks = ~0u - 7;
        out.knot[i].shift = static_cast<std::uint8_t>(i % 2 * 28);
        out.knot[i].jump.fill(i % 2 ? most : -most);
    }
    return out;
}

}  // namespace

TEST(Layout, APositionComesOutAsItWentIn) { survives<VectorChannel<3>>(); }
TEST(Layout, AnOrientationComesOutAsItWentIn) { survives<OrientationChannel>(); }

TEST(Layout, TheDearestContentsOfBothChannelsFitIntoAFrame) {
    wire::Link<VectorChannel<3>> position;
    wire::Link<OrientationChannel> orientation;
    auto a = dearest(position);
    auto b = dearest(orientation);
    std::vector<std::uint8_t> memory(wire::max_payload);
    BitWriter out{memory.data(), memory.size()};
    wire::content(out, position, a, 0, tick_ns);
    wire::content(out, orientation, b, 0, tick_ns);
    EXPECT_TRUE(out.ok()) << "more than " << wire::max_payload << " bytes";
}

TEST(Layout, ACurveThatGoesOnAsBeforeTakesFiveBits) {
    wire::Link<VectorChannel<3>> link;
    link.active = true;
    link.stride = 40;
    std::array<std::uint8_t, 16> memory{};
    BitWriter out{memory.data(), memory.size()};
    for (int frame = 0; frame < 8; ++frame) {
        Frozen<VectorChannel<3>> batch;
        batch.covers = true;
        batch.cover_ticks = link.cover_ticks + 40;
        wire::content(out, link, batch, 0, tick_ns);
        link.cover_ticks = batch.cover_ticks;
    }
    EXPECT_EQ(out.size(), 5u);
}
