// Two threads hand data over: nothing torn, nothing lost, nothing out of order. Run under TSan too.
#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "port/linux/handover.hpp"

namespace fairlead::port {
namespace {

TEST(TripleBuffer, TheReaderNeverSeesAMixtureAndNeverGoesBack) {
    using Block = std::array<std::uint32_t, 64>;
    TripleBuffer<Block> buffer;
    constexpr std::uint32_t last = 200'000;
    std::thread writer{[&] {
        Block block{};
        for (std::uint32_t n = 1; n <= last; ++n) {
            block.fill(n);
            buffer.write(block);
        }
    }};
    std::uint32_t newest = 0;
    std::uint64_t torn = 0;
    while (newest != last) {
        if (!buffer.refresh()) continue;
        const Block& block = buffer.value();
        for (const std::uint32_t word : block) torn += word != block[0] ? 1u : 0u;
        ASSERT_GT(block[0], newest);
        newest = block[0];
    }
    writer.join();
    EXPECT_EQ(torn, 0u);
    EXPECT_FALSE(buffer.refresh());
    EXPECT_EQ(buffer.value()[63], last);
}

TEST(Queue, KeepsOrderAndRefusesWhatDoesNotFit) {
    Queue<std::uint64_t, 64> queue;
    constexpr std::uint64_t last = 100'000;
    std::thread writer{[&] {
        for (std::uint64_t n = 1; n <= last;) {
            if (queue.push(n))
                ++n;
            else
                std::this_thread::yield();
        }
    }};
    std::uint64_t expected = 1;
    while (expected <= last) {
        std::uint64_t item = 0;
        if (!queue.pop(item)) {
            std::this_thread::yield();
            continue;
        }
        ASSERT_EQ(item, expected);
        ++expected;
    }
    writer.join();
    for (std::uint64_t n = 0; n < 64; ++n) EXPECT_TRUE(queue.push(n));
    EXPECT_FALSE(queue.push(64));
}

}  // namespace
}  // namespace fairlead::port
