#pragma once
// Streams of random pieces of C2 cubics: every way of the format, without a search.
#include <cstdint>
#include <random>
#include <vector>

#include "fairlead/wire/frame_writer.hpp"
#include "tests/unit/header_frame.hpp"

namespace fairlead::test {

/// Frames of random curves of one channel with three axes, one after another.
class CubicStream {
  public:
    using Writer = wire::FrameWriter<3, 0, wire::KindSet<curve::Cubics>>;
    using Bytes = std::vector<std::uint8_t>;

    explicit CubicStream(std::uint64_t seed) : random_{seed} {
        shape_.stream_id = 3;
        shape_.run = 1;
        shape_.base_ns = 1'000;
        shape_.timing = {130208, 13, false, 60};
        shape_.channels = 1;
        auto& c = shape_.channel[0];
        c.type = wire::ChannelType::vector;
        c.kind = curve::Cubics::id;
        c.axes = 3;
        c.tolerance = 24000;
        c.step.fill(curve::Scale::of_step(0.0012f));
        static_cast<void>(layout_.take(shape_));
        wire::Header header{shape_, 0, 0, true};
        header_.resize(wire::header_frame_max);
        header_.resize(wire::write_header(header, header_.data()));
        writer_.begin_run(shape_, header.digest, 0);
    }
    const Bytes& header() const { return header_; }
    const Writer::States& states() const { return writer_.states; }
    unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }

    /// The next frame; empty: its random pieces left the bounds, and it is not sent.
    Bytes frame(bool restart) {
        wire::FrameHead head;
        head.start = writer_.link().end;
        const unsigned ticks = below(8) == 0 ? below(12) : 60 + below(40);
        head.end = head.start + 64 * static_cast<std::int64_t>(ticks);
        head.restart = restart && ticks > 0;
        const Writer::States before = writer_.states;
        auto& coder = writer_.prepare();
        auto& frame = coder.channel[0];
        const bool live = before.live != 0;
        frame.goes_on = below(30) > 0;
        frame.present = true;
        frame.starts = !live;
        frame.start_tick = static_cast<std::uint8_t>(live ? 0 : below(ticks + 1));
        frame.end_tick = static_cast<std::uint8_t>(
            frame.goes_on ? ticks : frame.start_tick + below(ticks + 1 - frame.start_tick));
        for (auto& s : writer_.states.cubic)
            if (frame.starts)
                s = curve::CubicState<1>::begin({static_cast<std::int32_t>(below(4000)) - 2000});
        make_pieces(64 * (frame.end_tick - frame.start_tick), coder);
        bool good = writer_.open(head);
        for (std::size_t i = 0; good && !writer_.done();)
            good = i < pieces_.size() && writer_.piece(pieces_[i++]);
        const std::size_t size = good ? writer_.close() : 0;
        if (size == 0) {
            writer_.states = before;
            return {};
        }
        return {writer_.data(), writer_.data() + size};
    }

  private:
    void make_pieces(std::int32_t length, Writer::Coder& coder) {
        pieces_.clear();
        auto states = writer_.states;
        for (std::size_t a = 0; a < 3; ++a) {
            bool first = true;
            for (std::int32_t left = length; left > 0; first = false) {
                auto& s = states.cubic[a];
                curve::Piece<1> p = random_piece(s, left);
                curve::CubicSpan<1> span;
                if (!curve::step(s, p, span)) {
                    p.code = curve::code::jump;
                    p.subs = static_cast<std::uint16_t>(64 - s.phase);
                    p.k = {};
                    static_cast<void>(curve::step(s, p, span));
                }
                if (first) coder.told.value[a] = p.code == curve::code::jump ? 0 : p.k[0];
                pieces_.push_back(p);
                left -= p.subs;
            }
        }
    }
    std::int32_t around(std::int32_t size) {
        return static_cast<std::int32_t>(below(static_cast<unsigned>(2 * size + 1))) - size;
    }
    curve::Piece<1> random_piece(const curve::CubicState<1>& s, std::int32_t left) {
        curve::Piece<1> p;
        const std::int32_t ticks = left / 64;
        if (s.phase != 0 || below(40) == 0) {
            p.code = curve::code::jump;
            const auto to_tick = static_cast<unsigned>(64 - s.phase);
            p.subs = static_cast<std::uint16_t>(
                below(3) == 0 && to_tick > 1 ? 1 + below(to_tick - 1) : to_tick);
            p.k[0] = around(below(10) == 0 ? 100000 : 50);
            return p;
        }
        std::uint8_t index = 0;
        do index = static_cast<std::uint8_t>(below(17));
        while (index < 16 && curve::lengths[index] > ticks);
        if (s.run == 1 || s.run == 2) index = s.last_code;
        if (s.run == 3 && index == 16) index = 0;
        p.code = s.loose() || (s.run == 0 && below(40) == 0)
                     ? static_cast<std::uint8_t>(index + curve::code::line)
                     : index;
        const std::int32_t h = index == 16 ? ticks : curve::lengths[index];
        p.subs = static_cast<std::uint16_t>(64 * h);
        // close to where the curve is, so that it stays within bounds
        const std::int32_t here = curve::lattice_near(s.at[0]);
        if (s.run > 0)
            p.k[0] = here - curve::predicted_control(s, 0, h) + around(6);
        else
            p.k[0] = below(200) == 0 ? around(2000) : around(3);
        if (h > ticks) {  // a run that does not fit ends in a jump
            p.code = curve::code::jump;
            p.subs = 64;
        }
        return p;
    }

    std::mt19937_64 random_;
    wire::StreamShape shape_{};
    Writer::Layout layout_{};
    Writer writer_{};
    Bytes header_;
    std::vector<curve::Piece<1>> pieces_;
};

}  // namespace fairlead::test
