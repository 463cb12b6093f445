#pragma once
// A pipeline and a decoder at the end of its wire. Whatever goes in, everything is judged from the
// bytes, in double: each accepted record is covered, within tolerance, by bytes that left in time.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fairlead/pipeline.hpp"
#include "fairlead/wire/decoder.hpp"

namespace fairlead::test {

/// What was found. good(): the contract held.
struct Verdict {
    std::uint64_t pushed{0}, accepted{0}, values{0};  // values: valid channels of accepted records
    std::uint64_t violations{0}, late{0}, uncovered{0}, unknown{0}, damaged{0}, overflows{0};
    std::uint64_t bytes{0}, breaks{0}, runs{0};
    std::uint64_t given_up{0}, check_failures{0}, strays{0};  // the encoder's counts
    double worst{0};                                          // error over tolerance
    std::string first;

    bool good() const {
        return violations == 0 && late == 0 && uncovered == 0 && unknown == 0 && damaged == 0 &&
               overflows == 0;
    }
    void add(const Verdict& v) {
        pushed += v.pushed, accepted += v.accepted, values += v.values;
        violations += v.violations, late += v.late, uncovered += v.uncovered, unknown += v.unknown;
        damaged += v.damaged, overflows += v.overflows, bytes += v.bytes, breaks += v.breaks;
        given_up += v.given_up, check_failures += v.check_failures, strays += v.strays;
        runs += v.runs, worst = std::max(worst, v.worst);
        if (first.empty()) first = v.first;
    }
};

template <class Board>
class PipelineCheck {
    using Traits = detail::InputTraits<typename Board::Input>;
    using Raw = typename Traits::Raw;
    using Record = typename Traits::Record;
    using Channels = typename Board::Channels;

  public:
    using Chain = Pipeline<Board>;
    using Params = typename Chain::Params;

    explicit PipelineCheck(const Params& params)
        : params_{params}, chain_{std::make_unique<Chain>(params)} {}

    Chain& chain() { return *chain_; }
    const Verdict& verdict() const { return verdict_; }

    void push(const Raw& raw) {
        sent_.push_back({raw.t_ns, ++verdict_.pushed});
        note_and_take(chain_->push(raw));
    }
    /// What the pipeline takes must come out once, in order.
    void push_event(const Event& event) {
        if (chain_->push_event(event)) events_.push_back(event);
    }
    void idle() { note_and_take(chain_->idle()); }
    /// What is inside leaves; the stream goes on.
    void flush() {
        for (int calls = 0; calls < 1000; ++calls) {
            const Bytes out = chain_->flush();
            note_and_take(out);
            if (out.status == Status::end) break;
            if (calls == 999) complain("flush() never ends", verdict_.unknown, 0, 0);
        }
    }
    /// The end of the stream: everything must be covered.
    void finish() {
        flush();
        while (decoder_->finish()) drain();
        settle();
        for (auto& queue : waiting_)
            for (const Waiting& w : queue)
                complain("uncovered", verdict_.uncovered, w.push, w.t_ns);
        for (auto& queue : waiting_) queue.clear();
        if (verdict_.accepted > 0)  // events wait for the first run: its header must come first
            for (const Event& e : events_) complain("event lost", verdict_.uncovered, 0, e.t_ns);
        events_.clear();
        verdict_.damaged += decoder_->frame_counters().losses + decoder_->counters().nonsense;
        const auto& encoder = chain_->encoder().inner();
        // the bytes of cubics are an estimate: a frame that does not fit leaves as steps, counted
        if (!std::is_same_v<typename detail::KindOf<Board>::Type, curve::Cubics>)
            verdict_.overflows = encoder.overflows();
        verdict_.given_up = encoder.given_up();
        verdict_.check_failures = encoder.check_failures();
        verdict_.strays = encoder.strays();
    }

  private:
    static constexpr bool vector = !std::is_same_v<Record, Pose>;
    static constexpr std::size_t dimension = [] {
        if constexpr (vector)
            return std::tuple_size_v<decltype(Record::value)>;
        else
            return std::size_t{3};
    }();
    static constexpr bool has_first = vector || Channels::template has<Position>;
    static constexpr bool has_turn = !vector && Channels::template has<Orientation>;
    using Kinds = wire::KindSet<curve::Smooth, typename detail::KindOf<Board>::Type>;
    using Decoder = wire::Decoder<has_first ? dimension : 0, has_turn ? 1 : 0, Kinds>;

    struct Sent {
        std::int64_t t_ns;
        std::uint64_t push;
    };
    struct Waiting {
        std::int64_t t_ns;
        std::uint64_t push;    // of all records
        std::uint64_t number;  // of those that the encoder got
        std::uint32_t run;
        Record record;
        bool late;
    };
    struct Told {
        std::uint32_t run;
        std::int64_t start_ns, end_ns;
        double tick_ns;
        typename Decoder::Piece piece;
    };

    void complain(const char* what, std::uint64_t& count, std::uint64_t push, std::int64_t t_ns) {
        ++count;
        if (verdict_.first.empty())
            verdict_.first = std::string{what} + ", push " + std::to_string(push) + ", t " +
                             std::to_string(t_ns);
    }

    void note_and_take(const Bytes& out) {
        if (chain_->filtered()) held_ = chain_->filtered();
        // a record that waits until a frame has left belongs to the run that it begins
        if (held_ && !chain_->encoder().busy()) {
            note(*held_);
            held_.reset();
        }
        verdict_.bytes += out.size;
        for (const std::uint8_t byte : out)
            if (decoder_->push(byte)) drain();
        settle();
        // the delay counts accepted records, those that wait in the intake as well
        const std::uint64_t came = verdict_.accepted + (chain_->intake().accepted() ? 1 : 0);
        for (auto& queue : waiting_)
            for (Waiting& w : queue) {
                if (w.number + params_.delay_records > came) break;
                if (w.late) continue;
                complain("late", verdict_.late, w.push, w.t_ns);
                w.late = true;
            }
    }

