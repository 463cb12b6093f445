// Arduino, SPI.
#include "port/sensors/spi.hpp"
#include "tests/docs/register_chip.hpp"

enum BitOrder { LSBFIRST, MSBFIRST };
enum Level { LOW, HIGH };
#define SPI_MODE3 0x0C
struct SPISettings {
    SPISettings(std::uint32_t, BitOrder, int) {}
};
inline bool selected = false, first = false;
inline void digitalWrite(int, Level level) {
    selected = level == LOW;
    first = true;
    hal::chip.begin();
}
struct SpiClass {
    bool reading{};
    void beginTransaction(const SPISettings&) {}
    void endTransaction() { assert(!selected); }
    std::uint8_t transfer(int byte) {
        assert(selected);
        if (first) reading = (byte & 0x80) != 0;
        if (!first && reading) return hal::chip.get();
        hal::chip.put(static_cast<std::uint8_t>(first ? byte & 0x7F : byte));
        first = false;
        return 0xFF;
    }
};
inline SpiClass SPI;
inline void delay(std::uint32_t ms) { hal::chip.waited_us += 1000ull * ms; }
inline void delayMicroseconds(std::uint32_t us) { hal::chip.waited_us += us; }

#include "example.inc"

int main() {
    ArduinoSpiWire wire{10};
    fairlead::port::SpiBus<ArduinoSpiWire> bus{wire, fairlead::port::SpiStyle{1000000, 0, 0}};
    hal::check(bus, false);
}
