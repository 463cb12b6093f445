// ESP-IDF, I2C.
#include "tests/docs/register_chip.hpp"

using esp_err_t = int;
using TickType_t = std::uint32_t;
enum i2c_port_t { I2C_NUM_0 };
#define ESP_OK 0
#define ESP_FAIL (-1)
#define ESP_ERR_TIMEOUT 0x107
#define pdMS_TO_TICKS(ms) (static_cast<TickType_t>(ms) / 10)  // the default tick of 100 Hz
inline esp_err_t write_bytes(std::uint8_t address, const std::uint8_t* out, std::size_t size) {
    if (hal::chip.stuck) return ESP_ERR_TIMEOUT;
    if (address != hal::chip_address) return ESP_FAIL;
    hal::chip.begin();
    for (std::size_t i = 0; i < size; ++i) hal::chip.put(out[i]);
    return ESP_OK;
}
inline esp_err_t i2c_master_write_to_device(i2c_port_t, std::uint8_t address,
                                            const std::uint8_t* out, std::size_t size,
                                            TickType_t ticks) {
    assert(ticks > 0);
    return write_bytes(address, out, size);
}
inline esp_err_t i2c_master_read_from_device(i2c_port_t, std::uint8_t address, std::uint8_t* in,
                                             std::size_t size, TickType_t) {
    if (const esp_err_t e = write_bytes(address, nullptr, 0); e != ESP_OK) return e;
    for (std::size_t i = 0; i < size; ++i) in[i] = hal::chip.get();
    return ESP_OK;
}
inline esp_err_t i2c_master_write_read_device(i2c_port_t port, std::uint8_t address,
                                              const std::uint8_t* out, std::size_t out_size,
                                              std::uint8_t* in, std::size_t in_size,
                                              TickType_t ticks) {
    if (const esp_err_t e = write_bytes(address, out, out_size); e != ESP_OK) return e;
    return i2c_master_read_from_device(port, address, in, in_size, ticks);
}
inline void esp_rom_delay_us(std::uint32_t us) { hal::chip.waited_us += us; }
/// The first tick may be nearly over: n ticks last more than n - 1 periods.
inline void vTaskDelay(TickType_t ticks) { hal::chip.waited_us += 10000ull * (ticks - 1); }

#include "example.inc"

int main() {
    EspI2c bus{I2C_NUM_0};
    hal::check(bus, true);
}
