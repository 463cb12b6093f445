#pragma once
// Which grid the curves of a pipeline lie on: that of the sample period which the user gave, or of
// the period which is measured from the first records. Those are covered as well.
//
// Measuring: the first record waits for the second, and the step between them is the first guess. A
// step that is too short for the grid of the guess gives a better one at once. After 17 steps their
// median counts where it differs from the guess by more than an eighth. Each change begins a run;
// its first record is marked before the filter, so that a record keeps the grid that it was
// accepted for however long the filter holds it. A user who gives the period pays one comparison.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/types.hpp"
#include "fairlead/sense/intake.hpp"
#include "fairlead/sense/period.hpp"

namespace fairlead::detail {

/// Encoder: has limits(stream, period) and set_period(period): the grid from the next run on.
template <class Stream, class Encoder>
class GridFinder {
  public:
    constexpr explicit GridFinder(const Stream& stream) noexcept : stream_{stream} {}

    /// What suits the period; before it is known, what suits any.
    static constexpr IntakeLimits first_limits(const Stream& stream) noexcept {
        if (stream.sample_period_ns != 0) return Encoder::limits(stream, stream.sample_period_ns);
        IntakeLimits limits = Encoder::limits(stream, sample_period_max_ns);
        limits.first_waits = true;
        limits.spacing_min_ns = Encoder::limits(stream, sample_period_min_ns).spacing_min_ns;
        return limits;
    }

    template <class Gate>
    void start(Gate& gate, Encoder& encoder) noexcept {
        meter_.reset();
        period_ns_ = 0;
        change_in_ = changes_ = strict_ = 0;
        committed_ = placed_ = false;
        if (stream_.sample_period_ns != 0) return use(stream_.sample_period_ns, gate, encoder);
        gate.set_limits(first_limits(stream_));
    }

    /// The sample period in use, ns; 0: not known yet.
    constexpr std::int64_t period_ns() const noexcept { return period_ns_; }

    /// A record that the intake gives.
    template <class Raw, class Gate>
    void measure(const Raw& accepted, Gate& gate, Encoder& encoder) noexcept {
        if (stream_.sample_period_ns != 0 || committed_) return;
        const Raw* const next = gate.accepted();  // accepted by the same limits
        if (period_ns_ == 0) {
            const std::int64_t step = next ? next->t_ns - accepted.t_ns : sample_period_max_ns;
            use(PeriodMeter::clamped(step), gate, encoder);
        }
        const bool run = (accepted.flags & flag::new_run) != 0;
        const std::int64_t step = run || !meter_.running() ? period_ns_ : accepted.t_ns - last_ns_;
        if (step < limits().spacing_min_ns) change(PeriodMeter::clamped(step), 0);
        last_ns_ = accepted.t_ns;
        if (run) meter_.pause();
        meter_.push(accepted.t_ns);
        gate.set_limits(meter_.known() ? commit_median(next ? 1 : 0) : measuring());
    }

    /// The record before the filter: the first one of a new grid is marked.
    template <class Record>
    void mark(std::optional<Record>& record) noexcept {
        if (change_in_ > 1) {
            --change_in_;
        } else if (change_in_ == 1 && record) {
            record->flags |= flag::new_grid | flag::new_run | flag::gap_before;
            change_in_ = 0;
        }
    }

    /// The record behind the filter, on its way to the encoder. What was accepted while measuring
    /// was not judged by the grid that it lies on: a pause that is too long for it becomes a gap.
    template <class Record, class Gate>
    void place(Record& record, Gate& gate, Encoder& encoder) noexcept {
        if (stream_.sample_period_ns != 0) return;
        if ((record.flags & flag::new_grid) != 0) {
            record.flags &= ~flag::new_grid;
            encoder.set_period(period_ns_);
            if (--changes_ == 0 && committed_) gate.set_limits(limits());
            gap_ns_ = gate.gap_ns(limits());
        } else if (placed_ && (record.flags & flag::new_run) == 0 &&
                   record.t_ns - placed_ns_ > gap_ns_) {
            record.flags |= flag::gap_before;
        }
        placed_ns_ = record.t_ns;
        placed_ = true;
    }

  private:
    IntakeLimits limits() const noexcept { return Encoder::limits(stream_, period_ns_); }
    IntakeLimits measuring() const noexcept {
        IntakeLimits now = limits();
        now.spacing_min_ns = first_limits(stream_).spacing_min_ns;
        return now;
    }

    template <class Gate>
    void use(std::int64_t period_ns, Gate& gate, Encoder& encoder) noexcept {
        period_ns_ = period_ns;
        encoder.set_period(period_ns);
        gate.set_limits(limits());
        gap_ns_ = gate.gap_ns(limits());
    }

    /// The median is known. It counts when no record that was accepted while measuring can ask for
    /// a finer grid any more. inside: records that wait in the intake. @return its new limits.
    IntakeLimits commit_median(std::size_t inside) noexcept {
        committed_ = ++strict_ > 2 && changes_ == 0;
        IntakeLimits now = limits();
        if (!committed_) return now;
        const std::int64_t off = meter_.period_ns() - period_ns_;
        if ((off < 0 ? -off : off) > period_ns_ / 8) change(meter_.period_ns(), 1 + inside);
        // what comes suits both grids until the new one holds
        now.spacing_min_ns = (std::max)(now.spacing_min_ns, limits().spacing_min_ns);
        return now;
    }

    /// From the record on that comes `ahead` records after this one, curves lie on another grid.
    void change(std::int64_t period_ns, std::size_t ahead) noexcept {
        period_ns_ = period_ns;
        if (change_in_ != 0) return;  // one is due already
        change_in_ = ahead + 1;
        ++changes_;
    }

    Stream stream_;
    PeriodMeter meter_{};
    std::int64_t period_ns_{0};
    std::int64_t last_ns_{0};    // newest record that was measured
    std::int64_t placed_ns_{0};  // newest record that the encoder got
    std::int64_t gap_ns_{0};     // longest pause on the encoder's grid
    std::size_t change_in_{0};   // records to the first one of a new grid, plus 1; 0: none is due
    std::size_t changes_{0};     // of the grid, that the encoder has not seen yet
    std::size_t strict_{0};      // records since the median is known
    bool committed_{false};
    bool placed_{false};
};

}  // namespace fairlead::detail
