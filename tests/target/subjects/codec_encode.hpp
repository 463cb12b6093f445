#pragma once
// The codec alone, outward: what the reducers made final (not counted) becomes the bits of a frame.
#include "examples/firmware/config.hpp"
#include "fairlead/wire/crc.hpp"
#include "tests/target/reduce_stage.hpp"

struct Subject {
    static constexpr const char* text = "codec, outward: both channels' knots into one frame";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;

    using Position = fairlead::target::VectorReduceStage<32>;
    using Orientation = fairlead::target::OrientationReduceStage<32>;
    template <class Channel, class Reduction>
    struct Way {
        fairlead::wire::Link<Channel> link{};
        typename Reduction::Frozen batch{};
    };
    struct Output {
        const std::uint8_t* data;
        std::size_t size;
    };

    Way<fairlead::VectorChannel<3>, Position::Reduction> position{};
    Way<fairlead::OrientationChannel, Orientation::Reduction> orientation{};
    fairlead::wire::Header header{0, 4000000, 0};
    std::array<std::uint8_t, fairlead::wire::max_frame> frame{};
    bool fresh{true};

    void prepare(const fairlead::target::Record& in) {
        static std::optional<Position> p;
        static std::optional<Orientation> q;
        if (fresh) {
            p.emplace();
            q.emplace();
            position.link.scale = p->reducer.scale();
            orientation.link.scale = q->reducer.scale();
            header.base_ns = in.pose.t_ns;
            fresh = false;
        }
        position.batch = {};
        orientation.batch = {};
        if (const auto out = p->push(in)) position.batch = out->batch;
        if (const auto out = q->push(in)) orientation.batch = out->batch;
    }

    std::optional<Output> push(const fairlead::target::Record&) {
        if (!says_something(position.batch) && !says_something(orientation.batch))
            return std::nullopt;
        fairlead::BitWriter io{frame.data(), fairlead::wire::max_payload};
        if (header.sequence % 32 == 0) {  // a restart point
            fairlead::wire::header(io, header);
            fairlead::wire::state(io, position.link, header.base_ns, header.tick_ns);
            fairlead::wire::state(io, orientation.link, header.base_ns, header.tick_ns);
        }
        put(io, position);
        put(io, orientation);
        const std::size_t size = io.size();
        const std::uint16_t crc = fairlead::crc16(frame.data(), size, header.sequence & 0xFFFF);
        ++header.sequence;
        frame[size] = static_cast<std::uint8_t>(crc >> 8);
        frame[size + 1] = static_cast<std::uint8_t>(crc & 0xFF);
        return Output{frame.data(), size + 2};
    }
    std::optional<Output> flush() { return std::nullopt; }

  private:
    template <class Batch>
    static bool says_something(const Batch& batch) {
        return batch.begins || batch.size > 0 || batch.covers;
    }
    template <class Channel, class Reduction>
    void put(fairlead::BitWriter& io, Way<Channel, Reduction>& way) {
        fairlead::wire::content(io, way.link, way.batch, header.base_ns, header.tick_ns);
        fairlead::wire::follow_start(way.link, way.batch);
        for (std::size_t i = 0; i < way.batch.size; ++i)
            fairlead::wire::follow_knot(way.link, way.batch, i, header.tick_ns);
        if (way.batch.covers) way.link.cover_ticks = way.batch.cover_ticks;
    }
};

inline void mix(fairlead::target::Digest& d, const Subject::Output& out) {
    fairlead::target::mix_bytes(d, out.data, out.size);
}
