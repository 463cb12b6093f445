#pragma once
// Filters one after the other: n passes of one filter, or a chain chosen at run time.
//
// Latencies add up; gap flags travel with their records, so that every pass restarts at the same
// one. Ends are reflected by each pass for itself, as for n passes over a whole buffer.
// Cost: the sum of the passes per push; flush() at most the sum of their latencies more.
#include <array>
#include <cstddef>
#include <optional>

#include "fairlead/base/status.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/smooth/filter.hpp"

namespace fairlead {

/// Up to N filters of one type, in order. None: records pass unchanged.
template <class Filter, std::size_t N>
class Chain {
    static_assert(N > 0);

  public:
    constexpr Chain() noexcept = default;

    constexpr Status append(const Filter& filter) noexcept {
        if (count_ == N) return Status::bad_argument;
        filters_[count_++] = filter;
        return Status::ok;
    }
    constexpr std::size_t size() const noexcept { return count_; }

    std::optional<Pose> push(const Pose& pose) noexcept { return pass(pose, 0); }

    /// The next of the last records, from the first filter that still holds one back.
    std::optional<Pose> flush() noexcept {
        for (std::size_t i = 0; i < count_; ++i) {
            std::optional<Pose> y = filters_[i].flush();
            for (; y; y = filters_[i].flush()) {
                if (auto out = pass(*y, i + 1)) return out;
            }
        }
        return std::nullopt;
    }

    constexpr void reset() noexcept {
        for (std::size_t i = 0; i < count_; ++i) filters_[i].reset();
    }

    /// Records between a record and its filtered one.
    constexpr std::size_t delay() const noexcept {
        std::size_t sum = 0;
        for (std::size_t i = 0; i < count_; ++i) sum += filters_[i].delay();
        return sum;
    }

  protected:
    constexpr explicit Chain(const Filter& filter) noexcept : count_{N} { filters_.fill(filter); }

  private:
    std::optional<Pose> pass(const Pose& pose, std::size_t from) noexcept {
        std::optional<Pose> y = pose;
        for (std::size_t i = from; y && i < count_; ++i) y = filters_[i].push(*y);
        return y;
    }

    std::array<Filter, N> filters_{};
    std::size_t count_{0};
};

/// The same filter, Passes times. Cascade<PoseFilter<5>, 10>{PoseFilter<5>{smoothing_mask(1)}}.
template <class Filter, std::size_t Passes>
class Cascade : public Chain<Filter, Passes> {
  public:
    static constexpr std::size_t latency = Passes * Filter::latency;
    constexpr explicit Cascade(const Filter& filter) noexcept : Chain<Filter, Passes>{filter} {}

    Status append(const Filter&) = delete;
};

}  // namespace fairlead
