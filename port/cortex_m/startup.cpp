// The first instructions of any Cortex-M: vector table, FPU, then entry.hpp.
#include "port/cortex_m/entry.hpp"

extern "C" {
extern std::uint32_t link_stack_top;

[[noreturn]] void fault_handler() { fairlead::cortex_m::fault(); }
[[gnu::weak]] void systick_handler();  // an image that uses the timer brings its own
void systick_handler() { fault_handler(); }

[[noreturn]] void reset_handler() {
#if defined(__ARM_FP)
    // the FPU sleeps after reset: full access to coprocessors 10 and 11 (CPACR)
    *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFu << 20;
    __asm__ volatile("dsb\nisb" ::: "memory");
#endif
    fairlead::cortex_m::enter();
}
}  // extern "C"

struct Vectors {
    const std::uint32_t* stack_top;
    void (*handlers[15])();
};
extern const Vectors vectors;
[[gnu::section(".vectors"), gnu::used]] const Vectors vectors = {
    &link_stack_top,
    {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     fault_handler, nullptr, nullptr, nullptr, fault_handler, fault_handler, nullptr, fault_handler,
     systick_handler}};
