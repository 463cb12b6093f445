#pragma once
// From a chip's own clock to honest times: fits a line through pairs of (chip tick, edge time) and
// reads every sample's time off it, so that samples out of a FIFO keep the chip's even spacing
// while the line follows the system's clock.
//
// The fit is the growing-memory line fit (alpha 2(2n-1)/(n(n+1)), beta 6/(n(n+1))) that stops
// growing at n = 16 and so follows an oscillator that drifts. Edges come late when a system is
// busy, never early: one that is off by more than a sample period is set aside; eight of those in a
// row mean that the line is wrong, and it starts anew. Ticks are those of the chip, or a count of
// samples where a chip has no clock. Integer arithmetic; O(1) per call.
#include <cstdint>

#include "fairlead/base/status.hpp"

namespace fairlead::port {

class Timeline {
  public:
    struct Stamp {
        std::int64_t t_ns{};
        std::uint32_t lost{};  // samples missing just before this one
    };

    /// Nominal values. The line itself starts at the next anchor; the last time given out is kept,
    /// so that a restarted sensor continues after it, with the loss counted.
    void configure(std::int64_t tick_ps, std::int64_t period_ns, unsigned tick_bits) noexcept {
        nominal_q16_ = (tick_ps << 16) / 1000;
        period_ns_ = period_ns;
        tick_mask_ = tick_bits >= 32 ? 0xFFFFFFFFu : (1u << tick_bits) - 1u;
        restart();
    }
    /// The chip's count is lost, and the line with it: the next anchor begins another, and what is
    /// missing in between is told by the time between.
    void restart() noexcept {
        forget_line();
        broken_ = true;
    }
    bool anchored() const noexcept { return anchors_ > 0; }
    std::int64_t period_ns() const noexcept { return period_ns_; }
    /// The chip's second over ours, in parts per million: what the fit knows by now.
    std::int32_t error_ppm() const noexcept {
        return static_cast<std::int32_t>((q16_ - nominal_q16_) * 1000000 / nominal_q16_);
    }
    std::uint32_t set_aside() const noexcept { return set_aside_; }

    /// Extends the chip's counter to 64 bits. Call for every sample, in order.
    std::int64_t unwrap(std::uint32_t tick) noexcept {
        tick64_ += (tick - static_cast<std::uint32_t>(tick64_)) & tick_mask_;
        return tick64_;
    }

    /// The sample of this tick was ready at edge_ns. False: set aside as late.
    bool anchor(std::int64_t tick, std::int64_t edge_ns) noexcept {
        if (anchors_ == 0) {
            base_tick_ = tick;
            base_ns_ = edge_ns;
            anchors_ = 1;
            return true;
        }
        const std::int64_t span = tick - base_tick_;
        if (span <= 0) return false;
        const std::int64_t expected = at(tick);
        const std::int64_t error = edge_ns - expected;
        // before the second anchor the oscillator's own tolerance is still in the error
        const std::int64_t allowed = period_ns_ + (anchors_ == 1 ? (expected - base_ns_) / 8 : 0);
        if (error > allowed || error < -allowed) {
            ++set_aside_;
            if (++outliers_ >= outliers_max) forget_line();  // the count still holds
            return false;
        }
        outliers_ = 0;
        if (anchors_ < memory) ++anchors_;
        const std::int64_t n = anchors_;
        base_ns_ = expected + error * 2 * (2 * n - 1) / (n * (n + 1));
        base_tick_ = tick;
        q16_ += error * 6 * 65536 / (n * (n + 1)) / span;
        const std::int64_t slack = nominal_q16_ / 8;  // wider than any part's oscillator
        if (q16_ > nominal_q16_ + slack) q16_ = nominal_q16_ + slack;
        if (q16_ < nominal_q16_ - slack) q16_ = nominal_q16_ - slack;
        return true;
    }

    /// The time of a sample, later than every one before it.
    Stamp stamp(std::int64_t tick) noexcept {
        Stamp s;
        s.t_ns = at(tick);
        if (started_) {
            const std::int64_t passed =
                broken_ ? s.t_ns - last_ns_ : (tick - last_tick_) * nominal_q16_ >> 16;
            if (passed > period_ns_ + period_ns_ / 2)
                s.lost = clamp32((passed + period_ns_ / 2) / period_ns_ - 1);
            if (s.t_ns <= last_ns_) s.t_ns = last_ns_ + 1;
        }
        started_ = true;
        broken_ = false;
        last_ns_ = s.t_ns;
        last_tick_ = tick;
        return s;
    }

  private:
    static constexpr std::int64_t memory = 16;  // anchors that the fit remembers
    static constexpr int outliers_max = 8;      // late edges in a row that end a line

    void forget_line() noexcept {
        anchors_ = 0;
        outliers_ = 0;
        q16_ = nominal_q16_;
    }
    static std::uint32_t clamp32(std::int64_t n) noexcept {
        return n > 0xFFFFFFFF ? 0xFFFFFFFFu : static_cast<std::uint32_t>(n);
    }
    std::int64_t at(std::int64_t tick) const noexcept {
        return base_ns_ + ((tick - base_tick_) * q16_ >> 16);
    }

    std::int64_t nominal_q16_{1 << 16};  // ns per tick, 16 fractional bits
    std::int64_t q16_{1 << 16};
    std::int64_t period_ns_{1};
    std::uint32_t tick_mask_{0xFFFFFFFFu};
    std::int64_t tick64_{0};
    std::int64_t base_tick_{0};
    std::int64_t base_ns_{0};
    std::int64_t anchors_{0};
    int outliers_{0};
    std::uint32_t set_aside_{0};
    bool started_{false};
    bool broken_{true};
    std::int64_t last_ns_{0};
    std::int64_t last_tick_{0};
};

}  // namespace fairlead::port
