// Frames of random curves through writer and reader: equal states, and pieces that say what was
// written; lost, repeated, damaged and foreign frames; readers that join late.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/unit/random_stream.hpp"

namespace fairlead::test {
namespace {

struct Sent {
    ByteVector bytes;
    Writer::States after;
    std::int64_t end{0};
    std::size_t from{0};  // place in the stream
};

struct Stream {
    RandomStream source;
    std::vector<Sent> frames;
    ByteVector all;

    Stream(const Options& options, std::uint64_t seed, int count, int headers_every = 0)
        : source{options, seed} {
        add(source.header(true));
        for (int i = 0; i < count; ++i) {
            ByteVector bytes = source.frame();
            if (bytes.empty()) continue;
            frames.push_back(
                {bytes, source.writer().states, source.writer().link().end, all.size()});
            add(bytes);
            if (headers_every > 0 && i % headers_every == headers_every - 1)
                add(source.header(false));
        }
    }
    ByteVector head() const {  // the bytes before the first frame
        return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(frames[0].from)};
    }
    void add(const ByteVector& bytes) { all.insert(all.end(), bytes.begin(), bytes.end()); }
};

bool same(const curve::State<1>& a, const curve::State<1>& b) {
    return a.v == b.v && a.s == b.s && a.last_k == b.last_k && a.sign == b.sign &&
           a.last_code == b.last_code && a.last_ticks == b.last_ticks && a.phase == b.phase &&
           a.fresh == b.fresh;
}
bool same(const curve::State<3>& a, const curve::State<3>& b) {
    return a.v == b.v && a.s == b.s && a.last_k == b.last_k && a.sign == b.sign &&
           a.last_code == b.last_code && a.last_ticks == b.last_ticks && a.fresh == b.fresh;
}
bool same(const Quat& a, const Quat& b) {
    return a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z;
}
bool same(const Writer::States& a, const Reader::States& b) {
    if (a.live != b.live) return false;
    bool good = true;
    if (a.live & 1u)
        for (std::size_t i = 0; i < 3; ++i) good = good && same(a.axis[i], b.axis[i]);
    if (a.live & 2u)
        good = good && same(a.rotation[0].anchor, b.rotation[0].anchor) &&
               same(a.rotation[0].chart, b.rotation[0].chart);
    return good;
}

/// What a reader told, and whether any of it differs from what was sent.
struct Told {
    std::vector<wire::CurvePiece> pieces;
    std::size_t frames{0}, wrong{0};
};

template <class R>
Told read(R& reader, const ByteVector& bytes, const std::vector<Sent>& sent, bool drain = true,
          bool finish = true) {
    Told told;
    std::multimap<std::int64_t, const Sent*> by_end;  // frames without duration share one
    for (const Sent& s : sent) by_end.emplace(s.end, &s);
    const auto take = [&] {
        ++told.frames;
        const auto range = by_end.equal_range(reader.frame_end());
        bool known = false;
        wire::CurvePiece piece;
        const bool hidden = reader.states().hidden != 0;
        while (drain && reader.next(piece)) told.pieces.push_back(piece);
        // a reader that has just joined does not know the slopes yet
        for (auto it = range.first; it != range.second; ++it)
            known = known || hidden || same(it->second->after, reader.states());
        told.wrong += !known;
    };
    for (const std::uint8_t b : bytes)
        if (reader.push(b)) take();
    while (finish && reader.finish()) take();
    return told;
}

Options some_options(std::uint64_t seed) {
    Options o;
    o.kind = 1;
    o.restart_every = static_cast<unsigned>(seed % 5);
    if (o.restart_every == 1) o.restart_every = 2;       // never one behind the other
    o.restart_frames = static_cast<unsigned>(seed % 6);  // as restart_every says, or otherwise
    o.time_bits = static_cast<std::uint8_t>(9 + seed % 5);
    o.independent = seed % 7 == 3;
    o.position = seed % 11 != 4;
    o.orientation = !o.position || seed % 13 != 5;
    o.jumps = seed % 3 == 0 ? 0.2 : 0.01;
    o.size = static_cast<int>(1 + seed % 20);
    if (seed % 17 == 0) o.usual_ticks = 8;
    return o;
}

TEST(Stream, ReaderHasTheWritersStateAfterEveryFrame) {
    std::size_t frames = 0, pieces = 0, refused = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        const Stream stream{some_options(seed), seed, 60, 9};
        Reader reader;
        const Told told = read(reader, stream.all, stream.frames);
        ASSERT_EQ(told.frames, stream.frames.size()) << seed;
        ASSERT_EQ(told.wrong, 0u) << seed;
        EXPECT_EQ(reader.frame_counters().losses, 0u);
        EXPECT_EQ(reader.frame_counters().good_bytes, stream.all.size());
        frames += told.frames;
        pieces += told.pieces.size();
        refused += stream.source.refused();
    }
    EXPECT_GT(frames, 10000u);
    EXPECT_GT(pieces, 50000u);
    EXPECT_LT(refused, frames / 3);
}

