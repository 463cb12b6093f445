// check_arithmetic() in a part of a program that is compiled with -ffp-contract=fast, on a
// processor with fused multiply-add.
#include <gtest/gtest.h>

#include "fairlead/base/compiler.hpp"

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__)
#define check_arithmetic check_arithmetic_fused  // a function of its own beside the exact one
#pragma GCC push_options
#pragma GCC optimize("O2,fp-contract=fast")
#pragma GCC target("fma")
#include "fairlead/base/arithmetic.hpp"
#pragma GCC pop_options

TEST(Arithmetic, FusedIsFound) {
    if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "no fused multiply-add";
    // by its address: inlined, it would be compiled like this function
    fairlead::Arithmetic (*const volatile check)() noexcept = &fairlead::check_arithmetic;
    EXPECT_EQ(check(), fairlead::Arithmetic::fused);
}
#endif
