#pragma once
// A reducer by itself, driven as the encoder drives it. What it gives: the curve after each step.
#include "fairlead/reduce/channel.hpp"
#include "fairlead/reduce/reducer.hpp"
#include "fairlead/wire/encoder.hpp"
#include "tests/target/subject.hpp"

namespace fairlead::target {

/// Curve, counters and what became final, of the last advance of a push.
template <class Reduction>
struct Reduced {
    typename Reduction::Frozen batch{};
    std::uint32_t knots{}, curves{}, breaks{}, refused{};
};

template <class Reduction>
void mix(Digest& d, const Reduced<Reduction>& out) noexcept {
    mix(d, out.batch.start.span.t0_ns);
    for (const auto& row : out.batch.start.span.c)
        for (const std::int32_t c : row) mix(d, static_cast<std::uint32_t>(c));
    for (std::size_t i = 0; i < out.batch.size; ++i) {
        mix(d, out.batch.knot[i].ticks);
        for (const std::int32_t j : out.batch.knot[i].jump) mix(d, static_cast<std::uint32_t>(j));
    }
    for (const std::uint32_t n :
         {out.batch.cover_ticks, out.knots, out.curves, out.breaks, out.refused})
        mix(d, n);
}

template <class Channel, std::size_t N, Credit Slice = slice_medium>
struct ReduceStage {
    static constexpr unsigned latency = N;  // at most: delay_max
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    using Reduction = Reducer<Channel, N>;
    using Output = Reduced<Reduction>;
    Reduction reducer;

    explicit ReduceStage(const typename Channel::Tolerance& tol)
        : reducer{{tol, 4000000, N, N / 2}} {}

    template <class Value>
    std::optional<Output> push(const Pose& pose, bool valid, bool gap, const Value& value) {
        if (valid)
            reducer.push(pose.t_ns, value, gap);
        else
            reducer.skip();
        reducer.allot(Slice, reducer.closing());
        std::optional<Output> out;
        constexpr int takes_max = 2;  // as many as the encoder makes frames
        for (int i = 0; i < takes_max && reducer.due(); ++i) out = taken(i + 1 == takes_max);
        reducer.work();
        return out;
    }
    std::optional<Output> flush() {
        if (reducer.empty()) return std::nullopt;
        reducer.close(Slice);
        return taken(false);
    }

  private:
    Output taken(bool last) {
        const auto& counters = reducer.counters();
        return {reducer.take(last), counters.knots, counters.curves, counters.breaks,
                counters.refused};
    }
};

template <std::size_t N>
struct VectorReduceStage : ReduceStage<VectorChannel<3>, N> {
    VectorReduceStage() : ReduceStage<VectorChannel<3>, N>{{0.002f, 0.002f, 0.002f}} {}
    auto push(const Record& in) {
        const Pose& p = in.pose;
        return ReduceStage<VectorChannel<3>, N>::push(
            p, (p.flags & flag::position_valid) != 0,
            (p.flags & (flag::gap_before | flag::position_gap)) != 0,
            std::array<float, 3>{p.p_w_m.x, p.p_w_m.y, p.p_w_m.z});
    }
};

template <std::size_t N>
struct OrientationReduceStage : ReduceStage<OrientationChannel, N> {
    OrientationReduceStage() : ReduceStage<OrientationChannel, N>{0.0087266f} {}
    auto push(const Record& in) {
        const Pose& p = in.pose;
        return ReduceStage<OrientationChannel, N>::push(
            p, (p.flags & flag::orientation_valid) != 0,
            (p.flags & (flag::gap_before | flag::orientation_gap)) != 0, p.q_wb);
    }
};

}  // namespace fairlead::target
