// The retarget layer for QEMU's mps2-an386 (Cortex-M4F): SysTick plays the tracker's data-ready
// interrupt, UART 0 is the CMSDK APB UART. The start-up code, yours from the vendor, is
// port/cortex_m/startup.cpp here.
#include "examples/firmware/motion.hpp"
#include "examples/firmware/retarget.hpp"
#include "fairlead/base/ring.hpp"
#include "port/cortex_m/semihosting.hpp"

namespace {

constexpr std::uint32_t core_hz = 25'000'000, records_per_s = 120;

volatile std::uint32_t& reg(std::uintptr_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
}
constexpr std::uintptr_t uart_data = 0x40004000, uart_state = 0x40004004, uart_control = 0x40004008,
                         uart_divider = 0x40004010;
constexpr std::uintptr_t systick_control = 0xE000E010, systick_reload = 0xE000E014,
                         systick_value = 0xE000E018;

// Times of records that wait to be read: written by the interrupt, emptied by next(), which holds
// the interrupt off while it takes one.
fairlead::Ring<std::int64_t, 8> queue;
volatile std::int64_t taken = 0;
volatile std::uint32_t lost = 0;

}  // namespace

extern "C" void systick_handler() {
    if (taken == motion::records) return;
    const std::int64_t n = taken;
    taken = n + 1;
    if (queue.full()) {
        lost = lost + 1;
        return;
    }
    queue.push(n * motion::step_ns);
}

namespace board {

void start() {
    reg(uart_divider) = 16;
    reg(uart_control) = 1;  // transmit
    reg(systick_reload) = core_hz / records_per_s - 1;
    reg(systick_value) = 0;
    reg(systick_control) = 7;  // core clock, interrupt, on
}

bool next(fairlead::Pose& record) {
    for (;;) {
        __asm__ volatile("cpsid i" ::: "memory");
        const bool some = !queue.empty(), over = taken == motion::records;
        std::int64_t t_ns = 0;
        if (some) {
            t_ns = queue.oldest();
            queue.pop();
        } else if (!over) {
            __asm__ volatile("wfi" ::: "memory");  // a pending interrupt wakes it, masked or not
        }
        __asm__ volatile("cpsie i" ::: "memory");
        if (some) record = motion::at(t_ns);  // here a real board reads its sensor
        if (some || over) return some;
    }
}

void send(const std::uint8_t* bytes, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
        while ((reg(uart_state) & 1) != 0) {  // the transmitter is full
        }
        reg(uart_data) = bytes[i];
    }
}

[[noreturn]] void stop() {
    if (lost != 0)
        fairlead::cortex_m::semihosting::print("records were lost: the queue was full\n");
    fairlead::cortex_m::semihosting::exit(lost != 0);
}

}  // namespace board
