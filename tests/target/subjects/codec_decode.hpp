#pragma once
// The codec alone, inward, at the end of a line of 16 bytes a record. What an encoder made of the
// records (not counted) waits in the line; every eleventh frame takes damage, so that the search
// for the next one is seen, too: a flipped bit; or a head of the longest frame, which holds back
// all that follows it; or a frame's worth of heads whose frames end together, so that all of them
// are tested at one time.
#include "examples/firmware/config.hpp"
#include "fairlead/reduce/evaluate.hpp"
#include "fairlead/wire/decoder.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "Decoder: 16 bytes of a line, damage among them, to curves";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    static constexpr std::size_t portion = 16;
    using Output = fairlead::Pose;

    fairlead::Decoder decoder{};
    std::array<std::uint8_t, portion> bytes{};
    std::size_t size{0};
    std::uint32_t damage_in{11}, dice{1};
    std::size_t heads{0};  // bytes of false heads that are still to come
    bool fresh{true};

    void prepare(const fairlead::target::Record& in) {
        static std::optional<fairlead::Encoder<32>> encoder;
        static fairlead::Ring<std::uint8_t, 4096> line;
        if (fresh) {
            encoder.emplace(Config::params().encoder);
            line.clear();
        }
        fresh = false;
        const fairlead::Bytes made = encoder->push(in.pose);
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

    std::optional<Output> push(const fairlead::target::Record& in) {
        bool stepped = false;
        for (std::size_t i = 0; i < size; ++i) {
            if (!decoder.push(bytes[i])) continue;
            fairlead::Decoder::Update update;
            while (decoder.next(update)) stepped = true;
        }
        if (!stepped) return std::nullopt;
        const auto& p = decoder.position();
        const auto& q = decoder.orientation();
        const auto at = value_at(p.curve, p.scale, decoder.tick_ns(), p.curve.span.t0_ns);
        return Output{in.pose.t_ns,
                      {at[0], at[1], at[2]},
                      value_at(q.curve, q.scale, decoder.tick_ns(), q.curve.span.t0_ns),
                      decoder.counters().frames};
    }
    std::optional<Output> flush() { return std::nullopt; }

  private:
    static constexpr std::size_t whole = fairlead::wire::max_frame;

    std::uint8_t damaged(std::uint8_t byte, bool damage, std::size_t i, std::size_t frame_size) {
        if (heads > 0) return false_head(heads--);
        const std::size_t bit = (dice >> 8) % (8 * frame_size);
        if (!damage || i < bit / 8) return byte;
        const std::uint32_t kind = (dice >> 24) % 3;
        if (kind == 0) return static_cast<std::uint8_t>(byte ^ (i == bit / 8 ? 1u << bit % 8 : 0u));
        if (kind == 1) return i < bit / 8 + 3 ? false_head(whole + bit / 8 - i) : byte;
        heads = whole - 1;
        return false_head(whole);
    }

    /// A byte of the heads of restart frames, one every three bytes, which all end with the last.
    static std::uint8_t false_head(std::size_t left) {
        const std::size_t at = (whole - left) % 3, payload = left + at - 4;
        if (at == 2 || left < 5) return fairlead::wire::version;
        return static_cast<std::uint8_t>(at == 0 ? 0xC0 | payload >> 8 : payload & 255);
    }
};
