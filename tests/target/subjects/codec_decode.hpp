#pragma once
// The codec alone, inward: the bytes that a push of an encoder completed (not counted), every
// eleventh time with a flipped bit somewhere, so that the search for the next frame is seen, too.
#include "examples/firmware/config.hpp"
#include "fairlead/reduce/evaluate.hpp"
#include "fairlead/wire/decoder.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text =
        "Decoder: the bytes of a push, damage among them, to curves";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    using Output = fairlead::Pose;

    fairlead::Decoder decoder{};
    fairlead::Bytes bytes{};
    std::uint32_t damage_in{11}, dice{1};
    bool fresh{true};

    void prepare(const fairlead::target::Record& in) {
        static std::optional<fairlead::Encoder<32>> encoder;
        static std::array<std::uint8_t, 2048> copy;
        if (fresh) encoder.emplace(Config::params().encoder);
        fresh = false;
        bytes = encoder->push(in.pose);
        if (bytes.empty()) return;
        for (std::size_t i = 0; i < bytes.size; ++i) copy[i] = bytes.data[i];
        bytes.data = copy.data();
        dice = dice * 1664525 + 1013904223;
        if (--damage_in > 0) return;
        damage_in = 11;
        const std::uint32_t bit = (dice >> 8) % static_cast<std::uint32_t>(8 * bytes.size);
        copy[bit / 8] = static_cast<std::uint8_t>(copy[bit / 8] ^ (1u << bit % 8));
    }

    std::optional<Output> push(const fairlead::target::Record& in) {
        bool stepped = false;
        for (std::size_t i = 0; i < bytes.size; ++i) {
            for (bool frame = decoder.push(bytes.data[i]); frame; frame = decoder.more()) {
                fairlead::Decoder::Update update;
                while (decoder.next(update)) stepped = true;
            }
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
};
