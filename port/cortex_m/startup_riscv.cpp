// The first instructions of an RV32 core: stack, global pointer, FPU, then entry.hpp.
#include "port/cortex_m/entry.hpp"

extern "C" {
[[noreturn, gnu::aligned(4), gnu::used]] void fault_handler() { fairlead::cortex_m::fault(); }
[[noreturn, gnu::used]] void enter_handler() { fairlead::cortex_m::enter(); }

// mstatus.FS wakes the FPU where there is one; mtvec catches faults
[[gnu::naked, gnu::section(".vectors"), gnu::used]] void reset_handler() {
    __asm__ volatile(
        ".option push\n.option arch, +zicsr\n.option norelax\nla gp, __global_pointer$\n"
        "la sp, link_stack_top\nla t0, fault_handler\ncsrw mtvec, t0\n"
        "li t0, 0x2000\ncsrs mstatus, t0\nj enter_handler\n.option pop");
}
}  // extern "C"
