// check_arithmetic() in a part of a program that is compiled with -freciprocal-math.
#include <gtest/gtest.h>

#include "fairlead/base/compiler.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#define check_arithmetic check_arithmetic_inverted  // a function of its own beside the exact one
#pragma GCC push_options
#pragma GCC optimize("O2,reciprocal-math")
#include "fairlead/base/arithmetic.hpp"
#pragma GCC pop_options

TEST(Arithmetic, InvertedIsFound) {
    // by its address: inlined, it would be compiled like this function
    fairlead::Arithmetic (*const volatile check)() noexcept = &fairlead::check_arithmetic;
    EXPECT_EQ(check(), fairlead::Arithmetic::inverted);
}
#endif
