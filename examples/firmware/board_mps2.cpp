// The retarget layer for QEMU's mps2-an386 (Cortex-M4F): SysTick plays the tracker's data-ready
// interrupt, UART 0 is the CMSDK APB UART. What a vendor's start-up code does is here, too.
#include "examples/firmware/motion.hpp"
#include "examples/firmware/retarget.hpp"
#include "fairlead/base/ring.hpp"
#include "port/cortex_m/entry.hpp"

namespace {

constexpr std::uint32_t core_hz = 25'000'000, records_per_s = 120;

volatile std::uint32_t& reg(std::uintptr_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
}
constexpr std::uintptr_t uart_data = 0x40004000, uart_state = 0x40004004, uart_control = 0x40004008,
                         uart_divider = 0x40004010;
constexpr std::uintptr_t systick_control = 0xE000E010, systick_reload = 0xE000E014,
                         systick_value = 0xE000E018, fpu_access = 0xE000ED88;

// Times of records that wait to be read: written by the interrupt, emptied by next(), which holds
// the interrupt off while it takes one.
fairlead::Ring<std::int64_t, 8> queue;
volatile std::int64_t taken = 0;
volatile std::uint32_t lost = 0;

void tracker_interrupt() {
    if (taken == motion::records) return;
    const std::int64_t n = taken;
    taken = n + 1;
    if (queue.full()) {
        lost = lost + 1;
        return;
    }
    queue.push(n * motion::step_ns);
}

[[noreturn]] void fault() { fairlead::cortex_m::fault(); }

}  // namespace

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

extern "C" {
extern std::uint32_t link_stack_top;

[[noreturn]] void reset_handler() {
    reg(fpu_access) = reg(fpu_access) | 0xFu << 20;
    __asm__ volatile("dsb\nisb" ::: "memory");
    fairlead::cortex_m::prepare_memory();
    image_main(0, nullptr);
    board::stop();
}
}

struct Vectors {
    const std::uint32_t* stack_top;
    void (*handlers[15])();
};
extern const Vectors vectors;
[[gnu::section(".vectors"), gnu::used]] const Vectors vectors = {
    &link_stack_top,
    {reset_handler, fault, fault, fault, fault, fault, fault, nullptr, nullptr, nullptr, fault,
     fault, nullptr, fault, tracker_interrupt}};
