// Zephyr, I2C.
#include <cerrno>

#include "tests/docs/register_chip.hpp"

struct device {};
inline int i2c_write(const device*, const std::uint8_t* out, std::uint32_t size,
                     std::uint16_t address) {
    if (hal::chip.stuck) return -ETIMEDOUT;
    if (address != hal::chip_address) return -EIO;
    hal::chip.begin();
    for (std::uint32_t i = 0; i < size; ++i) hal::chip.put(out[i]);
    return 0;
}
inline int i2c_read(const device* bus, std::uint8_t* in, std::uint32_t size,
                    std::uint16_t address) {
    if (const int e = i2c_write(bus, nullptr, 0, address); e != 0) return e;
    for (std::uint32_t i = 0; i < size; ++i) in[i] = hal::chip.get();
    return 0;
}
inline int i2c_write_read(const device* bus, std::uint16_t address, const void* out,
                          std::size_t out_size, void* in, std::size_t in_size) {
    const int e = i2c_write(bus, static_cast<const std::uint8_t*>(out),
                            static_cast<std::uint32_t>(out_size), address);
    return e != 0 ? e
                  : i2c_read(bus, static_cast<std::uint8_t*>(in),
                             static_cast<std::uint32_t>(in_size), address);
}
inline std::int32_t k_usleep(std::int32_t us) {
    hal::chip.waited_us += static_cast<std::uint64_t>(us);
    return 0;
}

#include "example.inc"

int main() {
    const device i2c0{};
    ZephyrI2c bus{&i2c0};
    hal::check(bus, true);
}
