#pragma once
// What every core does between its first instructions and main(): fill memory, construct.
#include <cstddef>
#include <cstdint>

#include "port/cortex_m/semihosting.hpp"

extern "C" {
extern std::uint32_t link_data_load, link_data_begin, link_data_end, link_bss_begin, link_bss_end;
extern void (*const link_init_begin[])();
extern void (*const link_init_end[])();
int image_main(int argc, char** argv) __asm__("main");  // C++ lets nobody call main by name
}

namespace fairlead::cortex_m {

[[noreturn]] inline void fault() noexcept {
    semihosting::print("fault: the core took an exception that nobody handles\n");
    semihosting::exit(99);
}

/// Initial values from flash, zeros, constructors.
inline void prepare_memory() noexcept {
    const std::uint32_t* from = &link_data_load;
    for (std::uint32_t* word = &link_data_begin; word < &link_data_end; ++word) *word = *from++;
    for (std::uint32_t* word = &link_bss_begin; word < &link_bss_end; ++word) *word = 0;
    for (auto init = link_init_begin; init != link_init_end; ++init) (*init)();
}

[[noreturn]] inline void enter() noexcept {
    prepare_memory();
    semihosting::exit(image_main(0, nullptr));
}

}  // namespace fairlead::cortex_m
