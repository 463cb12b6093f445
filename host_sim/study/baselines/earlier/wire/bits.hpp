#pragma once
// Bit packing, and numbers in few bits. Writer and reader have the same members, so that a layout
// is written down once (wire/layout.hpp) and serves both directions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "fairlead/base/compiler.hpp"

namespace fairlead::earlier {

constexpr std::uint32_t zigzag(std::int32_t v) noexcept {
    return (static_cast<std::uint32_t>(v) << 1) ^ (v < 0 ? 0xffffffffu : 0u);
}
constexpr std::int32_t unzigzag(std::uint32_t v) noexcept {
    return static_cast<std::int32_t>((v >> 1) ^ ((v & 1u) ? 0xffffffffu : 0u));
}
constexpr std::uint64_t zigzag64(std::int64_t v) noexcept {
    return (static_cast<std::uint64_t>(v) << 1) ^ (v < 0 ? ~std::uint64_t{0} : std::uint64_t{0});
}
constexpr std::int64_t unzigzag64(std::uint64_t v) noexcept {
    return static_cast<std::int64_t>((v >> 1) ^ ((v & 1u) ? ~std::uint64_t{0} : std::uint64_t{0}));
}
/// Bits that v needs; 0 for 0.
template <class Unsigned>
constexpr unsigned bit_width(Unsigned v) noexcept {
    static_assert(!std::numeric_limits<Unsigned>::is_signed);
    unsigned n = 0;
    for (; v != 0; v >>= 1) ++n;
    return n;
}

/// The parameter of a Rice code that follows the mean of what it has coded [R. F. Rice 1979].
struct RiceModel {
    std::uint32_t mean16{16 * 8};  // 16 times the running mean

    constexpr unsigned k() const noexcept {
        const unsigned width = bit_width(mean16 * 3 / 64);  // best k is near log2(0.7 mean)
        return width;
    }
    constexpr void learn(std::uint32_t v) noexcept {
        const std::uint32_t capped = v < (1u << 20) ? v : (1u << 20);
        mean16 += 2 * capped;
        mean16 -= mean16 / 8;
    }
    /// The few bits of the model that a restart point carries, and back.
    constexpr std::uint32_t summary() const noexcept { return bit_width(mean16); }
    constexpr void restore(std::uint32_t width) noexcept {
        mean16 = width ? 3u << (width < 26 ? width : 26) >> 2 : 0;
    }
};

/// Writes bits, most significant first, into memory of the caller's. Past the end: ok() is false.
class BitWriter {
  public:
    static constexpr bool writes = true;

    constexpr BitWriter(std::uint8_t* data, std::size_t capacity) noexcept
        : data_{data}, capacity_{capacity} {}

    /// The lowest n bits, at most 32.
    constexpr void bits(std::uint32_t& v, unsigned n) noexcept {
        while (n > 0) {  // what fits into a byte at a time
            if (used_ / 8 >= capacity_) {
                ok_ = false;
                return;
            }
            const auto place = static_cast<unsigned>(used_ % 8), room = 8 - place;
            const unsigned some = n < room ? n : room;
            n -= some;
            const std::uint32_t part = (v >> n) & ((1u << some) - 1u);
            const unsigned before = place > 0 ? data_[used_ / 8] : 0u;
            data_[used_ / 8] = static_cast<std::uint8_t>(before | (part << (room - some)));
            used_ += some;
        }
    }
    constexpr void rice(std::uint32_t& v, RiceModel& model) noexcept {
        const unsigned k = model.k();
        const std::uint32_t quotient = v >> k;
        if (quotient < escape) {
            std::uint32_t ones = (2u << quotient) - 2u;  // and a zero
            bits(ones, quotient + 1);
            bits(v, k);
        } else {
            std::uint32_t ones = (1u << escape) - 1u;
            bits(ones, escape);
            bits(v, 32);
        }
        model.learn(v);
    }
    constexpr bool ok() const noexcept { return ok_; }
    constexpr std::size_t size() const noexcept { return (used_ + 7) / 8; }

    static constexpr std::uint32_t escape = 20;

  private:
    std::uint8_t* data_;
    std::size_t capacity_;
    std::size_t used_{0};
    bool ok_{true};
};

/// Reads what BitWriter wrote. Past the end: zeros, and ok() is false.
class BitReader {
  public:
    static constexpr bool writes = false;

    constexpr BitReader() = default;
    constexpr BitReader(const std::uint8_t* data, std::size_t size) noexcept
        : data_{data}, size_{size} {}

    /// n bits, at most 32.
    constexpr void bits(std::uint32_t& v, unsigned n) noexcept {
        v = 0;
        while (n > 0) {  // what a byte holds at a time
            if (used_ / 8 >= size_) {
                ok_ = false;
                v = n < 32 ? v << n : 0;
                return;
            }
            const auto room = 8 - static_cast<unsigned>(used_ % 8);
            const unsigned some = n < room ? n : room;
            const std::uint32_t byte = data_[used_ / 8];
            v = (v << some) | ((byte >> (room - some)) & ((1u << some) - 1u));
            used_ += some;
            n -= some;
        }
    }
    constexpr void rice(std::uint32_t& v, RiceModel& model) noexcept {
        const unsigned k = model.k();
        std::uint32_t quotient = 0;
        for (std::uint32_t bit = 1; quotient < BitWriter::escape; ++quotient) {
            bits(bit, 1);
            if (bit == 0) break;
        }
        if (quotient < BitWriter::escape) {
            bits(v, k);
            v |= quotient << k;
        } else {
            bits(v, 32);
        }
        model.learn(v);
    }
    constexpr bool ok() const noexcept { return ok_; }
    constexpr std::size_t used_bits() const noexcept { return used_; }
    /// Whole bytes not yet touched.
    constexpr std::size_t left() const noexcept { return size_ - (used_ + 7) / 8; }

  private:
    const std::uint8_t* data_{nullptr};
    std::size_t size_{0};
    std::size_t used_{0};
    bool ok_{true};
};

}  // namespace fairlead::earlier
