#pragma once
// The bytes in which a decoder looks for a frame: they come one by one, and leave from the front.
//
// Damage lets a decoder wait for the end of a frame that never was, and then everything since its
// false head has to be searched again. So that no push pays for the square of that, the checksum of
// any piece of the backlog costs the same whatever its length: a prefix's checksum is kept for
// every fourth byte, and two products tell what lies between two of them (wire/crc.hpp). Bytes
// leave by moving the front; they are moved themselves at most once in `spare` pushes.
//
// Cost of a push: 1 checksum step, rarely a move of `live_max` bytes. Of a test: 2 products.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "host_sim/study/baselines/earlier/wire/crc_powers.hpp"
#include "host_sim/study/baselines/earlier/wire/layout.hpp"

namespace fairlead::earlier::wire {

class Backlog {
  public:
    static constexpr std::size_t live_max = max_frame;
    static constexpr std::size_t spare = live_max / 4;

    std::size_t size() const noexcept { return end_ - front_; }
    std::uint8_t operator[](std::size_t i) const noexcept { return bytes_[front_ + i]; }
    const std::uint8_t* data() const noexcept { return bytes_.data() + front_; }

    void push(std::uint8_t byte) noexcept {
        FAIRLEAD_ASSERT(size() < live_max);
        if (end_ == bytes_.size()) move();
        if (end_ % stride == 0) prefix_[end_ / stride] = crc_;
        bytes_[end_++] = byte;
        crc_ = crc16(byte, crc_);
    }
    void drop(std::size_t n) noexcept {
        front_ += n;
        if (front_ < end_) return;
        front_ = end_ = 0;
    }

    /// The n bytes from a place on are followed by their checksum from this seed.
    /// at + n + 2 <= size().
    bool sealed(std::size_t at, std::size_t n, std::uint16_t seed) const noexcept {
        const auto start = static_cast<std::uint16_t>(checksum_before(front_ + at) ^ seed);
        return checksum_before(front_ + at + n + 2) == powers.after_zeros(start, n + 2);
    }

  private:
    static constexpr std::size_t stride = 4;
    static_assert(spare >= stride, "a move makes room");
    static constexpr Crc16Powers<live_max> powers{};

    /// Of all bytes before a place, from where the backlog was last empty.
    std::uint16_t checksum_before(std::size_t at) const noexcept {
        if (at == end_) return crc_;
        std::uint16_t crc = prefix_[at / stride];
        for (std::size_t i = at - at % stride; i < at; ++i) crc = crc16(bytes_[i], crc);
        return crc;
    }

    /// To the beginning of the memory, in whole strides.
    void move() noexcept {
        const std::size_t by = front_ - front_ % stride;
        for (std::size_t i = by; i < end_; ++i) bytes_[i - by] = bytes_[i];
        for (std::size_t i = by; i < end_; i += stride)
            prefix_[(i - by) / stride] = prefix_[i / stride];
        front_ -= by;
        end_ -= by;
    }

    static constexpr std::size_t capacity = live_max + spare;

    std::array<std::uint8_t, capacity> bytes_{};
    std::array<std::uint16_t, (capacity + stride - 1) / stride> prefix_{};
    std::size_t front_{0}, end_{0};
    std::uint16_t crc_{0};  // of all bytes
};

}  // namespace fairlead::earlier::wire
