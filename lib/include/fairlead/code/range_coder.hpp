#pragma once
// Range coder with static frequencies: symbols to bytes and back, near to the sum of their
// information [G. N. N. Martin 1979]. 32-bit arithmetic, no heap; totals are powers of two, so the
// encoder never divides, and the decoder divides once a symbol.
//
// The bytes of a run are a binary fraction between 0 and 1. The encoder narrows the interval
// [low, low + range) symbol by symbol and emits the leading byte when range falls below 2^24. Its
// end is short: of the four bytes that are left, the value with most zero bytes at its end, without
// these bytes. The decoder reads zeros behind the last byte. finished() tells whether the bytes are
// exactly those that the encoder writes for the decoded symbols: a cheap check of sanity, since
// random bytes pass it rarely.
//
// Encoder and decoder have the same members, so that a layout is written once and serves both
// (`Io`). docs/stream.md holds the arithmetic as a specification.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead::code {

/// The largest total of a frequency table is 2^total_bits_max.
inline constexpr unsigned total_bits_max = 15;

namespace detail {
inline constexpr std::uint32_t top = std::uint32_t{1} << 24;

/// What to add to low for the value in [low, low + range) with most zero bytes at its end.
constexpr std::uint32_t shortest(std::uint32_t low, std::uint32_t range) noexcept {
    std::uint32_t mask = 0xffffffffu;
    for (int i = 0; i < 4; ++i, mask >>= 8) {
        const std::uint32_t step = (~low + 1u) & mask;  // to the next multiple of mask + 1
        if (step < range) return step;
    }
    return 0;
}
}  // namespace detail

/// Writes into memory of the caller's. Past its end: ok() is false, and nothing is overwritten.
class RangeEncoder {
  public:
    static constexpr bool writes = true;

    constexpr RangeEncoder() = default;
    constexpr RangeEncoder(std::uint8_t* data, std::size_t capacity) noexcept
        : data_{data}, capacity_{capacity} {}

    /// A symbol of width freq >= 1 that begins at cum of a total of 2^bits; bits <= total_bits_max.
    constexpr void put(std::uint32_t cum, std::uint32_t freq, unsigned bits) noexcept {
        const std::uint32_t unit = range_ >> bits;
        const std::uint32_t step = unit * cum;
        low_ += step;
        if (low_ < step) carry();
        range_ = unit * freq;
        for (int i = 0; i < 3 && range_ < detail::top; ++i) {
            emit();
            low_ <<= 8;
            range_ <<= 8;
        }
    }
    /// The lowest n bits of v as they are, n <= 32.
    constexpr void bits(std::uint32_t& v, unsigned n) noexcept {
        while (n > 0) {
            const unsigned part = n < 12 ? n : 12;
            n -= part;
            put((v >> n) & ((1u << part) - 1u), 1, part);
        }
    }
    /// A decision; its probability to be true is ones / 2^bits, 0 < ones < 2^bits.
    constexpr void flag(bool& v, std::uint32_t ones, unsigned bits) noexcept {
        const std::uint32_t zeros = (1u << bits) - ones;
        put(v ? zeros : 0, v ? ones : zeros, bits);
    }
    /// Ends the run. @return the number of bytes, at least 1; call once.
    constexpr std::size_t finish() noexcept {
        const std::uint32_t step = detail::shortest(low_, range_);
        low_ += step;
        if (low_ < step) carry();
        for (int i = 0; i < 4 && low_ != 0; ++i, low_ <<= 8) emit();
        if (size_ == 0) emit();
        return size_;
    }
    /// @return false: the memory was too small, the bytes are of no use.
    constexpr bool ok() const noexcept { return size_ <= capacity_; }
    /// Bytes emitted so far; the end adds at most 4.
    constexpr std::size_t size() const noexcept { return size_; }

  private:
    constexpr void emit() noexcept {
        if (size_ < capacity_) data_[size_] = static_cast<std::uint8_t>(low_ >> 24);
        if (size_ <= capacity_) ++size_;
    }
    /// Adds one to the bytes written; their value stays below 1, so that it never runs out.
    constexpr void carry() noexcept {
        std::size_t i = size_ < capacity_ ? size_ : capacity_;
        while (i > 0 && ++data_[--i] == 0) {
        }
    }