TEST(Stream, TheBytesAreThoseOfVersion5) {
    // what readers hold of earlier streams is read with the same tables: other bytes for the same
    // content are a new version of the format (docs/stream.md)
    std::uint32_t all = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Options o = some_options(seed);
        if (seed % 3 == 0) o.usual_ticks = 200;
        const Stream stream{o, 1000 + seed, 30, 9};
        all = crc32(stream.all.data(), stream.all.size(), all);
    }
    EXPECT_EQ(all, 2843129188u);
}

TEST(Stream, AWriterRefusesAPieceThatDoesNotFitAtOnce) {
    const RandomStream source{Options{}, 1};
    Writer writer;
    const auto open = [&] {  // a frame with one curve, of the position
        writer.begin_run(source.shape(), source.digest(), 0);
        auto& coder = writer.prepare();
        coder.channel[0].present = coder.channel[0].starts = true;
        coder.channel[0].end_tick = 200;
        wire::FrameHead head;
        head.end = 200 * 64;
        return writer.open(head);
    };
    curve::Piece<1> jump;
    jump.code = curve::code::jump;
    jump.subs = 1;
    ASSERT_TRUE(open());
    std::size_t fit = 0, bits = 0;
    for (std::int32_t v = 40'000'000; !writer.done() && fit < 1000; v = -v) {
        jump.k[0] = fit == 0 ? v / 2 : v;
        if (!writer.piece(jump)) break;
        ++fit;
        bits += 25;  // a k of that size costs more
    }
    EXPECT_GT(fit, 10u);
    EXPECT_LE(bits, 8 * wire::payload_max) << "what does not fit is refused with its piece";
    EXPECT_EQ(writer.close(), 0u);
    ASSERT_TRUE(open());
    jump.k[0] = curve::jump_max;
    EXPECT_TRUE(writer.piece(jump));
    jump.k[0] = curve::vertex_max - curve::jump_max;
    EXPECT_TRUE(writer.piece(jump));
    jump.k[0] = 1;  // beyond the lattice
    EXPECT_FALSE(writer.piece(jump));
    ASSERT_TRUE(open());
    jump.k[0] = 1;
    jump.subs = 65;  // from within a tick to within another
    EXPECT_FALSE(writer.piece(jump));
}

TEST(Stream, AReaderTellsTheToleranceInSteps) {
    RandomStream source{Options{}, 1};
    Reader reader;
    for (const std::uint8_t b : source.header(true)) reader.push(b);
    for (std::uint8_t c = 0; c < 2; ++c)  // 54614 / 32768, as the header says
        EXPECT_FLOAT_EQ(reader.tolerance_steps(c), 1.6666870f);
}

TEST(Stream, AskingChangesNothing) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const Stream stream{some_options(seed), seed, 40};
        Reader reader;
        const Told told = read(reader, stream.all, stream.frames, false);
        EXPECT_EQ(told.frames, stream.frames.size()) << seed;
        EXPECT_EQ(told.wrong, 0u) << seed;
    }
}

