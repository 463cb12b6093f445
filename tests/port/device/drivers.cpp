// Every driver, compiled for a Cortex-M4F over a bus that a board's HAL would give: it must build
// without exceptions and RTTI, and the object must ask for no heap (make port-device looks).
#include "port/sensors/chips.hpp"

using namespace fairlead;
using namespace fairlead::port;

struct HalBus {
    Status transfer(const Transfer* list, std::size_t count) noexcept;
    std::size_t read_max() const noexcept { return 255; }
    void pause_us(std::uint32_t microseconds) noexcept;
};

template class fairlead::port::Icm426xx<HalBus>;
template class fairlead::port::Lsm6<HalBus, lsm6::Dso>;
template class fairlead::port::Lsm6<HalBus, lsm6::Dsv>;
template class fairlead::port::Mpu6xxx<HalBus>;
template class fairlead::port::Lis3mdl<HalBus>;
template class fairlead::port::Ak09916<HalBus>;
template class fairlead::port::Icm456xx<HalBus>;
template class fairlead::port::Icm20948<HalBus>;
template class fairlead::port::Bmi<HalBus, bmi::Bmi160>;
template class fairlead::port::Bmi<HalBus, bmi::Bmi270>;
template class fairlead::port::Bmi088<HalBus>;
template class fairlead::port::Ak8963<HalBus>;
template class fairlead::port::Qmc5883<HalBus, qmc5883::L>;
template class fairlead::port::Qmc5883<HalBus, qmc5883::P>;
template class fairlead::port::Iis2mdc<HalBus>;
template class fairlead::port::Mmc5983ma<HalBus>;

// and over SPI
struct HalWire {
    Status exchange(const std::uint8_t* out, std::size_t out_size, std::uint8_t* in,
                    std::size_t in_size) noexcept;
    std::size_t read_max() const noexcept { return 255; }
    void pause_us(std::uint32_t microseconds) noexcept;
};
template class fairlead::port::Icm426xx<SpiBus<HalWire>>;
template class fairlead::port::Bmi<SpiBus<HalWire>, bmi::Bmi270>;
template class fairlead::port::Bmi088<BusPair<SpiBus<HalWire>>>;
template Status fairlead::port::ak09916::open_bypass<HalBus>(HalBus&, std::uint8_t) noexcept;
