// The library's own conversion, bit for bit as the compiler's.
#include "fairlead/base/convert.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>

namespace {

void same(std::int64_t v) {
    const float ours = fairlead::to_float(v), theirs = static_cast<float>(v);
    ASSERT_EQ(std::memcmp(&ours, &theirs, sizeof ours), 0) << v;
}

TEST(Convert, AnyTimeIsRoundedLikeTheCompilerDoes) {
    for (const std::int64_t v : {std::int64_t{0}, std::numeric_limits<std::int64_t>::min(),
                                 std::numeric_limits<std::int64_t>::max()})
        same(v);
    for (unsigned bit = 0; bit < 63; ++bit)
        for (std::int64_t low = -3; low <= 3; ++low)
            for (const std::int64_t v :
                 {(std::int64_t{1} << bit) + low, -(std::int64_t{1} << bit) + low})
                same(v);
    for (unsigned bit = 0; bit < 38; ++bit)  // halfway between two floats, and a last bit off
        for (std::int64_t odd = 0; odd < 4; ++odd)
            for (std::int64_t low = -1; low <= 1; ++low) {
                const std::int64_t half = (((std::int64_t{1} << 23) + odd) * 2 + 1) << bit;
                same(half + low);
                same(-half + low);
            }
    const std::random_device::result_type seed = std::random_device{}();
    std::mt19937_64 random{seed};
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    for (int i = 0; i < 200000; ++i) same(static_cast<std::int64_t>(random()) >> random() % 64);
}

}  // namespace