TEST(Stream, PiecesJoinAndReachTheStates) {
    // within a track pieces follow each other without a hole and, but for jumps, without a step
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        const Stream stream{some_options(seed), seed, 40};
        Reader reader;
        const Told told = read(reader, stream.all, stream.frames);
        std::map<std::pair<int, int>, wire::CurvePiece> before;
        for (const wire::CurvePiece& p : told.pieces) {
            const auto key = std::make_pair(int{p.channel}, int{p.axis});
            const auto at = [](const wire::CurvePiece& q, double ticks) {
                return q.rotates ? wire::rotation_at(q, ticks)
                                 : BasicQuat<double>{0, q.steps_at(ticks), 0, 0};
            };
            if (p.begins) {
                ASSERT_TRUE(before.count(key) == 0 || before[key].ends) << seed;
            } else {
                ASSERT_EQ(before.count(key), 1u);
                const wire::CurvePiece& q = before[key];
                const bool only_ends = p.start == p.end;  // tells no value
                // a curve that began on the last tick of a frame, and was over with the next
                if (only_ends && q.ends) continue;
                ASSERT_FALSE(q.ends) << seed;
                ASSERT_EQ(q.end, p.start) << seed;
                if (!p.jumps && !only_ends) {
                    const auto a = at(q, q.ticks()), b = at(p, 0.0);
                    const double apart = p.rotates ? rotation_angle(a, b) : std::abs(a.x - b.x);
                    // float anchors; random curves turn many times about theirs
                    const double turns =
                        p.rotates ? 1 + q.scale.step() * (std::abs(q.v[0]) + std::abs(q.v[1]) +
                                                          std::abs(q.v[2]) +
                                                          std::abs(static_cast<double>(q.rise[0])) +
                                                          std::abs(static_cast<double>(q.rise[1])) +
                                                          std::abs(static_cast<double>(q.rise[2])))
                                  : 1;
                    // a jump ends on the lattice, the frame behind it where it was told: on the
                    // grid
                    const double grid = q.jumps && p.rotates ? q.scale.step() : 0;
                    ASSERT_LT(apart, 6e-6 * turns + grid) << seed;
                }
            }
            before[key] = p;
        }
        for (const auto& [key, p] : before) {
            const bool live = (reader.states().live >> key.first & 1u) != 0;
            // a curve that begins on the last tick has no piece yet
            if (live && p.ends && p.end < reader.frame_end()) continue;
            EXPECT_EQ(p.ends, !live);
            EXPECT_TRUE(!live || p.end == reader.frame_end());
            if (!live || p.rotates || p.start == p.end) continue;
            EXPECT_NEAR(p.steps_at(p.ticks()),
                        reader.states().axis[static_cast<std::size_t>(key.second)].v[0], 1e-6);
        }
    }
}

/// The bytes without some frames, in which drop(i) tells whether frame i is lost.
template <class Drop>
ByteVector without(const Stream& stream, Drop drop) {
    ByteVector bytes;
    std::size_t from = 0;
    for (std::size_t i = 0; i < stream.frames.size(); ++i) {
        const Sent& f = stream.frames[i];
        if (!drop(i)) continue;
        bytes.insert(bytes.end(), stream.all.begin() + static_cast<std::ptrdiff_t>(from),
                     stream.all.begin() + static_cast<std::ptrdiff_t>(f.from));
        from = f.from + f.bytes.size();
    }
    bytes.insert(bytes.end(), stream.all.begin() + static_cast<std::ptrdiff_t>(from),
                 stream.all.end());
    return bytes;
}

TEST(Stream, LostFramesCostThoseUntilTheNextRestartAlone) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Options o = some_options(seed);
        o.independent = false;
        o.restart_every = 4;
        o.ends = 0;
        const Stream stream{o, seed, 60};
        for (std::size_t lost = 0; lost < 8; ++lost) {
            Reader reader;
            const ByteVector bytes = without(stream, [&](std::size_t i) { return i == 20 + lost; });
            const Told told = read(reader, bytes, stream.frames);
            EXPECT_EQ(told.wrong, 0u) << seed;
            // frames 21 + lost ... up to the restart frame are of no use
            const std::size_t next = (20 + lost + 1) / 4 * 4 + 3;
            EXPECT_GE(told.frames, stream.frames.size() - (next - (20 + lost)) - 1) << seed;
            EXPECT_EQ(reader.frame_counters().losses, 1u) << seed;
            EXPECT_EQ(reader.frame_counters().joins, 1u) << seed;
        }
    }
}

