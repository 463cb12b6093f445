// check_arithmetic() where nothing departs from IEEE 754, and where the processor flushes small
// numbers to zero. The flags that depart from it: test_arithmetic_*.cpp, one each.
#include "fairlead/base/arithmetic.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

using namespace fairlead;

TEST(Arithmetic, IsExactHere) { EXPECT_EQ(check_arithmetic(), Arithmetic::exact); }

#ifdef __SSE__
TEST(Arithmetic, AProcessorThatFlushesIsFound) {
    const unsigned mode = _mm_getcsr();
    _mm_setcsr(mode | _MM_FLUSH_ZERO_ON);
    const Arithmetic found = check_arithmetic();
    _mm_setcsr(mode);
    EXPECT_EQ(found, Arithmetic::flushed);
    EXPECT_EQ(check_arithmetic(), Arithmetic::exact);
}
#endif

TEST(Arithmetic, EachDepartureHasItsName) {
    std::set<std::string> names;
    for (std::uint8_t i = 0; i <= 5; ++i) names.insert(to_string(static_cast<Arithmetic>(i)));
    EXPECT_EQ(names.size(), 6u);
    EXPECT_EQ(names.count("unknown"), 0u);
    EXPECT_STREQ(to_string(static_cast<Arithmetic>(6)), "unknown");
}
