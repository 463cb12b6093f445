// Decimal numbers as integers: exact in every form, against long division of the text itself.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "host_sim/recording/decimal.hpp"

using namespace fairlead::sim;

TEST(Decimal, EveryFormIsExact) {
    const auto ns = [](const char* text) { return scaled_integer(text, 9).value_or(-777); };
    EXPECT_EQ(ns("1.403715529112143517e+09"), 1403715529112143517);
    EXPECT_EQ(ns("1403715529.112143517"), 1403715529112143517);
    EXPECT_EQ(ns("14037155291.12143517E-1"), 1403715529112143517);
    EXPECT_EQ(ns("0.00000000149"), 1);
    EXPECT_EQ(ns("0.0000000015"), 2);
    EXPECT_EQ(ns("-0.0000000015"), -2);
    EXPECT_EQ(ns("+5."), 5000000000);
    EXPECT_EQ(ns(".5"), 500000000);
    EXPECT_EQ(ns("0e999999"), 0);
    EXPECT_EQ(ns("1e-999999"), 0);
    EXPECT_EQ(ns("-9223372036.854775808"), INT64_MIN);
    EXPECT_EQ(ns("9223372036.854775807"), INT64_MAX);
    for (const char* bad : {"", "+", ".", "e5", "1e", "1e+", "--1", "1.2.3", "0x10", "1 2", "nan",
                            "9223372036.854775808", "-9223372036.854775809", "1e10", "1e99999"})
        EXPECT_FALSE(scaled_integer(bad, 9).has_value()) << bad;
    EXPECT_EQ(last_place("1.30503e+09"), 4);
    EXPECT_EQ(last_place("1.25"), -2);
    EXPECT_EQ(last_place("17"), 0);
}

/// A random integer, written with a random place of the point and the exponent that undoes it.
TEST(Decimal, AnyPlaceOfThePointGivesTheSameInteger) {
    std::mt19937_64 random{11};
    for (int trial = 0; trial < 20000; ++trial) {
        const auto value = static_cast<std::int64_t>(random() >> (1 + random() % 60));
        std::string digits = std::to_string(value);
        digits.insert(0, random() % 4, '0');
        const std::size_t point = random() % (digits.size() + 1);
        const int exponent = static_cast<int>(digits.size() - point);
        const int shift = static_cast<int>(random() % 10);
        const std::string text = (random() % 2 ? "-" : "") + digits.substr(0, point) + "." +
                                 digits.substr(point) + "e" + std::to_string(exponent - shift);
        const auto read = scaled_integer(text, shift);
        ASSERT_TRUE(read.has_value()) << text;
        ASSERT_EQ(*read, text[0] == '-' ? -value : value) << text;
    }
}
