#pragma once
// The decoder, at the end of a line of 16 bytes a record. What an encoder made of the records (not
// counted) waits in the line; every eleventh push of bytes takes damage, so that the search for the
// next good frame is seen, too: a flipped bit; or a head of the longest frame, which holds back all
// that follows it; or a frame's worth of heads whose frames end together, so that all of them are
// tested at one time.
#include "fairlead/wire/decoder.hpp"
#include "tests/target/encoder_stage.hpp"

struct Subject {
    static constexpr const char* text = "Decoder: 16 bytes of a line, damage among them, to curves";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = true;
    static constexpr std::size_t portion = 16;
    struct Output {
        std::array<float, 4> value;  // of the newest pieces, at their ends
        std::uint32_t frames, breaks;
        std::int64_t end;
    };
    using Source =
        fairlead::target::EncoderStage<fairlead::target::Both, 32, fairlead::Beam::narrow>;

    fairlead::wire::Decoder<3, 1> decoder{};
    std::array<std::uint8_t, portion> bytes{};
    std::size_t size{0};
    std::uint32_t damage_in{11}, dice{1};
    std::size_t heads{0};  // bytes of false heads that are still to come
    bool fresh{true};

    void prepare(const fairlead::target::Record& in) {
        static std::optional<Source> source;
        static fairlead::Ring<std::uint8_t, 4096> line;
        if (fresh) {
            source.emplace();
            line.clear();
        }
        fresh = false;
        source->prepare(in);
        const auto pushed = source->push(in);
        const fairlead::Bytes made = pushed ? *pushed : fairlead::Bytes{};
        if (made.size > 0) dice = dice * 1664525 + 1013904223;
        const bool damage = made.size > 0 && --damage_in == 0;
        if (damage) damage_in = 11;
        for (std::size_t i = 0; i < made.size && !line.full(); ++i)
            line.push(damaged(made.data[i], damage, i, made.size));
        for (size = 0; size < portion && !line.empty(); ++size) {
            bytes[size] = line.oldest();
            line.pop();
        }
    }

    std::optional<Output> push(const fairlead::target::Record&) {
        bool stepped = false;
        Output out{};
        fairlead::wire::CurvePiece piece;
        for (std::size_t i = 0; i < size; ++i) {
            if (!decoder.push(bytes[i])) continue;
            while (decoder.next(piece)) {
                stepped = true;
                tell(piece, out);
            }
        }
        if (!stepped) return std::nullopt;
        out.frames = decoder.frame_counters().frames;
        out.breaks = decoder.counters().breaks;
        return out;
    }
    std::optional<Output> flush() { return std::nullopt; }

  private:
    static constexpr std::size_t whole = fairlead::wire::data_frame_max;

    static void tell(const fairlead::wire::CurvePiece& piece, Output& out) {
        const auto ticks = piece.ticks<float>();
        if (piece.rotates) {
            const fairlead::Quat q = fairlead::wire::rotation_at(piece, ticks);
            out.value = {q.w, q.x, q.y, q.z};
        } else {
            out.value[piece.axis % 4] += piece.steps_at(ticks);
        }
        out.end = piece.end;
    }

    std::uint8_t damaged(std::uint8_t byte, bool damage, std::size_t i, std::size_t frame_size) {
        if (heads > 0) return false_head(heads--);
        const std::size_t bit = (dice >> 8) % (8 * frame_size);
        if (!damage || i < bit / 8) return byte;
        const std::uint32_t kind = (dice >> 24) % 3;
        if (kind == 0) return static_cast<std::uint8_t>(byte ^ (i == bit / 8 ? 1u << bit % 8 : 0u));
        if (kind == 1) return i < bit / 8 + 3 ? false_head(whole) : byte;
        heads = whole - 1;
        return false_head(whole);
    }

    /// A byte that is the head of a data frame, and ends `left` bytes further on: size, payload and
    /// two bytes of check.
    static std::uint8_t false_head(std::size_t left) {
        return left < 4 ? std::uint8_t{1} : static_cast<std::uint8_t>(left - 3);
    }
};

inline void mix(fairlead::target::Digest& d, const Subject::Output& out) {
    using fairlead::target::mix;
    for (const float x : out.value) mix(d, x);
    mix(d, out.frames);
    mix(d, out.breaks);
    mix(d, out.end);
}
