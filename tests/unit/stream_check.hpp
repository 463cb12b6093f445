#pragma once
// Encoder -> bytes -> decoder, checked from the bytes in double: each accepted sample is covered,
// within its tolerance, by bytes that left at most delay_records pushes later.
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fairlead/wire/decoder.hpp"
#include "fairlead/wire/encoder.hpp"

namespace fairlead::test {

/// Error over tolerance of one sample of a channel, in double.
template <std::size_t D, class Piece, class Tolerance>
double error_of(const std::array<float, D>& value, const std::vector<const Piece*>& at,
                const std::vector<double>& ticks, const Tolerance& tolerance) {
    double worst = 0;
    for (std::size_t a = 0; a < D; ++a) {
        const double v = at[a]->steps_at(ticks[a]) * at[a]->scale.step();
        worst = std::max(
            worst, std::abs(v - static_cast<double>(value[a])) / static_cast<double>(tolerance[a]));
    }
    return worst;
}
template <class Piece, class Tolerance>
double error_of(const Quat& value, const std::vector<const Piece*>& at,
                const std::vector<double>& ticks, const Tolerance& tolerance) {
    const BasicQuat<double> q = normalised(BasicQuat<double>{value.w, value.x, value.y, value.z});
    return rotation_angle(normalised(wire::rotation_at(*at[0], ticks[0])), q) /
           static_cast<double>(tolerance[0]);
}

template <class Encoder, class Decoder>
class StreamCheck {
  public:
    using Values = typename Encoder::Values;
    using Piece = typename Decoder::Piece;
    static constexpr std::size_t channels = Encoder::channel_count;

    explicit StreamCheck(const typename Encoder::Params& params)
        : params_{params}, encoder{params} {}

    std::size_t accepted{0}, violations{0}, late{0}, uncovered{0}, pieces{0}, breaks{0}, refused{0};
    double worst{0};  // error over tolerance
    std::vector<std::uint8_t> bytes;
    std::string first_fault;

    void push(std::int64_t t_ns, const Values& values, std::uint32_t valid, std::uint32_t gaps = 0,
              bool new_run = false) {
        const Bytes out = encoder.push(t_ns, values, valid, gaps, new_run);
        if (out.status == Status::refused) {
            ++refused;
        } else {
            ++pushes_;
            held_ = Waiting{0, pushes_, t_ns, values};
            held_valid_ = valid;
        }
        take(out);
        settle();
        for (auto& queue : waiting_) {
            if (queue.empty() || queue.front().push + params_.delay_records > pushes_) continue;
            if (late++ == 0) note("late", queue.front());
        }
    }
    void flush() {
        let_out();
        settle();
    }
    void finish() {
        let_out();
        while (decoder.finish()) drain();
        settle();
        for (auto& queue : waiting_) {
            if (!queue.empty()) note("uncovered", queue.front());
            uncovered += queue.size();
            queue.clear();
        }
    }
    bool good() const {
        return violations == 0 && late == 0 && uncovered == 0 && encoder.overflows() == 0 &&
               encoder.check_failures() == 0 && decoder.frame_counters().losses == 0 &&
               decoder.counters().nonsense == 0;
    }

  private:
    struct Waiting {
        std::uint32_t run;
        std::size_t push;
        std::int64_t t_ns;
        Values values;
    };
    struct Told {
        std::uint32_t run;
        std::int64_t start_ns, end_ns;
        double tick_ns;
        Piece piece;
    };

    typename Encoder::Params params_;

  public:
    Encoder encoder;
    Decoder decoder{};

  private:
    void let_out() {
        for (int calls = 0; calls < 1000; ++calls) {
            const Bytes out = encoder.flush();
            take(out);
            if (out.status == Status::end) return;
        }
        if (late++ == 0) first_fault = "flush() never ends";
    }
    /// A record that the encoder took; one that waits until a frame has left belongs to the run
    /// that it begins.
    void admit() {
        if (!held_ || encoder.busy()) return;
        if (held_->push == 1 || encoder.run() != last_run_) ++run_;
        last_run_ = encoder.run();
        held_->run = run_;
        for (std::size_t c = 0; c < channels; ++c)
            if (held_valid_ >> c & 1u) waiting_[c].push_back(*held_), ++accepted;
        held_.reset();
    }
    void take(const Bytes& out) {
        admit();
        for (const std::uint8_t b : out) {
            bytes.push_back(b);
            if (decoder.push(b)) drain();
        }
    }
    void drain() {
        Piece p;
        const curve::Grid& grid = decoder.grid();
        while (decoder.next(p)) {
            ++pieces;
            breaks += p.jumps && p.start != p.end;
            if (p.start == p.end && !p.begins) continue;  // only tells that a curve has ended
            track(p.channel, p.axis)
                .push_back({decoder.run_index(), grid.time_ns(p.start), grid.time_ns(p.end),
                            static_cast<double>(grid.tick_ns()), p});
        }
    }
    std::deque<Told>& track(std::size_t channel, std::size_t axis) {
        auto& tracks = told_[channel];
        if (tracks.size() <= axis) tracks.resize(axis + 1);
        return tracks[axis];
    }
    void settle() { settle_all(std::make_index_sequence<channels>{}); }
    template <std::size_t... I>
    void settle_all(std::index_sequence<I...>) {
        (settle_channel<I>(), ...);
    }
    template <std::size_t C>
    void settle_channel() {
        auto& queue = waiting_[C];
        auto& tracks = told_[C];
        while (!queue.empty() && !tracks.empty()) {
            const Waiting& w = queue.front();
            std::vector<const Piece*> at;
            std::vector<double> ticks;
            for (auto& list : tracks) {
                while (!list.empty() &&
                       (list.front().run < w.run ||
                        (list.front().run == w.run && list.front().end_ns < w.t_ns)))
                    list.pop_front();
                if (list.empty() || list.front().run != w.run) return;
                const Told& t = list.front();
                const bool holds = t.piece.begins ? t.start_ns <= w.t_ns : t.start_ns < w.t_ns;
                if (!holds) return;
                at.push_back(&t.piece);
                ticks.push_back(static_cast<double>(w.t_ns - t.start_ns) / t.tick_ns);
            }
            if (tracks.size() != (at.size())) return;
            const double e = error_of(std::get<C>(w.values), at, ticks, params_.tolerance[C]);
            worst = std::max(worst, e);
            if (!(e <= 1.0)) {
                if (violations++ == 0) note("violation " + std::to_string(e), w);
            }
            queue.pop_front();
        }
    }
    void note(const std::string& what, const Waiting& w) {
        if (first_fault.empty())
            first_fault = what + " push " + std::to_string(w.push) + " t " + std::to_string(w.t_ns);
    }

    std::array<std::deque<Waiting>, channels> waiting_{};
    std::array<std::vector<std::deque<Told>>, channels> told_{};
    std::optional<Waiting> held_{};
    std::size_t pushes_{0};
    std::uint32_t run_{0}, held_valid_{0};
    std::uint16_t last_run_{0};
};

}  // namespace fairlead::test
