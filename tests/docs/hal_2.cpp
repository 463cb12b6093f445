// STM32 HAL, SPI.
#include "port/sensors/chips.hpp"
#include "tests/docs/register_chip.hpp"

enum HAL_StatusTypeDef { HAL_OK, HAL_ERROR, HAL_BUSY, HAL_TIMEOUT };
struct SPI_HandleTypeDef {};
struct GPIO_TypeDef {};
enum GPIO_PinState { GPIO_PIN_RESET, GPIO_PIN_SET };
inline SPI_HandleTypeDef hspi1;
inline GPIO_TypeDef gpio_a;
#define GPIOA (&gpio_a)
#define GPIO_PIN_4 (static_cast<std::uint16_t>(0x0010))
inline bool selected = false;
inline void HAL_GPIO_WritePin(GPIO_TypeDef*, std::uint16_t, GPIO_PinState state) {
    selected = state == GPIO_PIN_RESET;
    hal::chip.begin();
}
inline HAL_StatusTypeDef HAL_SPI_Transmit(SPI_HandleTypeDef*, std::uint8_t* data,
                                          std::uint16_t size, std::uint32_t) {
    assert(selected);
    for (std::uint16_t i = 0; i < size; ++i)
        hal::chip.put(i == 0 ? static_cast<std::uint8_t>(data[0] & 0x7F) : data[i]);
    return HAL_OK;
}
inline HAL_StatusTypeDef HAL_SPI_Receive(SPI_HandleTypeDef*, std::uint8_t* data, std::uint16_t size,
                                         std::uint32_t) {
    assert(selected);
    for (std::uint16_t i = 0; i < size; ++i) data[i] = hal::chip.get();
    return HAL_OK;
}
inline void HAL_Delay(std::uint32_t ms) { hal::chip.waited_us += 1000ull * ms; }

#include "example.inc"

int main() {
    hal::check(imu_bus, false);
    hal::require(!selected, "the select is let go");
    hal::require(imu.probe().status == fairlead::Status::unexpected_id, "a driver on it");
    fairlead::port::SpiBus<StmSpiWire> gyro{imu_select, fairlead::port::bmi088::gyro_spi};
    fairlead::port::SpiBus<StmSpiWire> accel{imu_select, fairlead::port::bmi088::accel_spi};
    fairlead::port::BusPair<fairlead::port::SpiBus<StmSpiWire>> pair{gyro, accel, 0x18};
    hal::require(fairlead::port::Bmi088<decltype(pair)>{pair}.probe().status ==
                     fairlead::Status::unexpected_id,
                 "a pair of selects");
}
