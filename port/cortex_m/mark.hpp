#pragma once
// Markers around a piece of code whose instructions are to be counted. Each is one instruction that
// does nothing, known to the counting plugin (tests/target/count.c); on any other machine it
// vanishes. They nest not at all: the count runs from a begin to the next end, both excluded.

#if defined(__arm__)
#define FAIRLEAD_MARK_BEGIN ".inst.n 0x46d2\n"  // mov r10, r10: exists on every Thumb core
#define FAIRLEAD_MARK_END ".inst.n 0x46db\n"    // mov r11, r11
#elif defined(__riscv)
#define FAIRLEAD_MARK_BEGIN ".word 0x00102013\n"  // slti x0, x0, 1: a hint that does nothing
#define FAIRLEAD_MARK_END ".word 0x00202013\n"    // slti x0, x0, 2
#else
#define FAIRLEAD_MARK_BEGIN
#define FAIRLEAD_MARK_END
#endif

namespace fairlead::cortex_m {

inline void mark_begin() noexcept { __asm__ volatile(FAIRLEAD_MARK_BEGIN ::: "memory"); }
inline void mark_end() noexcept { __asm__ volatile(FAIRLEAD_MARK_END ::: "memory"); }

}  // namespace fairlead::cortex_m