TEST(Stream, ALostIndependentFrameCostsItselfAlone) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Options o = some_options(seed);
        o.independent = true;
        const Stream stream{o, seed, 60};
        const std::size_t lost = 5 + seed % 40;
        if (lost >= stream.frames.size()) continue;
        Reader reader;
        const Told told =
            read(reader, without(stream, [&](std::size_t i) { return i == lost; }), stream.frames);
        EXPECT_EQ(told.wrong, 0u) << seed;
        EXPECT_EQ(told.frames, stream.frames.size() - 1) << seed;
    }
}

TEST(Stream, ALateReaderJoinsAndBecomesBitEqual) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Options o = some_options(seed);
        o.restart_every = 3;
        o.independent = seed % 2 == 0;
        Stream stream{o, seed, 80};
        Reader reader;  // with a header kept from the start, it joins anywhere
        const ByteVector header = stream.source.header(false);
        ByteVector kept(stream.all.begin(),
                        stream.all.begin() + static_cast<std::ptrdiff_t>(stream.frames[0].from));
        ASSERT_TRUE(reader.adopt(kept.data(), kept.size()));
        const Sent& at = stream.frames[10 + seed % 20];
        const std::size_t from = at.from + seed % at.bytes.size();  // in the middle of a frame
        const ByteVector rest(stream.all.begin() + static_cast<std::ptrdiff_t>(from),
                              stream.all.end());
        const Told told = read(reader, rest, stream.frames);
        EXPECT_EQ(told.wrong, 0u) << seed;
        EXPECT_GT(told.frames, 20u) << seed;
        EXPECT_TRUE(same(stream.frames.back().after, reader.states())) << seed;
        EXPECT_EQ(reader.frame_counters().joins, 1u);
    }
}

TEST(Stream, AReaderFindsItsTimeBehindALongLoss) {
    // time bits of 32 ticks, frames of 60 or 32: so many frames lost are so many tries, and those
    // of 32 end at each count of turns, the carries of the count among them
    for (const bool independent : {false, true})
        for (std::size_t lost = 1; lost < 100; ++lost) {
            const bool turns = lost >= 40;
            Options o;
            o.time_bits = 5;
            o.usual_ticks = turns ? 32 : 60;
            o.restart_every = o.restart_frames = 3;
            o.independent = independent;
            o.ends = o.jumps = 0;
            const std::size_t gone = turns ? lost - 39 : lost;
            const Stream stream{o, lost, turns ? 90 : 60};
            // the restart frames are 2, 5, 8 ...; the reader joins at the next one's end
            const std::size_t next = independent ? 11 + gone : (12 + gone) / 3 * 3 + 2;
            ASSERT_GT(stream.frames.size(), next + 3);
            const std::int64_t ticks = (stream.frames[next].end - stream.frames[11].end) / 64;
            Reader reader;
            const Told told = read(
                reader, without(stream, [&](std::size_t i) { return i >= 12 && i < 12 + gone; }),
                stream.frames);
            EXPECT_EQ(told.wrong, 0u) << lost;
            EXPECT_EQ(told.frames > 12, ticks < 32 * wire::unwraps) << gone << " frames lost";
        }
}

TEST(Stream, TrustComesBackWithDecodedTime) {
    Options o;
    o.sub_ns = 15'625'000;  // a tick a second, a frame a minute
    o.jumps = o.ends = 0;
    o.orientation = false;
    RandomStream source{o, 3};
    Reader reader;
    const auto pass = [&](const ByteVector& bytes) {
        for (const std::uint8_t b : bytes) reader.push(b);
    };
    const auto next = [&] {
        ByteVector frame;
        while (frame.empty()) frame = source.frame(60);
        pass(frame);
        return reader.frame_end() == source.writer().link().end;  // told with its last byte
    };
    const auto lose = [&] {
        pass({1});  // a frame of four bytes whose check does not fit
        while (!next() && !reader.in_step()) continue;
    };
    /// Frames until one is told with its last byte.
    const auto wait = [&] {
        int frames = 1;
        while (!next() && frames < 1000) ++frames;
        return frames;
    };
    pass(source.header(true));
    EXPECT_EQ(wait(), 1);
    const int credit = static_cast<int>(0x1p41 / 60e9) + 1;  // frames whose time gives one
    for (const bool again : {false, true}) {  // four at the start, and four at most later
        for (int credits = 4; credits > 1; --credits) {
            lose();
            EXPECT_EQ(wait(), 1) << again << ": " << credits;
        }
        for (int i = 0; i < 2; ++i) {  // none is left, and then the one that came back
            lose();
            EXPECT_NEAR(wait(), credit, 3);
        }
        for (int i = 0; i < 6 * credit; ++i) next();
    }
}

