// The sealed heap itself: it must stop every kind of allocation, and only while it is sealed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <string>

#include "host_sim/replay/seal.hpp"

using fairlead::sim::HeapSeal;

namespace {

void* volatile sink;  // keeps the compilers from leaving an allocation out

template <class Allocate>
void sealed(Allocate allocate) {
    HeapSeal seal;
    sink = allocate();
}

}  // namespace

TEST(HeapSeal, StopsEveryKindOfAllocation) {
    const char* const words = "the heap is sealed";
    EXPECT_DEATH(sealed([] { return std::malloc(8); }), words);
    EXPECT_DEATH(sealed([] { return std::calloc(2, 8); }), words);
    EXPECT_DEATH(sealed([] { return std::aligned_alloc(64, 64); }), words);
    EXPECT_DEATH(sealed([] { return ::operator new(8); }), words);
    EXPECT_DEATH(sealed([] { return ::operator new[](8, std::nothrow); }), words);
    EXPECT_DEATH(sealed([] { return ::operator new (64, std::align_val_t{64}); }), words);
    EXPECT_DEATH(sealed([] {
                     static std::string text;
                     text.assign(1000, 'x');
                     return text.data();
                 }),
                 words);
    void* const old = std::malloc(8);
    EXPECT_DEATH(sealed([old] { return std::realloc(old, 100000); }), words);
    std::free(old);
}

TEST(HeapSeal, OpensAgain) {
    { HeapSeal seal; }
    void* const p = std::malloc(8);
    EXPECT_NE(p, nullptr);
    std::free(p);
}
