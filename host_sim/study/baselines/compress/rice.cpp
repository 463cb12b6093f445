#include "host_sim/study/baselines/compress/rice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fairlead::sim {
namespace {

constexpr unsigned quotient_max = 20;  // then the number follows as it is
constexpr unsigned header_bits_per_context = 5;
constexpr double first_count = 4;  // weight of the mean that a state begins with

struct State {
    double sum{}, count{};
    unsigned shift() const {  // best for a geometric distribution of this mean
        unsigned k = 0;
        while (k < 30 && count * static_cast<double>(1u << k) < 0.69 * sum) ++k;
        return k;
    }
    void see(std::uint32_t value, unsigned memory) {
        sum += value;
        count += 1;
        if (count < memory) return;
        sum /= 2;
        count /= 2;
    }
};
using States = std::array<State, contexts_max>;

/// Where every context begins: a power of sqrt 2 near the stream's mean.
States beginning(const std::vector<Frame>& frames, std::size_t& used) {
    States all{};
    for (const Frame& frame : frames)
        for (const Symbol& s : frame.symbols)
            if (s.plain_bits == 0) all[s.context].see(s.value, ~0u);
    used = 0;
    for (State& state : all) {
        if (state.count == 0) continue;
        ++used;
        const double mean = std::max(state.sum / state.count, 0.01);
        const double kept = std::pow(2, std::round(2 * std::log2(mean)) / 2);
        state = {first_count * kept, first_count};
    }
    return all;
}

unsigned length(std::uint32_t value, unsigned k) {
    const std::uint32_t quotient = value >> k;
    return quotient < quotient_max ? quotient + 1 + k : quotient_max + 32;
}

class Bits {
  public:
    void put(std::uint32_t value, unsigned count) {
        for (unsigned i = count; i-- > 0;) put_bit(((value >> i) & 1u) != 0);
    }
    void put_bit(bool bit) {
        if (used_ % 8 == 0) bytes_.push_back('\0');
        if (bit) bytes_.back() = static_cast<char>(bytes_.back() | (0x80 >> (used_ % 8)));
        ++used_;
    }
    const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
    std::size_t used_{};
};

class BitReader {
  public:
    explicit BitReader(const std::string& bytes) : bytes_{bytes} {}
    bool bit() {
        const auto byte = static_cast<unsigned char>(bytes_.at(at_ / 8));
        return ((byte << (at_++ % 8)) & 0x80) != 0;
    }
    std::uint32_t get(unsigned count) {
        std::uint32_t v = 0;
        for (unsigned i = 0; i < count; ++i) v = (v << 1) | (bit() ? 1u : 0u);
        return v;
    }

  private:
    const std::string& bytes_;
    std::size_t at_{};
};

void put(Bits& bits, std::uint32_t value, unsigned k) {
    const std::uint32_t quotient = value >> k;
    for (std::uint32_t i = 0; i < std::min(quotient, quotient_max); ++i) bits.put_bit(true);
    if (quotient >= quotient_max) return bits.put(value, 32);
    bits.put_bit(false);
    bits.put(value & ((1u << k) - 1), k);
}

std::uint32_t get(BitReader& bits, unsigned k) {
    std::uint32_t quotient = 0;
    while (quotient < quotient_max && bits.bit()) ++quotient;
    if (quotient == quotient_max) return bits.get(32);
    return (quotient << k) | bits.get(k);
}

}  // namespace

std::size_t coded_size(const std::vector<Frame>& frames, unsigned memory) {
    std::size_t used = 0;
    const States first = beginning(frames, used);
    States states = first;
    std::size_t size = (used * header_bits_per_context + 7) / 8;
    for (const Frame& frame : frames) {
        if (frame.restart) states = first;
        std::size_t bits = 0;
        for (const Symbol& s : frame.symbols) {
            if (s.plain_bits != 0) {
                bits += s.plain_bits;
                continue;
            }
            bits += length(s.value, states[s.context].shift());
            states[s.context].see(s.value, memory);
        }
        size += frame_overhead + (bits + 7) / 8;
    }
    return size;
}

std::vector<std::string> write_frames(const std::vector<Frame>& frames, unsigned memory) {
    std::size_t used = 0;
    const States first = beginning(frames, used);
    States states = first;
    std::vector<std::string> out;
    for (const Frame& frame : frames) {
        if (frame.restart) states = first;
        Bits bits;
        for (const Symbol& s : frame.symbols) {
            if (s.plain_bits != 0) {
                bits.put(s.value, s.plain_bits);
                continue;
            }
            put(bits, s.value, states[s.context].shift());
            states[s.context].see(s.value, memory);
        }
        out.push_back(bits.bytes());
    }
    return out;
}

std::vector<Frame> read_frames(const std::vector<std::string>& bytes, std::vector<Frame> shape,
                               unsigned memory) {
    std::size_t used = 0;
    const States first = beginning(shape, used);  // the header's part of the shape
    States states = first;
    for (std::size_t i = 0; i < shape.size(); ++i) {
        if (shape[i].restart) states = first;
        BitReader bits{bytes[i]};
        for (Symbol& s : shape[i].symbols) {
            if (s.plain_bits != 0) {
                s.value = bits.get(s.plain_bits);
                continue;
            }
            s.value = get(bits, states[s.context].shift());
            states[s.context].see(s.value, memory);
        }
    }
    return shape;
}

}  // namespace fairlead::sim
