// Frames of C2 cubics, from the writer to readers, without a search: random pieces of all sorts.
// A reader that joins at a restart frame tells the same pieces, bit for bit, from where the run of
// three ends; where the curve does not break, value, velocity and acceleration go on exactly.
#include <gtest/gtest.h>

#include <map>

#include "fairlead/wire/decoder.hpp"
#include "tests/unit/cubic_stream.hpp"

namespace fairlead {
namespace {

using test::CubicStream;
using Bytes = CubicStream::Bytes;
using Reader = wire::Decoder<3, 0, wire::KindSet<curve::Cubics>>;
using Piece = Reader::Piece;

using Told = std::map<std::pair<int, std::int64_t>, Piece>;  // by axis and end

void tell(Reader& reader, const Bytes& bytes, Told& told) {
    for (const std::uint8_t byte : bytes)
        if (reader.push(byte))
            for (Piece p; reader.next(p);) told[{p.axis, p.end}] = p;
}

bool same(const Piece& a, const Piece& b) {
    return a.start == b.start && a.code == b.code && a.cubic == b.cubic && a.v[0] == b.v[0] &&
           a.s[0] == b.s[0] && a.jumps == b.jumps && a.ends == b.ends &&
           a.span.start[0] == b.span.start[0] && a.span.j[0] == b.span.j[0] &&
           a.span.known == b.span.known;
}

TEST(CubicFrames, ReadersTellWhatWasWritten) {
    std::size_t pieces = 0, joins = 0, later = 0, refused = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        CubicStream stream{seed};
        Reader reader, joiner;
        Told told, again;
        tell(reader, stream.header(), told);
        std::int64_t joined = -1;
        for (unsigned i = 1; i <= 60; ++i) {
            const bool restart = i % 4 == 0;
            const Bytes bytes = stream.frame(restart);
            refused += bytes.empty();
            const std::int64_t start = reader.frame_end();
            tell(reader, bytes, told);
            if (i == 3) {
                ASSERT_TRUE(joiner.adopt(stream.header().data(), stream.header().size()));
            }
            if (i >= 4) tell(joiner, bytes, again);
            if (joined < 0 && joiner.in_step()) joined = start;
            if (bytes.empty() || stream.states().live == 0) continue;
            for (std::size_t a = 0; a < 3; ++a) {
                const auto &w = stream.states().cubic[a], &r = reader.states().cubic[a];
                ASSERT_EQ(w.at[0], r.at[0]) << seed << ' ' << i;
                ASSERT_EQ(w.run, r.run);
                ASSERT_TRUE(r.known);
            }
        }
        EXPECT_EQ(reader.counters().nonsense, 0u);
        EXPECT_EQ(joiner.counters().nonsense, 0u);
        ASSERT_GE(joined, 0) << seed;
        ++joins;
        pieces += told.size();
        for (const auto& [key, piece] : again) {
            ASSERT_EQ(told.count(key), 1u);
            ASSERT_TRUE(same(piece, told[key])) << seed << " at " << key.second;
            ++later;
        }
        // behind the frame where it joined, it tells all
        for (const auto& [key, piece] : told)
            if (piece.start >= joined + 64 * 200) {
                ASSERT_EQ(again.count(key), 1u);
            }
    }
    EXPECT_EQ(joins, 40u);
    EXPECT_GT(pieces, 10000u);
    EXPECT_GT(later, pieces / 2);
    EXPECT_LT(refused, 400u);
}

TEST(CubicFrames, TheBytesAreThoseOfVersion5) {
    std::uint32_t all = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        CubicStream stream{1000 + seed};
        Bytes bytes = stream.header();
        for (int i = 0; i < 20; ++i)
            for (const std::uint8_t byte : stream.frame(i % 5 == 4)) bytes.push_back(byte);
        all = crc32(bytes.data(), bytes.size(), all);
    }
    EXPECT_EQ(all, 3113197938u);
}

TEST(CubicFrames, TheCurveGoesOnWithValueVelocityAndAcceleration) {
    std::size_t seams = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        CubicStream stream{seed};
        Reader reader;
        Told told;
        tell(reader, stream.header(), told);
        for (unsigned i = 1; i <= 40; ++i) tell(reader, stream.frame(i % 5 == 0), told);
        const Piece* before = nullptr;
        for (const auto& [key, piece] : told) {
            const bool follows = before != nullptr && before->axis == piece.axis &&
                                 before->end == piece.start && before->cubic && piece.cubic &&
                                 !piece.begins && !curve::is_line(piece.code);
            if (follows) {
                const double h = before->ticks(), p = before->steps_at(h), q = piece.steps_at(0.0);
                // a restart moves the value by what its roundings leave, at most
                const double room = 1e-3;
                ASSERT_NEAR(p, q, room);
                ASSERT_NEAR(before->rate_at(h), piece.rate_at(0.0), room);
                ASSERT_NEAR(before->bend_at(h), piece.bend_at(0.0), room);
                ++seams;
            }
            before = &piece;
        }
    }
    EXPECT_GT(seams, 2000u);
}

TEST(CubicFrames, OtherReadersRefuseThemAndSayWhy) {
    CubicStream stream{1};
    wire::Decoder<3, 0> quadratics;
    for (const std::uint8_t byte : stream.header()) quadratics.push(byte);
    using Refused = decltype(quadratics)::Refused;
    EXPECT_EQ(quadratics.refused(), Refused::shape);
    wire::Decoder<3, 1, wire::KindSet<curve::Smooth, curve::Cubics>> all;
    for (const std::uint8_t byte : stream.header()) all.push(byte);
    EXPECT_EQ(all.counters().headers, 1u);
}

}  // namespace
}  // namespace fairlead
