#pragma once
// Streams of random pieces: every way of the format, without a reducer. The writer keeps what it
// wrote, so that tests can compare it with what a reader tells.
#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "fairlead/wire/decoder.hpp"
#include "fairlead/wire/frame_writer.hpp"
#include "tests/unit/header_frame.hpp"

namespace fairlead::test {

using Kinds = wire::KindSet<curve::Smooth>;
using Writer = wire::FrameWriter<3, 1, Kinds>;
using Reader = wire::Decoder<3, 1, Kinds>;
using ByteVector = std::vector<std::uint8_t>;

struct Options {
    std::uint16_t stream_id{7}, run{1};
    std::int64_t base_ns{1'000'000'000};
    std::uint32_t sub_ns{130208};
    std::uint32_t usual_ticks{60};
    std::uint8_t time_bits{13}, kind{1};
    bool independent{false};
    unsigned restart_every{4};   // frames; 0: never
    unsigned restart_frames{4};  // likewise, as the header tells it
    double jumps{0.02}, ends{0.02};
    int size{2};  // of k
    bool position{true}, orientation{true};
};

/// Frames of random curves, one after another.
class RandomStream {
  public:
    RandomStream(const Options& options, std::uint64_t seed) : options_{options}, random_{seed} {
        shape_.stream_id = options.stream_id;
        shape_.run = options.run;
        shape_.base_ns = options.base_ns;
        shape_.timing = {options.sub_ns, options.time_bits, options.independent,
                         static_cast<std::uint8_t>(options.usual_ticks),
                         static_cast<std::uint8_t>(options.restart_frames)};
        if (options.position) add_channel(wire::ChannelType::vector, 0.0012f);
        if (options.orientation) add_channel(wire::ChannelType::orientation, 0.0039f);
        begin_run(0);
    }

    void begin_run(std::int64_t end) {
        wire::Header header{shape_, 0, end, true};
        digest_of(header);
        digest_ = header.digest;
        writer_.begin_run(shape_, header.digest, end);
        frame_ = 0;
    }
    /// A header frame: starts only before the first frame.
    ByteVector header(bool starts) {
        wire::Header header{shape_, 0, writer_.link().end, starts};
        return digest_of(header);
    }

    /// The next data frame. ticks: its length; 0: about the usual one.
    ByteVector frame(unsigned ticks = 0) {
        ++frame_;
        wire::FrameHead head;
        head.start = writer_.link().end;
        if (writer_.states.live == 0 && chance(0.3)) {  // a gap of all channels
            head.start += 64 * below(3000);
            if (chance(0.5)) head.start += below(64);
        }
        if (ticks == 0) {
            ticks = options_.usual_ticks;
            if (chance(0.1)) ticks = below(unsigned{curve::piece_ticks_max} + 1);
        }
        head.end = head.start + 64 * static_cast<std::int64_t>(ticks);
        head.restart = options_.independent ||
                       (options_.restart_every > 0 && frame_ % options_.restart_every == 0);
        const Writer::States before = writer_.states;
        auto& coder = writer_.prepare();
        plan(coder, ticks, head.restart);
        // pieces are made on a copy of the states, because a restart tells their end before them
        make_pieces(coder, head);
        if (!writer_.open(head)) return refuse(before);
        std::size_t i = 0, j = 0;
        while (!writer_.done()) {
            const bool good =
                writer_.rotates() ? writer_.piece(turns_[i++]) : writer_.piece(axes_[j++]);
            if (!good) return refuse(before);
        }
        const std::size_t size = writer_.close();
        if (size == 0) return refuse(before);
        return {writer_.data(), writer_.data() + size};
    }
    std::uint32_t digest() const { return digest_; }
    const Writer& writer() const { return writer_; }
    const wire::StreamShape& shape() const { return shape_; }
    std::size_t refused() const { return refused_; }
    template <class Int>
    Int below(Int n) {
        return static_cast<Int>(random_() % static_cast<std::uint64_t>(n));
    }
    bool chance(double p) { return static_cast<double>(random_() >> 11) * 0x1p-53 < p; }

