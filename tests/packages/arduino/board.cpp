// A board for the example sketches, on the host: a clock that a loop() moves on by 200 us, a serial
// line that is the standard output, and an MPU-6050 on the I2C bus. The sensor lies still for four
// seconds, with 20 degrees of roll; then it turns at 30 degrees a second about the vertical. Runs
// the sketch for twelve seconds of its time.
#include <Arduino.h>
#include <Wire.h>

#include <array>
#include <cstdio>

HardwareSerial Serial;
TwoWire Wire;

namespace {

uint64_t now_us = 0xfffff000u;  // soon after the start the 32 bits of micros() wrap
const uint64_t start_us = now_us;
uint8_t pointer = 0, writes = 0, answer = 0;

double seconds() { return static_cast<double>(now_us - start_us) * 1e-6; }

/// The registers 0x3B to 0x48 at this moment: accelerometer, temperature, gyro, high byte first.
std::array<uint8_t, 14> measured() {
    const double roll = 20 * DEG_TO_RAD, g = 32768 / 4.0, turn = seconds() > 4 ? 30.0 : 0.0;
    const double per_degree = 32768 / 500.0;
    const std::array<double, 7> values{0,
                                       g * std::sin(roll),
                                       g * std::cos(roll),
                                       0,
                                       0,
                                       turn * std::sin(roll) * per_degree,
                                       turn * std::cos(roll) * per_degree};
    static uint32_t noise = 1;
    std::array<uint8_t, 14> bytes{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        noise = noise * 1664525u + 1013904223u;
        const double wander =
            static_cast<double>(noise >> 8) / 4194304 - 2;  // even, within 2 counts
        const auto count = static_cast<int16_t>(std::lround(values[i] + wander));
        bytes[2 * i] = static_cast<uint8_t>(count >> 8);
        bytes[2 * i + 1] = static_cast<uint8_t>(count & 0xff);
    }
    return bytes;
}
std::array<uint8_t, 14> held{};

}  // namespace

extern "C" {
unsigned long micros() { return static_cast<uint32_t>(now_us); }
unsigned long millis() { return static_cast<unsigned long>(now_us / 1000); }
void delay(unsigned long ms) { now_us += ms * 1000; }
void pinMode(uint8_t, uint8_t) {}
void digitalWrite(uint8_t, uint8_t) {}
int digitalRead(uint8_t) { return seconds() > 6 && seconds() < 7 ? LOW : HIGH; }
}

void HardwareSerial::begin(unsigned long) {}
size_t HardwareSerial::write(const uint8_t* data, size_t size) {
    return std::fwrite(data, 1, size, stdout);
}
size_t HardwareSerial::print(const char* text) {
    return static_cast<size_t>(std::printf("%s", text));
}
size_t HardwareSerial::print(char c) { return static_cast<size_t>(std::printf("%c", c)); }
size_t HardwareSerial::print(double value, int digits) {
    return static_cast<size_t>(std::printf("%.*f", digits, value));
}
size_t HardwareSerial::println(const char* text) {
    return static_cast<size_t>(std::printf("%s\n", text));
}

void TwoWire::begin() {}
void TwoWire::setClock(uint32_t) {}
void TwoWire::beginTransmission(uint8_t) { writes = 0; }
size_t TwoWire::write(uint8_t value) {
    if (writes++ == 0) pointer = value;
    return 1;
}
uint8_t TwoWire::endTransmission(bool) { return 0; }
size_t TwoWire::requestFrom(uint8_t address, size_t size) {
    answer = 0;
    held = measured();
    return address == 0x68 && pointer == 0x3B ? size : 0;
}
int TwoWire::read() { return held[answer++ % held.size()]; }

int main() {
    setup();
    for (; seconds() < 12; now_us += 200) loop();
}
