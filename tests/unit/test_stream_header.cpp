// Header frames: what is written is read, extremes among it, and nonsense is refused. Absolute
// values are told against the header's origins.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>

#include "tests/unit/random_stream.hpp"

namespace fairlead::test {
namespace {

wire::Header plain_header() {
    wire::Header header;
    wire::StreamShape& s = header.shape;
    s.timing = {130'208, 6, false, 114, 2};
    s.channels = 1;
    s.channel[0].type = wire::ChannelType::vector;
    s.channel[0].kind = 1;
    s.channel[0].axes = 3;
    s.channel[0].tolerance = 27'357;
    s.channel[0].step.fill(curve::Scale::of_step(0.0012f));
    header.starts = true;
    return header;
}
ByteVector bytes_of(wire::Header& header) {
    ByteVector bytes(wire::header_frame_max);
    bytes.resize(wire::write_header(header, bytes.data()));
    return bytes;
}
/// The frame with this payload, and the right size and CRC-32.
ByteVector sealed(const ByteVector& payload) {
    const std::size_t size = payload.size() + 2;
    ByteVector bytes(size + 4);
    bytes[0] = wire::header_head;
    bytes[1] = static_cast<std::uint8_t>(payload.size());
    std::copy(payload.begin(), payload.end(), bytes.begin() + 2);
    const std::uint32_t crc = crc32(bytes.data(), size);
    for (std::size_t i = 0; i < 4; ++i) bytes[size + i] = static_cast<std::uint8_t>(crc >> (8 * i));
    return bytes;
}
wire::HeaderFault fault_of(const ByteVector& bytes) {
    wire::Header header;
    return wire::read_header(bytes.data(), bytes.size(), header);
}
void expect_same(const wire::Header& a, const wire::Header& b) {
    const wire::StreamShape &x = a.shape, &y = b.shape;
    EXPECT_EQ(x.stream_id, y.stream_id);
    EXPECT_EQ(x.run, y.run);
    EXPECT_EQ(x.base_ns, y.base_ns);
    EXPECT_EQ(x.timing.sub_ns, y.timing.sub_ns);
    EXPECT_EQ(x.timing.time_bits, y.timing.time_bits);
    EXPECT_EQ(x.timing.independent, y.timing.independent);
    EXPECT_EQ(x.timing.usual_ticks, y.timing.usual_ticks);
    EXPECT_EQ(x.timing.restart_frames, y.timing.restart_frames);
    ASSERT_EQ(x.channels, y.channels);
    for (std::size_t c = 0; c < x.channels; ++c) {
        EXPECT_EQ(x.channel[c].type, y.channel[c].type);
        EXPECT_EQ(x.channel[c].kind, y.channel[c].kind);
        ASSERT_EQ(x.channel[c].axes, y.channel[c].axes);
        EXPECT_EQ(x.channel[c].tolerance, y.channel[c].tolerance);
        for (std::size_t i = 0; i < x.channel[c].axes; ++i) {
            EXPECT_EQ(x.channel[c].step[i].m, y.channel[c].step[i].m);
            EXPECT_EQ(x.channel[c].step[i].e, y.channel[c].step[i].e);
            EXPECT_EQ(x.channel[c].origin[i], y.channel[c].origin[i]);
        }
    }
    EXPECT_EQ(a.digest, b.digest);
    EXPECT_EQ(a.end, b.end);
    EXPECT_EQ(a.starts, b.starts);
}

TEST(StreamHeader, IsReadAsItWasWritten) {
    std::mt19937_64 random{1};
    const auto pick = [&](std::int64_t least, std::int64_t most) {
        const std::uint64_t range =
            static_cast<std::uint64_t>(most) - static_cast<std::uint64_t>(least);
        switch (random() % 4) {
            case 0: return least;
            case 1: return most;
            default: break;
        }
        const std::uint64_t some = random() >> random() % 60;
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(least) +
                                         (range == UINT64_MAX ? some : some % (range + 1)));
    };
    for (int round = 0; round < 2000; ++round) {
        wire::Header header;
        wire::StreamShape& s = header.shape;
        s.stream_id = static_cast<std::uint16_t>(pick(0, 0xffff));
        s.run = static_cast<std::uint16_t>(pick(0, 0xffff));
        s.base_ns = pick((std::numeric_limits<std::int64_t>::min)(),
                         (std::numeric_limits<std::int64_t>::max)());
        s.timing = {static_cast<std::uint32_t>(pick(1, 0xffffffff)),
                    static_cast<std::uint8_t>(pick(5, 32)), random() % 2 == 0,
                    static_cast<std::uint8_t>(pick(1, 255)),
                    static_cast<std::uint8_t>(pick(0, 255))};
        s.channels = static_cast<std::uint8_t>(pick(1, 4));
        for (std::size_t c = 0; c < s.channels; ++c) {
            wire::ChannelShape& shape = s.channel[c];
            shape.type = random() % 2 ? wire::ChannelType::vector : wire::ChannelType::orientation;
            shape.axes = shape.type == wire::ChannelType::vector
                             ? static_cast<std::uint8_t>(pick(1, 8))
                             : std::uint8_t{3};
            shape.kind = static_cast<std::uint8_t>(pick(1, 7));
            shape.tolerance = static_cast<std::uint16_t>(pick(0, 0xffff));
            const bool own = random() % 2 == 0;
            for (std::size_t i = 0; i < shape.axes; ++i) {
                shape.step[i] = i > 0 && !own
                                    ? shape.step[0]
                                    : curve::Scale{static_cast<std::uint16_t>(pick(256, 511)),
                                                   static_cast<std::int16_t>(pick(-100, 60))};
                shape.origin[i] =
                    static_cast<std::int32_t>(pick(-wire::origin_max, wire::origin_max));
            }
        }
        header.end = pick(-wire::run_max, wire::run_max);
        header.starts = random() % 2 == 0;
        const ByteVector bytes = bytes_of(header);
        ASSERT_LE(bytes.size(), wire::header_frame_max);
        wire::Header read;
        ASSERT_EQ(wire::read_header(bytes.data(), bytes.size(), read), wire::HeaderFault::none);
        expect_same(header, read);
    }
}

TEST(StreamHeader, IsShort) {
    wire::Header header = plain_header();
    const std::size_t least = bytes_of(header).size();
    EXPECT_EQ(least, 24u);                             // 3 of them are origins
    header.shape.base_ns = 1'700'000'000'123'456'789;  // a Unix time
    EXPECT_EQ(bytes_of(header).size(), least + 8);
    header.shape.channel[0].origin = {-8191, 8191, 0};
    EXPECT_EQ(bytes_of(header).size(), least + 8 + 2);
}

TEST(StreamHeader, NonsenseIsRefused) {
    wire::Header header = plain_header();
    const ByteVector bytes = bytes_of(header);
    const ByteVector payload(bytes.begin() + 2, bytes.end() - 4);
    EXPECT_EQ(fault_of(sealed(payload)), wire::HeaderFault::none);
    for (std::size_t size = 1; size < payload.size(); ++size)  // cut short
        EXPECT_EQ(fault_of(sealed({payload.begin(), payload.begin() + static_cast<long>(size)})),
                  wire::HeaderFault::bad_content);
    ByteVector longer = payload;
    longer.push_back(0);
    EXPECT_EQ(fault_of(sealed(longer)), wire::HeaderFault::bad_content);

    // a number in place of the byte at `at`, as v
    const auto with = [&](std::size_t at, std::initializer_list<std::uint8_t> number) {
        ByteVector other;
        for (std::size_t i = 0; i < at; ++i) other.push_back(payload[i]);
        for (const std::uint8_t byte : number) other.push_back(byte);
        for (std::size_t i = at + 1; i < payload.size(); ++i) other.push_back(payload[i]);
        return fault_of(sealed(other));
    };
    const auto bad = wire::HeaderFault::bad_content, good = wire::HeaderFault::none;
    ASSERT_EQ(payload[1], 0);  // stream id
    EXPECT_EQ(with(1, {0xff, 0xff, 3}), good);
    EXPECT_EQ(with(1, {0x80, 0x80, 4}), bad);
    EXPECT_EQ(with(2, {0x80, 0x80, 4}), bad);  // run
    EXPECT_EQ(with(2, {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1}), bad);
    EXPECT_EQ(with(3, {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1}), good);  // base
    EXPECT_EQ(with(3, {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 2}), bad);
    EXPECT_EQ(with(7, {3}), bad);  // 4 time bits
    EXPECT_EQ(with(7, {4}), good);
    EXPECT_EQ(with(8, {0}), bad);  // no usual ticks
    ASSERT_EQ(payload[11], 100);   // tolerance: 50 more than usual
    const std::uint32_t least = 2 * 27'307 - 1, most = 2 * (65'535 - 27'307);
    const auto tolerance = [&](std::uint32_t x) {
        return with(
            11, {static_cast<std::uint8_t>(x | 0x80u), static_cast<std::uint8_t>(x >> 7 | 0x80u),
                 static_cast<std::uint8_t>(x >> 14)});
    };
    EXPECT_EQ(tolerance(least), good);
    EXPECT_EQ(tolerance(least + 2), bad);
    EXPECT_EQ(tolerance(most), good);
    EXPECT_EQ(tolerance(most + 2), bad);
    EXPECT_EQ(with(11, {0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1}), bad);
    ASSERT_EQ(payload[14], 0);  // the first origin
    EXPECT_EQ(with(14, {0xfe, 0xff, 0xff, 0x7f}), good);
    EXPECT_EQ(with(14, {0x80, 0x80, 0x80, 0x80, 1}), bad);
}

TEST(StreamHeader, TheOriginOfARotationLiesOnItsGrid) {
    wire::StreamShape shape;
    shape.channels = 1;
    wire::ChannelShape& c = shape.channel[0];
    c.type = wire::ChannelType::orientation;
    c.axes = 3;
    c.step.fill(curve::Scale::of_step(0.0039f));
    wire::Tracks<3, 1> layout;
    const std::int32_t most = curve::grid_size(c.step[0].step<float>());
    for (const std::int32_t n : {0, 1, -1, most, -most}) {
        const curve::GridQuat g{2,
                                {static_cast<std::int16_t>(n), 5, static_cast<std::int16_t>(-n)}};
        wire::put_origin(c, g);
        ASSERT_TRUE(layout.take(shape));
        EXPECT_EQ(layout.turn_origin[0].n, g.n);
        EXPECT_EQ(layout.turn_origin[0].largest, 2);
    }
    for (const std::size_t i : {0u, 1u, 2u}) {
        curve::GridQuat g{0, {}};
        g.n[i] = static_cast<std::int16_t>(most + 1);
        wire::put_origin(c, g);
        EXPECT_FALSE(layout.take(shape)) << i;
        g.n[i] = static_cast<std::int16_t>(-most - 1);
        wire::put_origin(c, g);
        EXPECT_FALSE(layout.take(shape)) << i;
    }
}

/// What write(encoder) wrote, to read(decoder).
template <class Write, class Read>
void through_bytes(Write&& write, Read&& read) {
    std::array<std::uint8_t, 64> bytes{};
    code::RangeEncoder out{bytes.data(), bytes.size()};
    write(out);
    const std::size_t size = out.finish();
    ASSERT_TRUE(out.ok());
    code::RangeDecoder in{bytes.data(), size};
    read(in);
    EXPECT_TRUE(in.finished());
}

TEST(StreamHeader, ValuesAreToldAgainstAnOrigin) {
    const std::int32_t outmost = curve::vertex_max, origin = wire::origin_max;
    const std::int32_t cases[][2][3]{
        {{0, 0, 0}, {0, 0, 0}},
        {{7, 8, 9}, {7, 8, 9}},
        {{8, 8, 8}, {7, 8, 9}},
        {{0x7fff, 0, -0x7fff}, {0, 0, 0}},
        {{0xffff, 0x10000, 1}, {0, 0, 0}},
        {{outmost, -outmost, 0}, {-origin, origin, origin}},
    };
    for (const auto& [value, from] : cases)
        through_bytes(
            [&](auto& io) {
                std::int32_t v[3]{value[0], value[1], value[2]};
                EXPECT_TRUE(wire::detail::code_values(io, v, from, 3));
                for (int i = 0; i < 3; ++i) EXPECT_EQ(v[i], value[i]);
            },
            [&](auto& io) {
                std::int32_t v[3]{};
                EXPECT_TRUE(wire::detail::code_values(io, v, from, 3));
                for (int i = 0; i < 3; ++i) EXPECT_EQ(v[i], value[i]);
            });
    // beyond the bound of vertices
    const std::int32_t zero[1]{}, one[1]{1};
    through_bytes(
        [&](auto& io) {
            std::int32_t v[1]{outmost};
            EXPECT_TRUE(wire::detail::code_values(io, v, zero, 1));
        },
        [&](auto& io) {
            std::int32_t v[1]{};
            EXPECT_FALSE(wire::detail::code_values(io, v, one, 1));
        });
}

TEST(StreamHeader, PlacesOnTheGridAreToldAgainstAnOrigin) {
    const float step = 0.0039f;
    const auto most = static_cast<std::int16_t>(curve::grid_size(step));
    const curve::GridQuat origin{1, {10, -20, most}};
    std::mt19937_64 random{3};
    for (int round = 0; round < 3000; ++round) {
        curve::GridQuat g = origin;
        const int reach = round % 3 == 0 ? 0 : round % 3 == 1 ? 20 : 2 * most;
        for (auto& n : g.n) {
            const auto add =
                static_cast<int>(random() % static_cast<unsigned>(2 * reach + 1)) - reach;
            n = static_cast<std::int16_t>((std::max)(-most, (std::min)(int{most}, n + add)));
        }
        if (round % 7 == 0) g.largest = static_cast<std::uint8_t>(random() % 4);
        through_bytes(
            [&](auto& io) {
                curve::GridQuat same = g;
                EXPECT_TRUE(wire::detail::code_grid(io, same, origin, step));
                EXPECT_EQ(same.n, g.n);
            },
            [&](auto& io) {
                curve::GridQuat read;
                EXPECT_TRUE(wire::detail::code_grid(io, read, origin, step));
                EXPECT_EQ(read.n, g.n);
                EXPECT_EQ(read.largest, g.largest);
            });
    }
    // a difference that leads off the grid is nonsense
    through_bytes(
        [&](auto& io) {
            bool elsewhere = false;
            io.flag(elsewhere, 1, 1);
            std::int32_t apart[3]{0, 0, 1};
            wire::detail::code_values(io, apart, 3);
        },
        [&](auto& io) {
            curve::GridQuat read;
            EXPECT_FALSE(wire::detail::code_grid(io, read, origin, step));
        });
}

}  // namespace
}  // namespace fairlead::test
