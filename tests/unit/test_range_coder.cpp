// The range coder: round trips, cost near the information, shortest ending, any bytes are harmless.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fairlead/code/range_coder.hpp"

namespace {
using fairlead::code::RangeDecoder;
using fairlead::code::RangeEncoder;

struct Dice {  // numbers of 32 bits
    std::mt19937 engine;
    std::uint32_t operator()() { return static_cast<std::uint32_t>(engine()); }
};

struct Symbol {
    std::uint32_t cum, freq;
    unsigned bits;
};

std::vector<Symbol> random_symbols(Dice& random, std::size_t n) {
    std::vector<Symbol> symbols;
    for (std::size_t i = 0; i < n; ++i) {
        const unsigned bits = 1 + random() % 15;
        const std::uint32_t total = 1u << bits;
        // often extreme: the first, the last, the rarest and the likeliest symbol
        std::uint32_t cum = random() % total;
        if (random() % 4 == 0) cum = 0;
        std::uint32_t freq = 1 + random() % (total - cum);
        if (random() % 4 == 0) freq = total - cum;
        if (random() % 4 == 0) freq = 1;
        symbols.push_back({cum, freq, bits});
    }
    return symbols;
}

TEST(RangeCoder, GivesBackWhatWasPut) {
    Dice random{std::mt19937{1}};
    for (int run = 0; run < 20000; ++run) {
        const auto symbols = random_symbols(random, random() % 40);
        std::vector<std::uint8_t> bytes(200);
        RangeEncoder encoder{bytes.data(), bytes.size()};
        double information = 0;
        for (const Symbol& s : symbols) {
            encoder.put(s.cum, s.freq, s.bits);
            information += s.bits - std::log2(s.freq);
        }
        const std::size_t size = encoder.finish();
        ASSERT_TRUE(encoder.ok());
        // 0.003 bits a symbol are lost by 32-bit arithmetic, and less than a byte by the ending
        EXPECT_LE(static_cast<double>(size),
                  1 + (information + 0.003 * static_cast<double>(symbols.size())) / 8 + 1e-9)
            << run;
        RangeDecoder decoder{bytes.data(), size};
        for (const Symbol& s : symbols) {
            const std::uint32_t place = decoder.peek(s.bits);
            ASSERT_GE(place, s.cum) << run;
            ASSERT_LT(place, s.cum + s.freq) << run;
            decoder.take(s.cum, s.freq, s.bits);
        }
        EXPECT_TRUE(decoder.finished()) << run;
    }
}

TEST(RangeCoder, ARangeOfExactlyTheLeastIsNotWidened) {
    // 2^32 - 1, 2^25 - 1, 2^24 + 6143, then 2^24: what the third symbol leaves is still enough
    const Symbol symbols[] = {{77, 1, 7}, {1234, 2049, 12}, {0, 8192, 13}, {3, 5, 4}, {999, 1, 11}};
    std::vector<std::uint8_t> bytes(40);
    RangeEncoder encoder{bytes.data(), bytes.size()};
    const std::size_t sizes[] = {0, 0, 0, 1, 2};
    for (std::size_t i = 0; i < 5; ++i) {
        encoder.put(symbols[i].cum, symbols[i].freq, symbols[i].bits);
        EXPECT_EQ(encoder.size(), sizes[i]) << i;
    }
    RangeDecoder decoder{bytes.data(), encoder.finish()};
    for (const Symbol& s : symbols) {
        const std::uint32_t place = decoder.peek(s.bits);
        EXPECT_TRUE(place >= s.cum && place < s.cum + s.freq);
        decoder.take(s.cum, s.freq, s.bits);
    }
    EXPECT_TRUE(decoder.finished());
}

TEST(RangeCoder, KnowsItsOwnEnding) {
    Dice random{std::mt19937{2}};
    int passed = 0, tried = 0;
    for (int run = 0; run < 5000; ++run) {
        const auto symbols = random_symbols(random, 1 + random() % 20);
        std::vector<std::uint8_t> bytes(120);
        RangeEncoder encoder{bytes.data(), bytes.size()};
        for (const Symbol& s : symbols) encoder.put(s.cum, s.freq, s.bits);
        const std::size_t size = encoder.finish();
        const auto accepts = [&](std::size_t n) {
            RangeDecoder decoder{bytes.data(), n};
            for (const Symbol& s : symbols) {
                const std::uint32_t place = decoder.peek(s.bits);
                if (place < s.cum || place >= s.cum + s.freq) return false;
                decoder.take(s.cum, s.freq, s.bits);
            }
            return decoder.finished();
        };
        ASSERT_TRUE(accepts(size));
        EXPECT_FALSE(accepts(size + 1)) << "a zero too many";
        bytes[size] = 1;
        EXPECT_FALSE(accepts(size + 1)) << "a byte too many";
        bytes[size] = 0;
        EXPECT_FALSE(accepts(size - 1)) << "a byte too few";
        // another last byte decodes to the same symbols at times, and is no ending of theirs
        const std::uint8_t last = bytes[size - 1];
        for (int v = 0; v < 256; ++v) {
            bytes[size - 1] = static_cast<std::uint8_t>(v);
            if (v != last) ++tried, passed += accepts(size);
        }
    }
    EXPECT_EQ(passed, 0) << "of " << tried;
}

TEST(RangeCoder, EmptyRunIsOneByte) {
    std::uint8_t byte = 0xee;
    RangeEncoder encoder{&byte, 1};
    EXPECT_EQ(encoder.finish(), 1u);
    EXPECT_EQ(byte, 0);
    RangeDecoder decoder{&byte, 1};
    EXPECT_TRUE(decoder.finished());
    EXPECT_FALSE(RangeDecoder(&byte, 0).finished());
}

TEST(RangeCoder, CarriesThroughManyBytes) {
    // the highest symbol of each total: a value just below 1, then a step that runs over
    std::vector<std::uint8_t> bytes(64);
    RangeEncoder encoder{bytes.data(), bytes.size()};
    std::vector<Symbol> symbols;
    for (int i = 0; i < 12; ++i) symbols.push_back({(1u << 15) - 1u, 1, 15});
    symbols.push_back({1, 1, 1});
    for (const Symbol& s : symbols) encoder.put(s.cum, s.freq, s.bits);
    RangeDecoder decoder{bytes.data(), encoder.finish()};
    for (const Symbol& s : symbols) {
        EXPECT_EQ(decoder.peek(s.bits), s.cum);
        decoder.take(s.cum, s.freq, s.bits);
    }
    EXPECT_TRUE(decoder.finished());
}

TEST(RangeCoder, WritesNothingBehindItsMemory) {
    for (std::size_t capacity = 0; capacity < 12; ++capacity) {
        std::vector<std::uint8_t> bytes(16, 0xaa);
        RangeEncoder encoder{bytes.data(), capacity};
        for (int i = 0; i < 40; ++i) encoder.put(static_cast<std::uint32_t>(i * 37 % 256), 1, 8);
        encoder.finish();
        EXPECT_FALSE(encoder.ok());
        for (std::size_t i = capacity; i < bytes.size(); ++i) EXPECT_EQ(bytes[i], 0xaa);
    }
}

TEST(RangeCoder, NumbersAndFlags) {
    Dice random{std::mt19937{4}};
    for (int run = 0; run < 3000; ++run) {
        struct Item {
            std::uint32_t v;
            unsigned n;
            bool golomb, flag;
        };
        std::vector<Item> items;
        for (unsigned i = random() % 20; i > 0; --i) {
            const unsigned n = random() % 33;
            const std::uint32_t mask = n == 32 ? 0xffffffffu : (1u << n) - 1u;
            const bool golomb = random() % 2;
            items.push_back({static_cast<std::uint32_t>(random()) & mask, golomb ? n % 12 : n,
                             golomb, random() % 2 == 0});
        }
        std::vector<std::uint8_t> bytes(400);
        RangeEncoder encoder{bytes.data(), bytes.size()};
        for (Item& item : items) {
            if (item.golomb)
                EXPECT_TRUE(fairlead::code::exp_golomb(encoder, item.v, item.n));
            else
                encoder.bits(item.v, item.n);
            encoder.flag(item.flag, 3, 4);
        }
        RangeDecoder decoder{bytes.data(), encoder.finish()};
        for (const Item& item : items) {
            std::uint32_t v = 0;
            if (item.golomb)
                EXPECT_TRUE(fairlead::code::exp_golomb(decoder, v, item.n));
            else
                decoder.bits(v, item.n);
            EXPECT_EQ(v, item.v);
            bool flag = false;
            decoder.flag(flag, 3, 4);
            EXPECT_EQ(flag, item.flag);
        }
        EXPECT_TRUE(decoder.finished());
    }
}

TEST(RangeCoder, GolombCostsWhatItSays) {
    for (unsigned k = 0; k < 10; ++k) {
        for (std::uint32_t v : {0u, 1u, 2u, 7u, 100u, 5000u, 0xfffffu}) {
            std::vector<std::uint8_t> bytes(80);
            RangeEncoder encoder{bytes.data(), bytes.size()};
            for (int i = 0; i < 8; ++i) fairlead::code::exp_golomb(encoder, v, k);
            unsigned more = 0;
            while ((std::uint64_t{v} + (1u << k)) >> (more + k + 1)) ++more;
            // eight of them: as many bytes as one has bits, fewer where zeros end them
            EXPECT_LE(encoder.finish(), 2 * more + k + 1 + 1);
        }
    }
}

TEST(RangeCoder, AnyBytesDecodeToSomething) {
    Dice random{std::mt19937{5}};
    int finished = 0;
    for (int run = 0; run < 20000; ++run) {
        std::vector<std::uint8_t> bytes(random() % 8);
        for (auto& b : bytes) b = static_cast<std::uint8_t>(random() % 3 == 0 ? 255 : random());
        RangeDecoder decoder{bytes.data(), bytes.size()};
        for (int i = 0; i < 60; ++i) {
            const unsigned bits = 1 + random() % 15;
            const std::uint32_t place = decoder.peek(bits);
            ASSERT_LT(place, 1u << bits);
            decoder.take(place, 1, bits);
        }
        finished += decoder.finished();
    }
    EXPECT_LT(finished, 100) << "random bytes rarely look like what an encoder writes";
}

}  // namespace