  private:
    void add_channel(wire::ChannelType type, float step) {
        auto& c = shape_.channel[shape_.channels];
        c.type = type;
        c.kind = options_.kind;
        c.axes = 3;
        c.tolerance = 54614;
        const curve::Scale scale = curve::Scale::of_step(step);
        c.step.fill(scale);
        if (type == wire::ChannelType::vector)
            c.origin = {100, -2000, 3000};
        else
            wire::put_origin(c, curve::to_grid(normalised(Quat{1, 0.1f, -0.5f, 0.3f}),
                                               scale.template step<float>()));
        ++shape_.channels;
        static_cast<void>(layout_.take(shape_));
    }
    static ByteVector digest_of(wire::Header& header) {
        ByteVector bytes(wire::header_frame_max);
        bytes.resize(wire::write_header(header, bytes.data()));
        return bytes;
    }
    /// Too large for a frame, or out of bounds: the frame is not sent, and made anew.
    ByteVector refuse(const Writer::States& before) {
        ++refused_;
        --frame_;
        writer_.states = before;
        return {};
    }

    void plan(Writer::Coder& coder, unsigned ticks, bool restart) {
        for (std::size_t c = 0; c < layout_.channels; ++c) {
            auto& frame = coder.channel[c];
            const bool was_live = (writer_.states.live >> c & 1u) != 0;
            frame.over = was_live && chance(0.03);
            const bool live = was_live && !frame.over;
            frame.goes_on = live ? !chance(options_.ends) : !chance(0.2);
            frame.present = live || frame.goes_on || chance(0.2);
            frame.starts = !live && frame.present;
            if (!frame.present) continue;
            frame.start_tick = static_cast<std::uint8_t>(live ? 0 : below(ticks + 1));
            frame.end_tick = static_cast<std::uint8_t>(ticks);
            if (!frame.goes_on)
                frame.end_tick = static_cast<std::uint8_t>(frame.start_tick +
                                                           below(ticks + 1 - frame.start_tick));
            if (ticks == 0 && live && restart &&
                frame.goes_on) {  // a rotation needs a piece to land
                frame.goes_on = false;
                frame.end_tick = 0;
            }
            if (frame.starts) start(c);
        }
    }
    void start(std::size_t c) {
        if (layout_.channel[c].rotates) {
            Quat q{1, unit(), unit(), unit()};
            writer_.first.grid[0] = curve::to_grid(normalised(q), layout_.step(0));
            if (chance(0.5)) {  // near the origin
                writer_.first.grid[0] = layout_.turn_origin[0];
                writer_.first.grid[0].n[1] =
                    static_cast<std::int16_t>(writer_.first.grid[0].n[1] + below(41) - 20);
            }
            writer_.states.rotation[0] = {curve::from_grid(writer_.first.grid[0], layout_.step(0)),
                                          {}};
        } else {
            const bool at_origin = chance(0.2);
            for (std::size_t i = 0; i < 3; ++i) {
                writer_.states.axis[i] = {};
                writer_.states.axis[i].v[0] =
                    at_origin ? layout_.origin[i] : static_cast<std::int32_t>(unit() * 3000);
            }
        }
    }
    float unit() { return static_cast<float>(random_() >> 40) * 0x1p-23f - 1.0f; }

