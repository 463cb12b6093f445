// Pieces of code whose instructions are known by counting them on paper: what the plugin must find.
#include "port/cortex_m/mark.hpp"

namespace {

using fairlead::cortex_m::mark_begin;
using fairlead::cortex_m::mark_end;

#if defined(__riscv)
#define LOOP_OF(n) "li t0, " #n "\n1: addi t0, t0, -1\nbnez t0, 1b"
#define CLOBBERED "t0"
#else
#define LOOP_OF(n) ".syntax unified\nmovs r3, #" #n "\n1: subs r3, #1\nbne 1b"
#define CLOBBERED "r3", "cc"
#endif

}  // namespace

int main(int, char**) {
    for (int i = 0; i < 3; ++i) {
        mark_begin();
        mark_end();  // 0
        mark_begin();
        __asm__ volatile("nop");
        mark_end();  // 1
        mark_begin();
        __asm__ volatile("nop\nnop\nnop\nnop\nnop\nnop\nnop");
        mark_end();  // 7
        mark_begin();
        __asm__ volatile(LOOP_OF(250)::: CLOBBERED);
        mark_end();  // 1 + 2 * 250
    }
    return 0;
}
