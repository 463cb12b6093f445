#pragma once
// A window over the newest N values, in memory fixed at compile time.
#include <array>
#include <cstddef>

#include "fairlead/base/status.hpp"

namespace fairlead {

/// Fixed window, oldest first. full() is asked, nothing is silently overwritten. Cost: O(1) each.
template <class T, std::size_t N>
class Ring {
    static_assert(N > 0);

  public:
    static constexpr std::size_t capacity = N;

    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr bool full() const noexcept { return size_ == N; }

    /// i = 0 is the oldest, size() - 1 the newest.
    constexpr const T& operator[](std::size_t i) const noexcept {
        FAIRLEAD_ASSERT(i < size_);
        return items_[slot(i)];
    }
    constexpr T& operator[](std::size_t i) noexcept {
        FAIRLEAD_ASSERT(i < size_);
        return items_[slot(i)];
    }
    /// The item after one of the ring's own: walks in order without an index.
    constexpr T* after(T* item) noexcept {
        return ++item == items_.data() + N ? items_.data() : item;
    }
    constexpr const T& oldest() const noexcept { return (*this)[0]; }
    constexpr const T& newest() const noexcept { return (*this)[size_ - 1]; }

    constexpr void push(const T& item) noexcept {
        FAIRLEAD_ASSERT(!full());
        items_[slot(size_)] = item;
        ++size_;
    }
    /// Drops the n oldest.
    constexpr void pop(std::size_t n = 1) noexcept {
        FAIRLEAD_ASSERT(n <= size_);
        head_ = slot(n);
        size_ -= n;
    }
    constexpr void clear() noexcept { head_ = size_ = 0; }

  private:
    constexpr std::size_t slot(std::size_t i) const noexcept {
        const std::size_t s = head_ + i;
        return s < N ? s : s - N;
    }

    std::array<T, N> items_{};
    std::size_t head_{0};
    std::size_t size_{0};
};

}  // namespace fairlead
