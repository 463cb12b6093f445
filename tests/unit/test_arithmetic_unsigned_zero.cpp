// check_arithmetic() in a part of a program that is compiled with -fno-signed-zeros.
#include <gtest/gtest.h>

#include "fairlead/base/compiler.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#define check_arithmetic \
    check_arithmetic_unsigned_zero  // a function of its own beside the exact one
#pragma GCC push_options
#pragma GCC optimize("O2,no-signed-zeros")
#include "fairlead/base/arithmetic.hpp"
#pragma GCC pop_options

TEST(Arithmetic, UnsignedZeroIsFound) {
    // by its address: inlined, it would be compiled like this function
    fairlead::Arithmetic (*const volatile check)() noexcept = &fairlead::check_arithmetic;
    EXPECT_EQ(check(), fairlead::Arithmetic::unsigned_zero);
}
#endif