    template <std::size_t N>
    curve::Piece<N> random_piece(const curve::State<N>& state, std::int32_t left, bool rebase) {
        curve::Piece<N> p;
        const std::int32_t ticks = left / 64;
        if (state.phase != 0 || ticks == 0 || chance(options_.jumps)) {
            p.code = curve::code::jump;
            const std::int32_t to_tick = 64 - state.phase;
            std::int32_t subs = to_tick;
            if (chance(0.3) && to_tick > 1) subs = 1 + below(to_tick - 1);
            if (chance(0.2) && left >= to_tick + 64)
                subs = to_tick + 64 * (1 + static_cast<std::int32_t>(
                                               below(std::min((left - to_tick) / 64, 64))));
            p.subs = static_cast<std::uint16_t>(std::min(subs, left));
            for (auto& k : p.k) k = static_cast<std::int32_t>(unit() * 2000);
            return p;
        }
        if (rebase && chance(0.05)) {
            p.code = curve::code::rebase;
            return p;
        }
        p.code = static_cast<std::uint8_t>(below(17));
        while (p.code < 16 && curve::lengths[p.code] > ticks)
            p.code = static_cast<std::uint8_t>(below(17));
        p.subs = static_cast<std::uint16_t>(p.code == 16 ? left : 64 * curve::lengths[p.code]);
        if (state.loose() || (options_.kind == 2 && chance(0.4)))
            p.code = static_cast<std::uint8_t>(p.code + curve::code::line);
        for (auto& k : p.k) {
            k = static_cast<std::int32_t>(
                    below(static_cast<std::uint32_t>(2 * options_.size + 1))) -
                options_.size;
            if (chance(0.005)) k = static_cast<std::int32_t>(unit() * 400);
        }
        return p;
    }

    void make_pieces(Writer::Coder& coder, const wire::FrameHead& head) {
        Writer::States states = writer_.states;
        axes_.clear();
        turns_.clear();
        for (std::size_t c = 0; c < layout_.channels; ++c) {
            const auto& frame = coder.channel[c];
            if (!frame.present) continue;
            const std::int32_t length = 64 * (frame.end_tick - frame.start_tick);
            if (layout_.channel[c].rotates) {
                curve::RotationState& state = states.rotation[0];
                bool rebased = false;
                for (std::int32_t left = length; left > 0;) {
                    auto p = random_piece(state.chart, left, !rebased);
                    rebased = p.code == curve::code::rebase;
                    if (rebased)
                        curve::rebase(state, layout_.step(0));
                    else if (!curve::step(state.chart, p)) {
                        tame(p);
                        static_cast<void>(curve::step(state.chart, p));
                    }
                    turns_.push_back(p);
                    left -= rebased ? 0 : p.subs;
                }
                curve::rebase(state, layout_.step(0));
                coder.told.grid[0] = length == 0 ? writer_.first.grid[0]
                                                 : curve::to_grid(state.anchor, layout_.step(0));
                if (options_.independent)
                    writer_.first.grid[0] = frame.starts ? writer_.first.grid[0] : grid_;
                grid_ = coder.told.grid[0];
                continue;
            }
            for (std::size_t a = 0; a < 3; ++a) {
                auto& state = states.axis[a];
                for (std::int32_t left = length; left > 0;) {
                    auto p = random_piece(state, left, false);
                    if (!curve::step(state, p)) {
                        tame(p);
                        static_cast<void>(curve::step(state, p));
                    }
                    axes_.push_back(p);
                    left -= p.subs;
                }
                coder.told.value[a] = state.v[0];
            }
        }
        static_cast<void>(head);
    }
    /// A slope that grew too large ends in a jump.
    template <std::size_t N>
    static void tame(curve::Piece<N>& p) {
        p.code = curve::code::jump;
        p.subs = std::min<std::uint16_t>(p.subs, 64);
        p.k = {};
    }

    Options options_;
    std::mt19937_64 random_;
    wire::StreamShape shape_{};
    Writer::Layout layout_{};
    Writer writer_{};
    std::vector<curve::Piece<1>> axes_;
    std::vector<curve::Piece<3>> turns_;
    curve::GridQuat grid_{};
    unsigned frame_{0};
    std::uint32_t digest_{0};
    std::size_t refused_{0};
};

}  // namespace fairlead::test
