// Every driver, compiled for a Cortex-M4F over a bus that a board's HAL would give: it must build
// without exceptions and RTTI, and the object must ask for no heap (make port-device looks).
#include "port/sensors/ak09916.hpp"
#include "port/sensors/icm426xx.hpp"
#include "port/sensors/lis3mdl.hpp"
#include "port/sensors/lsm6.hpp"
#include "port/sensors/mpu6xxx.hpp"

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
template Status fairlead::port::ak09916::open_bypass<HalBus>(HalBus&, std::uint8_t) noexcept;
