#pragma once
// Bit packing, and numbers in few bits. Writer and reader have the same members, so that a layout
// is written down once (wire/layout.hpp) and serves both directions.
#include <array>
#include <cstddef>
#include <cstdint>

namespace fairlead {

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
constexpr unsigned bit_width(std::uint64_t v) noexcept {
    unsigned n = 0;
    for (; n < 64 && (v >> n) != 0; ++n) {
    }
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

    constexpr void bits(std::uint32_t& v, unsigned n) noexcept {
        for (unsigned i = n; i-- > 0;) put((v >> i) & 1u);
    }
    constexpr void rice(std::uint32_t& v, RiceModel& model) noexcept {
        const unsigned k = model.k();
        const std::uint32_t quotient = v >> k;
        if (quotient < escape) {
            for (std::uint32_t i = 0; i < quotient; ++i) put(1);
            put(0);
            bits(v, k);
        } else {
            for (std::uint32_t i = 0; i < escape; ++i) put(1);
            bits(v, 32);
        }
        model.learn(v);
    }
    constexpr bool ok() const noexcept { return ok_; }
    constexpr std::size_t size() const noexcept { return (used_ + 7) / 8; }

    static constexpr std::uint32_t escape = 20;

  private:
    constexpr void put(std::uint32_t bit) noexcept {
        if (used_ / 8 >= capacity_) {
            ok_ = false;
            return;
        }
        const unsigned place = 7u - static_cast<unsigned>(used_ % 8);
        if (place == 7) data_[used_ / 8] = 0;
        data_[used_ / 8] = static_cast<std::uint8_t>(data_[used_ / 8] | (bit << place));
        ++used_;
    }

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

    constexpr void bits(std::uint32_t& v, unsigned n) noexcept {
        v = 0;
        for (unsigned i = 0; i < n; ++i) v = (v << 1) | get();
    }
    constexpr void rice(std::uint32_t& v, RiceModel& model) noexcept {
        const unsigned k = model.k();
        std::uint32_t quotient = 0;
        while (quotient < BitWriter::escape && get() != 0) ++quotient;
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
    constexpr std::uint32_t get() noexcept {
        if (used_ / 8 >= size_) {
            ok_ = false;
            return 0;
        }
        const std::uint32_t bit = (data_[used_ / 8] >> (7 - used_ % 8)) & 1u;
        ++used_;
        return bit;
    }

    const std::uint8_t* data_{nullptr};
    std::size_t size_{0};
    std::size_t used_{0};
    bool ok_{true};
};

}  // namespace fairlead
