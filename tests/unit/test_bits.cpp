// Bits packed and unpacked, against a string of '0' and '1'; past the end of the memory, too.
#include "fairlead/wire/bits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace fairlead;

std::string text_of(std::uint32_t v, unsigned n) {
    std::string text;
    while (n-- > 0) text += (v >> n & 1u) != 0 ? '1' : '0';
    return text;
}
std::string text_of(const std::vector<std::uint8_t>& bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes) text += text_of(byte, 8);
    return text;
}

TEST(Bits, ComeOutAsTheyWentInAndStandWhereTheyShould) {
    std::mt19937 random{11};
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<std::uint8_t> memory(1 + random() % 40, 0xA5);  // old contents must not matter
        std::vector<std::pair<std::uint32_t, unsigned>> put;
        std::string text;
        BitWriter out{memory.data(), memory.size()};
        while (out.ok()) {
            const unsigned n = static_cast<unsigned>(random() % 33);
            auto v = static_cast<std::uint32_t>(random());
            out.bits(v, n);
            put.emplace_back(v, n);
            text += text_of(v, n);
            ASSERT_EQ(out.ok(), text.size() <= 8 * memory.size());
            ASSERT_EQ(out.size(), std::min((text.size() + 7) / 8, memory.size()));
        }
        ASSERT_EQ(text_of(memory), text.substr(0, 8 * memory.size()));
        BitReader in{memory.data(), memory.size()};
        for (const auto& [v, n] : put) {
            std::uint32_t got = 0xdeadbeef;
            const std::size_t from = in.used_bits();
            in.bits(got, n);
            std::string want = text.substr(from, n);
            if (from + n > 8 * memory.size()) want.replace(8 * memory.size() - from, n, n, '0');
            ASSERT_EQ(text_of(got, n), want.substr(0, n));  // zeros past the end
            ASSERT_EQ(got, n < 32 ? got & ((1u << n) - 1u) : got);
            ASSERT_EQ(in.ok(), from + n <= 8 * memory.size());
        }
    }
}

TEST(Bits, RiceCodesComeOutAsTheyWentIn) {
    std::mt19937 random{12};
    for (int trial = 0; trial < 500; ++trial) {
        std::vector<std::uint8_t> memory(4000);
        std::vector<std::uint32_t> put;
        BitWriter out{memory.data(), memory.size()};
        RiceModel model;
        for (int i = 0; i < 300; ++i) {
            std::uint32_t v = static_cast<std::uint32_t>(random()) >> random() % 32;
            put.push_back(v);
            out.rice(v, model);
            ASSERT_EQ(v, put.back());
        }
        ASSERT_TRUE(out.ok());
        BitReader in{memory.data(), out.size()};
        RiceModel same;
        for (const std::uint32_t v : put) {
            std::uint32_t got = 0;
            in.rice(got, same);
            ASSERT_EQ(got, v);
        }
        ASSERT_EQ(same.mean16, model.mean16);
        ASSERT_LT(8 * out.size() - in.used_bits(), 8u);
    }
}

TEST(Bits, ARiceCodeIsOnesAZeroAndTheRest) {
    for (const auto& [v, text] : {std::pair{0u, "0000"},
                                  {5u, "0101"},
                                  {8u, "10000"},
                                  {27u, "1110011"},
                                  {160u, "11111111111111111111"}}) {
        std::vector<std::uint8_t> memory(8);
        BitWriter out{memory.data(), memory.size()};
        RiceModel model{16 * 8};  // three bits below the ones
        std::uint32_t value = v;
        out.rice(value, model);
        const std::string want = v < 160 ? text : text + text_of(v, 32);
        ASSERT_EQ(text_of(memory).substr(0, want.size()), want);
        ASSERT_EQ(out.size(), (want.size() + 7) / 8);
    }
}

TEST(Bits, WidthIsTheNumberOfBitsThatMatter) {
    EXPECT_EQ(bit_width(std::uint64_t{0}), 0u);
    for (unsigned n = 0; n < 64; ++n) {
        EXPECT_EQ(bit_width(std::uint64_t{1} << n), n + 1);
        EXPECT_EQ(bit_width((std::uint64_t{2} << n) - 1), n + 1);
        EXPECT_EQ(bit_width(std::uint32_t{1} << n % 32), n % 32 + 1);
    }
}

}  // namespace