    std::uint8_t* data_{nullptr};
    std::size_t capacity_{0}, size_{0};
    std::uint32_t low_{0}, range_{0xffffffffu};
};

/// Reads what RangeEncoder wrote. Any bytes give some symbols: nothing traps, nothing runs on.
class RangeDecoder {
  public:
    static constexpr bool writes = false;

    constexpr RangeDecoder() = default;
    constexpr RangeDecoder(const std::uint8_t* data, std::size_t size) noexcept
        : data_{data}, size_{static_cast<std::uint16_t>(size)} {
        for (int i = 0; i < 4; ++i) code_ = code_ << 8 | byte(at_++);
    }

    /// Where in a total of 2^bits the next symbol lies; take() must follow with the symbol.
    constexpr std::uint32_t peek(unsigned bits) const noexcept {
        const std::uint32_t last = (1u << bits) - 1u;
        const std::uint32_t place = code_ / (range_ >> bits);
        return place < last ? place : last;
    }
    constexpr void take(std::uint32_t cum, std::uint32_t freq, unsigned bits) noexcept {
        const std::uint32_t unit = range_ >> bits;
        code_ -= unit * cum;
        range_ = unit * freq;
        for (int i = 0; i < 3 && range_ < detail::top; ++i) {
            code_ = code_ << 8 | byte(at_++);
            range_ <<= 8;
        }
    }
    constexpr void bits(std::uint32_t& v, unsigned n) noexcept {
        v = 0;
        while (n > 0) {
            const unsigned part = n < 12 ? n : 12;
            n -= part;
            const std::uint32_t some = peek(part);
            take(some, 1, part);
            v = v << part | some;
        }
    }
    constexpr void flag(bool& v, std::uint32_t ones, unsigned bits) noexcept {
        const std::uint32_t zeros = (1u << bits) - ones;
        v = peek(bits) >= zeros;
        take(v ? zeros : 0, v ? ones : zeros, bits);
    }
    /// Bytes that were taken so far, the four that wait in the register among them.
    constexpr std::size_t taken() const noexcept { return at_; }
    /// A decoder reads on behind the bytes: whether they were right, finished() tells.
    constexpr bool ok() const noexcept { return true; }
    /// After the last symbol: are the bytes exactly what the encoder writes for these symbols?
    constexpr bool finished() const noexcept {
        std::uint32_t window = 0;  // the four bytes that the encoder had not emitted at its end
        for (std::size_t i = at_ - 4; i < at_; ++i) window = window << 8 | byte(i);
        std::size_t size = at_ - 4;
        for (std::uint32_t rest = window; rest != 0; rest <<= 8) ++size;
        return size_ == (size > 0 ? size : 1) && code_ < range_ &&
               code_ == detail::shortest(window - code_, range_);
    }

  private:
    constexpr std::uint32_t byte(std::size_t at) const noexcept {
        return at < size_ ? data_[at] : 0u;
    }

    const std::uint8_t* data_{nullptr};
    std::uint16_t size_{0}, at_{0};  // a payload has fewer than 256 bytes
    std::uint32_t code_{0}, range_{0xffffffffu};
};

/// An unsigned number below 2^32 in exp-Golomb code of order k [S. W. Golomb 1966; Teuhola 1978]:
/// small ones cost k + 1 bits, n costs 2 log2(n / 2^k + 1) + k + 1. @return false where the bytes
/// tell a number that is too large.
template <class Io>
constexpr bool exp_golomb(Io& io, std::uint32_t& v, unsigned k) noexcept {
    // v + 2^k, here without its bit 32, has `more + k + 1` bits; `more` is told in unary
    const std::uint32_t least = 1u << k, wide = v + least;
    unsigned more = 0;
    for (bool going = true; more + k <= 32; ++more) {
        const unsigned bits = more + k + 1;
        going = Io::writes && (wide < least ? bits <= 32 : bits < 32 && wide >> bits != 0);
        io.flag(going, 1, 1);
        if (!going) break;
    }
    const unsigned below = more + k;
    if (below > 32) return false;
    const std::uint32_t first = below < 32 ? 1u << below : 0;
    std::uint32_t low = wide & (first - 1u);
    io.bits(low, below);
    if (below == 32 && low >= least) return false;
    v = first + low - least;
    return true;
}

}  // namespace fairlead::code
