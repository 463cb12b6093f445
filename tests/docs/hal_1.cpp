// STM32 HAL, I2C.
#include "tests/docs/register_chip.hpp"

enum HAL_StatusTypeDef { HAL_OK, HAL_ERROR, HAL_BUSY, HAL_TIMEOUT };
struct I2C_HandleTypeDef {
    std::uint32_t error;
};
#define HAL_I2C_ERROR_AF 4u  // no acknowledge
inline std::uint32_t HAL_I2C_GetError(I2C_HandleTypeDef* i2c) { return i2c->error; }
inline HAL_StatusTypeDef addressed(I2C_HandleTypeDef* i2c, std::uint16_t address) {
    if (hal::chip.stuck) return HAL_TIMEOUT;
    i2c->error = address == hal::chip_address << 1 ? 0 : HAL_I2C_ERROR_AF;
    hal::chip.begin();
    return i2c->error == 0 ? HAL_OK : HAL_ERROR;
}
inline HAL_StatusTypeDef HAL_I2C_Mem_Read(I2C_HandleTypeDef* i2c, std::uint16_t address,
                                          std::uint16_t reg, std::uint16_t reg_size,
                                          std::uint8_t* data, std::uint16_t size, std::uint32_t) {
    if (const auto s = addressed(i2c, address); s != HAL_OK) return s;
    assert(reg_size == 1);  // I2C_MEMADD_SIZE_8BIT
    hal::chip.put(static_cast<std::uint8_t>(reg));
    for (std::uint16_t i = 0; i < size; ++i) data[i] = hal::chip.get();
    return HAL_OK;
}
inline HAL_StatusTypeDef HAL_I2C_Master_Transmit(I2C_HandleTypeDef* i2c, std::uint16_t address,
                                                 std::uint8_t* data, std::uint16_t size,
                                                 std::uint32_t) {
    if (const auto s = addressed(i2c, address); s != HAL_OK) return s;
    for (std::uint16_t i = 0; i < size; ++i) hal::chip.put(data[i]);
    return HAL_OK;
}
inline void HAL_Delay(std::uint32_t ms) { hal::chip.waited_us += 1000ull * ms; }

#include "example.inc"

int main() {
    I2C_HandleTypeDef handle{};
    StmI2c bus{&handle};
    hal::check(bus, true);
}
