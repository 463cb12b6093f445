// Arduino, Wire.
#include "tests/docs/register_chip.hpp"

struct TwoWire {
    std::uint8_t address{};
    std::array<std::uint8_t, 32> out{};
    std::size_t size{};
    void beginTransmission(std::uint8_t to) {
        address = to;
        size = 0;
    }
    std::size_t write(const std::uint8_t* bytes, std::size_t n) {
        const std::size_t room = out.size() - size, taken = n < room ? n : room;
        for (std::size_t i = 0; i < taken; ++i) out[size++] = bytes[i];
        return taken;
    }
    std::uint8_t endTransmission(bool) {
        if (hal::chip.stuck) return 5;
        if (address != hal::chip_address) return 2;
        hal::chip.begin();
        for (std::size_t i = 0; i < size; ++i) hal::chip.put(out[i]);
        return 0;
    }
    std::uint8_t requestFrom(std::uint8_t from, std::uint8_t n) {
        return from == hal::chip_address ? n : std::uint8_t{0};
    }
    int read() { return hal::chip.get(); }
};
inline TwoWire Wire;
inline void delay(std::uint32_t ms) { hal::chip.waited_us += 1000ull * ms; }
inline void delayMicroseconds(std::uint32_t us) { hal::chip.waited_us += us; }

#include "example.inc"

int main() {
    ArduinoI2c bus;
    hal::check(bus, true);
    const std::array<std::uint8_t, 40> much{};
    const fairlead::port::Transfer write{hal::chip_address, much.data(), 40, nullptr, 0};
    hal::require(bus.transfer(&write, 1) == fairlead::Status::bad_argument, "a write too long");
}
