#include <gtest/gtest.h>

#include "fairlead/base/ring.hpp"

using fairlead::Ring;

TEST(Ring, KeepsOrderAcrossTheWrap) {
    Ring<int, 5> ring;
    int next = 0, oldest = 0;
    for (int step = 0; step < 100; ++step) {
        while (!ring.full()) ring.push(next++);
        for (std::size_t i = 0; i < ring.size(); ++i)
            ASSERT_EQ(ring[i], oldest + static_cast<int>(i));
        const auto drop = static_cast<std::size_t>(step % 6);
        ring.pop(drop);
        oldest += static_cast<int>(drop);
        EXPECT_EQ(ring.size(), 5 - drop);
    }
}

TEST(Ring, RefusesWhatItCannotHold) {
    Ring<int, 2> ring;
    ring.push(1);
    ring.push(2);
    EXPECT_TRUE(ring.full());
    EXPECT_DEATH(ring.push(3), "");
    EXPECT_DEATH(ring.pop(3), "");
    EXPECT_DEATH(static_cast<void>(ring[2]), "");
}
