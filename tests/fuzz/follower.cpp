// The gateway's follower on streams whose checks are right and whose payloads are not: a board's
// stream is made, bytes of its payloads are changed, and every check is computed anew. Held:
// counters and spans stay in order and finite, what a page holds comes back as it was, and work is
// bounded.
#include "examples/gateway/follower.hpp"

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "fairlead/pipeline.hpp"
#include "fairlead/wire/header.hpp"
#include "tests/fuzz/input.hpp"

using namespace fairlead;

namespace {

struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, fairlead::Orientation>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 20;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = 2;
};
using Octets = std::vector<std::uint8_t>;

struct DataFrame {
    std::size_t at, size;
    bool restart;
    std::int64_t end;  // in sub-ticks
};
struct Stream {
    Octets bytes;
    std::vector<DataFrame> frames;
};

/// Walks the frames of a clean stream.
template <class Visit>
void each_frame(const Octets& bytes, std::size_t from, const Visit& visit) {
    for (std::size_t at = from; at + 1 < bytes.size();) {
        const std::size_t size = wire::frame_size(bytes[at], bytes[at + 1]);
        FUZZ_EXPECT(size > 0 && at + size <= bytes.size());
        visit(at, size);
        at += size;
    }
}

/// What a board sends for a second; its restarts come often.
Stream stream_of(unsigned seed) {
    Pipeline<Board>::Params params;
    params.sample_period_ns = 10'000'000;
    params.restart_interval_ns = 300'000'000;
    params.header_interval_ns = 1'000'000'000;
    const auto board = std::make_unique<Pipeline<Board>>(params);
    Stream all;
    std::uint32_t restarts = 0;
    const auto add = [&](const Bytes& bytes) {
        const std::size_t from = all.bytes.size();
        all.bytes.insert(all.bytes.end(), bytes.begin(), bytes.end());
        const bool restart = board->encoder().inner().restarts() != restarts;
        restarts = board->encoder().inner().restarts();
        each_frame(all.bytes, from, [&](std::size_t at, std::size_t size) {
            if (all.bytes[at] <= wire::payload_max) all.frames.push_back({at, size, restart, 0});
        });
        return bytes.status != Status::end;
    };
    Pose pose;
    std::minstd_rand random{seed + 1};
    std::uniform_real_distribution<float> even{-0.02f, 0.02f};
    Vec3 speed{};
    for (int i = 0; i < 100; ++i) {
        pose.t_ns += 10'000'000;
        if (i % 25 == 0) speed = {even(random), even(random), even(random)};
        pose.p_w_m = pose.p_w_m + speed;
        pose.q_wb = pose.q_wb * from_rotation_vector(speed);
        pose.flags = flag::position_valid | flag::orientation_valid;
        if (seed % 2 == 1 && i % 50 > 35) pose.p_w_m.x += even(random) * 100;  // jumps
        if (i % 40 == 30) board->push_event({pose.t_ns, 1, static_cast<std::uint16_t>(i), 0});
        add(board->push(pose));
    }
    while (add(board->flush())) continue;
    // the ends of the data frames, as a decoder of its own finds them
    wire::Decoder<3, 1> decoder;
    std::size_t known = 0;
    const auto note = [&] {
        if (decoder.frame_counters().frames > known) all.frames[known++].end = decoder.frame_end();
    };
    for (const std::uint8_t byte : all.bytes)
        if (decoder.push(byte)) note();
    while (decoder.finish()) note();
    FUZZ_EXPECT(known == all.frames.size());
    return all;
}

/// Changes payloads of data frames and puts their checks right, along the chain.
Octets spoiled(const Stream& stream, fuzz::Input& in) {
    Octets bytes = stream.bytes;
    wire::Header header;
    read_header(bytes.data(), wire::frame_size(bytes[0], bytes[1]), header);
    wire::Link link{header.end, 0, 0};
    for (const DataFrame& frame : stream.frames) {
        std::uint8_t* const first = bytes.data() + frame.at;
        if (in.byte() % 4 == 0)
            for (int n = 1 + in.byte() % 3; n > 0; --n)
                first[1 + in.byte() % (frame.size - 3)] ^= in.byte();
        std::uint16_t check = wire::seed(header.digest, link);
        for (std::size_t i = 0; i + 2 < frame.size; ++i) check = crc16(first[i], check);
        first[frame.size - 2] = static_cast<std::uint8_t>(check >> 8);
        first[frame.size - 1] = static_cast<std::uint8_t>(check & 0xFF);
        link.previous = wire::digest_of(first, frame.size, frame.restart, header.digest, link);
        link.end = frame.end;
    }
    return bytes;
}

void check_spans(gateway::UnitFeed& feed, const gateway::UnitState& state) {
    gateway::SpanItem item;
    std::int64_t end_ns[2] = {INT64_MIN, INT64_MIN};
    while (feed.spans.pop(item)) {
        if (item.kind == gateway::SpanKind::restart) {
            end_ns[0] = end_ns[1] = INT64_MIN;
            continue;
        }
        const port::CurveSpan& span = item.span;
        auto& last = end_ns[static_cast<std::size_t>(span.channel)];
        FUZZ_EXPECT(span.t0_ns >= last || last == INT64_MIN);
        FUZZ_EXPECT(span.begins || span.t0_ns == last);
        last = span.t1_ns();
        for (const Vec3& power : span.power) FUZZ_EXPECT(is_finite(power));
        FUZZ_EXPECT(std::abs(dot(span.anchor, span.anchor) - 1) < 1e-3f);
        std::array<std::uint16_t, port::registers::span_size> page{};
        port::registers::put_span(page.data(), span);
        const auto back = port::registers::get_span(page.data(), span.channel, span.sub_ns);
        FUZZ_EXPECT(back.t0_ns == span.t0_ns && back.cover == span.cover);
        FUZZ_EXPECT(std::memcmp(&back.power, &span.power, sizeof span.power) == 0);
        FUZZ_EXPECT(is_finite(port::curve::rate_rad_s(span, span.t1_ns())));
    }
    FUZZ_EXPECT(is_finite(state.p_w_m) && is_finite(state.v_w_m_s) && is_finite(state.rate_rad_s));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in{data, size};
    static const std::array<Stream, 4> streams{stream_of(0), stream_of(1), stream_of(2),
                                               stream_of(3)};
    const Octets bytes = spoiled(streams[in.byte() % streams.size()], in);
    gateway::UnitState state;
    state.epoch = 1;
    const auto feed = std::make_unique<gateway::UnitFeed>();
    const auto follower = std::make_unique<gateway::CurveFollower>(
        *feed, state, gateway::CurveFollower::WhenFull::drop);
    for (std::size_t at = 0; at < bytes.size(); at += 64) {
        const std::size_t n = std::min<std::size_t>(64, bytes.size() - at);
        if (follower->take(bytes.data() + at, n)) follower->evaluate();
    }
    follower->finish();
    follower->evaluate();
    FUZZ_EXPECT(state.bytes_skipped <= state.bytes);
    FUZZ_EXPECT(state.spans_dropped == 0);
    check_spans(*feed, state);
    return 0;
}