TEST(Stream, ALateTimeAsksForAThirdCheck) {
    Options o;
    o.time_bits = 7;
    o.restart_every = o.restart_frames = 4;
    o.ends = o.jumps = 0;
    const Stream stream{o, 5, 40};
    for (const std::size_t lost : {2u, 8u}) {  // from frame 9 on: to the restart frame 11, or 19
        std::size_t first = 0;                 // bytes until the reader is in step again
        const std::size_t restart = lost == 2 ? 11 : 19;
        Reader reader;
        const ByteVector bytes =
            without(stream, [&](std::size_t i) { return i >= 9 && i < 9 + lost; });
        for (std::size_t i = 0; i < bytes.size() && first == 0; ++i) {
            reader.push(bytes[i]);
            if (reader.frame_counters().joins > 0) first = i + 1;
        }
        const std::size_t checks = lost == 2 ? 2 : 3;
        std::size_t expected = 0;
        for (std::size_t i = 9; i < 9 + lost; ++i) expected -= stream.frames[i].bytes.size();
        expected +=
            stream.frames[restart + checks].from + stream.frames[restart + checks].bytes.size();
        EXPECT_GE(first, expected) << lost;
        EXPECT_LT(first, expected + 16) << lost;  // the search may lag by a few bytes
    }
}

TEST(Stream, ARingOfExactlyKFramesLostIsNoticed) {
    Options o;
    o.restart_every = 0;
    o.jumps = o.ends = 0;
    o.size = 0;  // rest: frames of the same content
    const Stream stream{o, 1, 1100};
    ASSERT_GT(stream.frames.size(), 1050u);
    std::size_t wrong = 0, accepted = 0;
    for (std::size_t k = 1; k <= 1000; ++k) {
        Reader reader;
        const ByteVector bytes =
            without(stream, [&](std::size_t i) { return i >= 20 && i < 20 + k; });
        const Told told = read(
            reader,
            ByteVector(bytes.begin(),
                       bytes.begin() + std::min<long>(static_cast<long>(bytes.size()),
                                                      static_cast<long>(stream.frames[40].from))),
            stream.frames);
        wrong += told.wrong;
        accepted += told.frames > 20;
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(accepted, 0u) << "no restart frame follows: nothing behind the hole may be believed";
}

TEST(Stream, TwoDevicesOnOneLine) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        Options a = some_options(seed), b = some_options(seed);
        a.stream_id = 1;
        b.stream_id = 2;
        a.size = b.size = 2;
        const Stream one{a, seed, 60}, two{b, seed + 1000, 60};
        ByteVector line = one.head();
        const ByteVector other = two.head();
        line.insert(line.end(), other.begin(), other.end());
        for (std::size_t i = 0; i < std::min(one.frames.size(), two.frames.size()); ++i) {
            line.insert(line.end(), one.frames[i].bytes.begin(), one.frames[i].bytes.end());
            line.insert(line.end(), two.frames[i].bytes.begin(), two.frames[i].bytes.end());
        }
        {
            Reader first{1}, second{2};
            EXPECT_EQ(read(first, line, one.frames).wrong, 0u);
            EXPECT_EQ(read(second, line, two.frames).wrong, 0u);
            EXPECT_GE(first.frame_counters().frames + 3,
                      std::min(one.frames.size(), two.frames.size()));
            EXPECT_GE(second.frame_counters().frames + 3,
                      std::min(one.frames.size(), two.frames.size()));
            EXPECT_GT(first.counters().refused, 0u);
        }
    }
}

}  // namespace
}  // namespace fairlead::test
