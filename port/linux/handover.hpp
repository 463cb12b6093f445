#pragma once
// Handing data from one thread to one other without locks, waiting or allocation.
//
// A triple buffer for state (the newest wins, nothing is ever torn), a queue for records (nothing
// is overwritten; what does not fit is refused and counted by the writer). Each side costs one or
// two atomic operations and a copy. A sequence lock was measured too and sends torn values as soon
// as the reader's retries are bounded; this has nothing to retry.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace fairlead::port {

/// The newest value of T, from one writer thread to one reader thread.
template <class T>
class TripleBuffer {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    /// Writer: publishes a copy; never waits.
    void write(const T& value) noexcept {
        slots_[back_] = value;
        back_ = middle_.exchange(back_ | fresh, std::memory_order_acq_rel) & index_mask;
    }

    /// Reader: takes the newest value if there is one since the last call; never waits.
    bool refresh() noexcept {
        if ((middle_.load(std::memory_order_relaxed) & fresh) == 0) return false;
        front_ = middle_.exchange(front_, std::memory_order_acq_rel) & index_mask;
        return true;
    }
    /// Reader: the value of the last refresh(); a zero-initialised T before the first.
    const T& value() const noexcept { return slots_[front_]; }

  private:
    static constexpr std::uint8_t fresh = 4;
    static constexpr std::uint8_t index_mask = 3;

    std::array<T, 3> slots_{};
    std::atomic<std::uint8_t> middle_{1};
    alignas(64) std::uint8_t back_{0};   // the writer's
    alignas(64) std::uint8_t front_{2};  // the reader's
};

/// Records in order, from one writer thread to one reader thread. N: power of two.
template <class T, std::size_t N>
class Queue {
    static_assert(N > 0 && (N & (N - 1)) == 0);
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    /// Writer: false when the reader is N records behind; the record is then not taken.
    bool push(const T& item) noexcept {
        const std::size_t head = head_.load(std::memory_order_relaxed);
        if (head - tail_.load(std::memory_order_acquire) == N) return false;
        items_[head & (N - 1)] = item;
        head_.store(head + 1, std::memory_order_release);
        return true;
    }
    /// Reader: false when there is none.
    bool pop(T& item) noexcept {
        const std::size_t tail = tail_.load(std::memory_order_relaxed);
        if (tail == head_.load(std::memory_order_acquire)) return false;
        item = items_[tail & (N - 1)];
        tail_.store(tail + 1, std::memory_order_release);
        return true;
    }

  private:
    std::array<T, N> items_{};
    alignas(64) std::atomic<std::size_t> head_{0};
    alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace fairlead::port
