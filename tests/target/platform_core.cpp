#include <cstdint>

#include "port/cortex_m/mark.hpp"
#include "port/cortex_m/semihosting.hpp"
#include "tests/target/platform.hpp"

namespace fairlead::target::platform {

namespace semihosting = cortex_m::semihosting;

void command_line(int& argc, char**& argv) {
    static char line[512];
    static char* words[16];
    argc = semihosting::command_line(line, sizeof line, words, 16);
    argv = words;
}
int open_to_read(const char* path) { return semihosting::open(path, semihosting::Mode::read); }
int open_to_write(const char* path) { return semihosting::open(path, semihosting::Mode::write); }
std::size_t read(int file, void* to, std::size_t size) { return semihosting::read(file, to, size); }
bool write(int file, const void* from, std::size_t size) {
    return semihosting::write(file, from, size);
}
void close(int file) { semihosting::close(file); }
void complain(const char* text) { semihosting::print(text); }

namespace {

// The stage's own stack, painted once: what it leaves untouched was never used. Nobody else writes
// here, so the depth is the stage's alone.
constexpr std::uint32_t paint = 0xC5C5C5C5;
constexpr std::size_t stack_words = 2048;  // STACK_SIZE of measure.py, in words
alignas(16) std::uint32_t stack[stack_words];
bool painted = false;

void paint_stack() {
    for (std::uint32_t& word : stack) word = paint;
    painted = true;
}

}  // namespace

void call_marked(void (*f)(const void*), const void* argument) {
    if (!painted) paint_stack();
    std::uint32_t* const top = stack + stack_words;
#if defined(__riscv)
    register const void* a0 __asm__("a0") = argument;
    __asm__ volatile("mv s1, sp\nmv sp, %[top]\n" FAIRLEAD_MARK_BEGIN
                     "jalr %[f]\n" FAIRLEAD_MARK_END "mv sp, s1\n"
                     : "+r"(a0)
                     : [f] "r"(f), [top] "r"(top)
                     : "memory", "ra", "s1", "t0", "t1", "t2", "t3", "t4", "t5", "t6", "a1", "a2",
                       "a3", "a4", "a5", "a6", "a7"
#if defined(__riscv_flen)
                       ,
                       "ft0", "ft1", "ft2", "ft3", "ft4", "ft5", "ft6", "ft7", "ft8", "ft9", "ft10",
                       "ft11", "fa0", "fa1", "fa2", "fa3", "fa4", "fa5", "fa6", "fa7"
#endif
    );
#else
    register const void* r0 __asm__("r0") = argument;
    register void (*function)(const void*) __asm__("r5") = f;
    register std::uint32_t* stack_top __asm__("r6") = top;
    __asm__ volatile("mov r4, sp\nmov sp, %[top]\n" FAIRLEAD_MARK_BEGIN
                     "blx %[f]\n" FAIRLEAD_MARK_END "mov sp, r4\n"
                     : "+r"(r0)
                     : [f] "r"(function), [top] "r"(stack_top)
                     : "memory", "cc", "r1", "r2", "r3", "r4", "r12", "lr"
#if defined(__ARM_FP)
                       ,
                       "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10", "s11",
                       "s12", "s13", "s14", "s15"
#endif
    );
#endif
}

std::size_t stack_used() {
    std::size_t untouched = 0;
    while (painted && untouched < stack_words && stack[untouched] == paint) ++untouched;
    return painted ? sizeof stack - untouched * sizeof stack[0] : 0;
}

}  // namespace fairlead::target::platform