    /// A record that the encoder got: it is accepted, and was pushed before in this order.
    void note(const Record& record) {
        while (!sent_.empty() && sent_.front().t_ns != record.t_ns) sent_.pop_front();
        if (sent_.empty()) return complain("never pushed", verdict_.unknown, 0, record.t_ns);
        const std::uint64_t push = sent_.front().push;
        sent_.pop_front();
        ++verdict_.accepted;
        const std::uint16_t run = chain_->encoder().inner().run();
        if (verdict_.accepted == 1 || run != run_) ++runs_, ++verdict_.runs;
        run_ = run;
        const auto wait = [&](std::size_t queue, flag::Bits valid) {
            if ((record.flags & valid) == 0) return;
            ++verdict_.values;
            waiting_[queue].push_back({record.t_ns, push, verdict_.accepted, runs_, record, false});
        };
        if constexpr (has_first) wait(0, flag::position_valid);
        if constexpr (has_turn) wait(1, flag::orientation_valid);
    }

    void drain() {
        drain_events();
        const curve::Grid grid = decoder_->grid();
        typename Decoder::Piece p;
        while (decoder_->next(p)) {
            verdict_.breaks += p.jumps && p.start != p.end;
            if (p.start == p.end && !p.begins) continue;  // only tells that a curve has ended
            const std::size_t at = p.rotates ? dimension : p.axis;
            told_[at].push_back({decoder_->run_index(), grid.time_ns(p.start), grid.time_ns(p.end),
                                 static_cast<double>(grid.tick_ns()), p});
        }
    }

    void drain_events() {
        Event told;
        while (decoder_->next_event(told)) {
            const bool next = !events_.empty() && told.t_ns == events_.front().t_ns &&
                              told.channel == events_.front().channel &&
                              told.value == events_.front().value;
            if (!next) return complain("another event", verdict_.unknown, 0, told.t_ns);
            events_.pop_front();
        }
    }

    /// The piece that covers w on a track; null: none yet.
    const Told* covering(std::size_t track, const Waiting& w) {
        auto& list = told_[track];
        while (!list.empty() && (list.front().run < w.run ||
                                 (list.front().run == w.run && list.front().end_ns < w.t_ns)))
            list.pop_front();
        if (list.empty() || list.front().run != w.run) return nullptr;
        const Told& t = list.front();
        const bool holds = t.piece.begins ? t.start_ns <= w.t_ns : t.start_ns < w.t_ns;
        return holds ? &t : nullptr;
    }
    static double ticks_into(const Told& t, const Waiting& w) {
        return static_cast<double>(w.t_ns - t.start_ns) / t.tick_ns;
    }

    void judge(double error, float tolerance, const Waiting& w) {
        const double e = error / static_cast<double>(tolerance);
        verdict_.worst = std::max(verdict_.worst, e);
        if (!(e <= 1)) complain("outside", verdict_.violations, w.push, w.t_ns);
    }

    void settle() {
        if constexpr (has_first) {
            while (!waiting_[0].empty()) {
                const Waiting& w = waiting_[0].front();
                std::array<const Told*, dimension> at{};
                for (std::size_t k = 0; k < dimension; ++k)
                    if (!(at[k] = covering(k, w))) return settle_turns();
                for (std::size_t k = 0; k < dimension; ++k) {
                    const double v =
                        at[k]->piece.steps_at(ticks_into(*at[k], w)) * at[k]->piece.scale.step();
                    judge(std::abs(v - static_cast<double>(component(w.record, k))), tolerance(k),
                          w);
                }
                waiting_[0].pop_front();
            }
        }
        settle_turns();
    }
    void settle_turns() {
        if constexpr (has_turn) {
            while (!waiting_[1].empty()) {
                const Waiting& w = waiting_[1].front();
                const Told* const at = covering(dimension, w);
                if (!at) return;
                const Quat& q = w.record.q_wb;
                const auto curve = normalised(wire::rotation_at(at->piece, ticks_into(*at, w)));
                const double error =
                    rotation_angle(curve, normalised(BasicQuat<double>{q.w, q.x, q.y, q.z}));
                judge(error, params_.tolerance.orientation_rad, w);
                waiting_[1].pop_front();
            }
        }
    }
    static float component(const Record& record, std::size_t k) {
        if constexpr (vector)
            return record.value[k];
        else
            return k == 0 ? record.p_w_m.x : k == 1 ? record.p_w_m.y : record.p_w_m.z;
    }
    float tolerance(std::size_t k) const {
        if constexpr (vector)
            return params_.tolerance.value[k];
        else if constexpr (has_first)
            return params_.tolerance.position_m[k];
        else
            return 0;
    }

    Params params_;
    std::unique_ptr<Chain> chain_;
    std::unique_ptr<Decoder> decoder_ = std::make_unique<Decoder>();
    Verdict verdict_{};
    std::deque<Sent> sent_{};
    std::optional<Record> held_{};
    std::deque<Event> events_{};  // taken, and not yet told
    std::array<std::deque<Waiting>, 2> waiting_{};
    std::array<std::deque<Told>, dimension + 1> told_{};
    std::uint32_t runs_{0};
    std::uint16_t run_{0};
};

}  // namespace fairlead::test
