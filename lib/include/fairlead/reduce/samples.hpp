#pragma once
// The samples of a channel: those of the committed frame until it has left, then the window's.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "fairlead/curve/grid.hpp"

namespace fairlead::reduce {

/// At most this many samples lie behind one column before the next is
/// offered: two ticks of the closest spacing.
inline constexpr std::size_t between_max = 2 * curve::subs_per_tick / curve::spacing_subs_min + 1;
/// A jump over n samples has at most this many parts: for each a value, and ticks between.
constexpr std::size_t jump_parts(std::size_t n) noexcept { return 3 * (n + 2); }
inline constexpr std::size_t jump_parts_max = jump_parts(between_max);
/// Pushes in which a committed frame may be checked and coded.
inline constexpr std::size_t drain_pushes = 8;
/// So many samples are to be checked: all of them, and whatever must be done before.
inline constexpr std::size_t check_all = std::size_t{1} << 12;

template <class Value, std::size_t Window>
class Samples {
  public:
    static constexpr std::size_t capacity = Window + drain_pushes + 2 * between_max;

    /// Samples of the committed frame and of the window; committed ones come first.
    std::size_t old_count() const noexcept { return old_; }
    std::size_t count() const noexcept { return count_; }
    bool full() const noexcept { return old_ + count_ == capacity; }

    void push(const curve::Moment& at, const Value& value) noexcept {
        FAIRLEAD_ASSERT(!full());
        if (full()) return;
        const std::size_t i = slot(old_ + count_);
        tick_[i] = static_cast<std::uint8_t>(at.tick);
        part_[i] = at.part;
        value_[i] = value;
        ++count_;
    }
    /// Sample i of the window; i >= count() is a mistake.
    curve::Moment when(std::size_t i) const noexcept { return moment(slot(old_ + i)); }
    const Value& value(std::size_t i) const noexcept { return value_[slot(old_ + i)]; }
    Value& value(std::size_t i) noexcept { return value_[slot(old_ + i)]; }
    /// Sample i of the committed frame.
    curve::Moment old_when(std::size_t i) const noexcept { return moment(slot(i)); }
    const Value& old_value(std::size_t i) const noexcept { return value_[slot(i)]; }
    Value& old_value(std::size_t i) noexcept { return value_[slot(i)]; }

    /// Samples of the window that are not behind this tick.
    std::size_t count_to(std::int32_t tick) const noexcept {
        std::size_t n = count_;
        for (std::size_t i = 0; n > 0 && i < capacity; ++i) {
            const curve::Moment at = when(n - 1);
            if (at.tick < tick || (at.tick == tick && !(at.part > 0.0f))) break;
            --n;
        }
        return n;
    }
    /// The window ended at this tick: what is not behind it belongs to the frame, the rest begins a
    /// window that starts there.
    void commit(std::int32_t tick) noexcept {
        release();
        old_ = count_to(tick);
        count_ -= old_;
        for (std::size_t i = 0; i < count_; ++i) {
            std::uint8_t& t = tick_[slot(old_ + i)];
            t = static_cast<std::uint8_t>(t - tick);
        }
    }
    /// The first tick at or behind sample i of the committed frame; INT32_MAX: there is none.
    std::int32_t old_tick(std::size_t i) const noexcept {
        if (i >= old_) return INT32_MAX;
        const curve::Moment at = old_when(i);
        return at.tick + (at.part > 0.0f ? 1 : 0);
    }
    /// The first n samples of the committed frame have left.
    void release_first(std::size_t n) noexcept {
        head_ = slot(n);
        old_ -= n;
    }
    /// The committed frame has left.
    void release() noexcept { release_first(old_); }
    /// The window's samples are of no use any more.
    void drop() noexcept { count_ = 0; }
    void clear() noexcept { head_ = old_ = count_ = 0; }

  private:
    std::size_t slot(std::size_t i) const noexcept {
        const std::size_t s = head_ + i;
        return s < capacity ? s : s - capacity;
    }
    curve::Moment moment(std::size_t s) const noexcept { return {tick_[s], part_[s]}; }

    std::array<Value, capacity> value_{};
    std::array<float, capacity> part_{};
    std::array<std::uint8_t, capacity> tick_{};
    std::size_t head_{0}, old_{0}, count_{0};
};

}  // namespace fairlead::reduce
