#pragma once
// Every supported chip in one table: its name, its driver, who answers where, and how it is wired.
// The sampling loop by name (port/linux/imu_loop.hpp), the recorder, the gateway and the table in
// docs/port.md read it; nothing else lists chips. To add one: a struct below, and its name in the
// list of IMUs or of magnetometers.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "port/sensors/ak09916.hpp"
#include "port/sensors/ak8963.hpp"
#include "port/sensors/bmi.hpp"
#include "port/sensors/bmi088.hpp"
#include "port/sensors/icm20948.hpp"
#include "port/sensors/icm426xx.hpp"
#include "port/sensors/icm456xx.hpp"
#include "port/sensors/iis2mdc.hpp"
#include "port/sensors/lis3mdl.hpp"
#include "port/sensors/lsm6.hpp"
#include "port/sensors/mmc5983ma.hpp"
#include "port/sensors/mpu6xxx.hpp"
#include "port/sensors/qmc5883.hpp"
#include "port/sensors/spi.hpp"

namespace fairlead::port {

struct ChipInfo {
    static constexpr std::size_t ids_max = 8;

    const char* name{};                       // as users spell it
    const char* parts{};                      // what the driver takes under that name
    const char* header{};                     // of port/sensors
    std::array<std::uint8_t, 2> addresses{};  // I2C, 7 bits; the first is the default, 0: none
    std::uint8_t id_reg{};
    std::array<std::uint8_t, ids_max> ids{};  // accepted identities
    std::size_t ids_used{};
    SpiStyle spi{};            // hz_max 0: no SPI
    bool behind_bypass{};      // a magnetometer that its IMU's driver must connect
    bool needs_blob{};         // a configuration file that the caller passes in
    std::size_t fifo_bytes{};  // 0: none
};

namespace chips {

template <class Kind, std::size_t N>
constexpr ChipInfo with_ids(ChipInfo info, std::uint8_t reg, const Kind (&parts)[N]) noexcept {
    static_assert(N <= ChipInfo::ids_max);
    info.id_reg = reg;
    for (const Kind& part : parts) info.ids[info.ids_used++] = part.id;
    return info;
}

// ---- inertial
struct Icm42688 {
    template <class Bus>
    using Driver = Icm426xx<Bus>;
    static constexpr ChipInfo info = with_ids({"icm42688",
                                               "ICM-42688-P, ICM-42605, IIM-42652",
                                               "icm426xx.hpp",
                                               {0x68, 0x69},
                                               0,
                                               {},
                                               0,
                                               {24000000, 0, 0},
                                               false,
                                               false,
                                               2048},
                                              icm426xx::who_am_i, icm426xx::parts);
};
struct Icm45686 {
    template <class Bus>
    using Driver = Icm456xx<Bus>;
    static constexpr ChipInfo info =
        with_ids({"icm45686",
                  "ICM-45686, ICM-45605, ICM-45608, ICM-45688-P, ICM-45689",
                  "icm456xx.hpp",
                  {0x68, 0x69},
                  0,
                  {},
                  0,
                  {24000000, 0, 0},
                  false,
                  false,
                  8192},
                 icm456xx::who_am_i, icm456xx::parts);
};
struct Icm20948 {
    template <class Bus>
    using Driver = port::Icm20948<Bus>;
    static constexpr ChipInfo info = with_ids({"icm20948",
                                               "ICM-20948",
                                               "icm20948.hpp",
                                               {0x68, 0x69},
                                               0,
                                               {},
                                               0,
                                               {7000000, 0, 0},
                                               false,
                                               false,
                                               512},
                                              icm20948::who_am_i, icm20948::parts);
};
struct Lsm6dso {
    template <class Bus>
    using Driver = port::Lsm6dso<Bus>;
    static constexpr ChipInfo info = with_ids({"lsm6dso",
                                               "LSM6DSO, LSM6DSOX",
                                               "lsm6.hpp",
                                               {0x6A, 0x6B},
                                               0,
                                               {},
                                               0,
                                               {10000000, 0, 0},
                                               false,
                                               false,
                                               3584},
                                              lsm6::who_am_i, lsm6::Dso::parts);
};
struct Lsm6dsv {
    template <class Bus>
    using Driver = port::Lsm6dsv<Bus>;
    static constexpr ChipInfo info = with_ids({"lsm6dsv",
                                               "LSM6DSV, LSM6DSV16X",
                                               "lsm6.hpp",
                                               {0x6A, 0x6B},
                                               0,
                                               {},
                                               0,
                                               {10000000, 0, 0},
                                               false,
                                               false,
                                               1792},
                                              lsm6::who_am_i, lsm6::Dsv::parts);
};
struct Mpu6050 {
    template <class Bus>
    using Driver = Mpu6xxx<Bus>;
    static constexpr ChipInfo info =
        with_ids({"mpu6050",
                  "MPU-6050, MPU-6500, MPU-6515, MPU-6880, MPU-9250, MPU-9255",
                  "mpu6xxx.hpp",
                  {0x68, 0x69},
                  0,
                  {},
                  0,
                  {1000000, 0, 0},
                  false,
                  false,
                  512},
                 mpu6xxx::who_am_i, mpu6xxx::parts);
};
struct Bmi160 {
    template <class Bus>
    using Driver = port::Bmi160<Bus>;
    static constexpr ChipInfo info = with_ids({"bmi160",
                                               "BMI160",
                                               "bmi.hpp",
                                               {0x68, 0x69},
                                               0,
                                               {},
                                               0,
                                               {10000000, 0, 0},
                                               false,
                                               false,
                                               1024},
                                              bmi::chip_id, bmi::Bmi160::parts);
};
struct Bmi270 {
    template <class Bus>
    using Driver = port::Bmi270<Bus>;
    static constexpr ChipInfo info = with_ids({"bmi270",
                                               "BMI270, BMI260",
                                               "bmi.hpp",
                                               {0x68, 0x69},
                                               0,
                                               {},
                                               0,
                                               {10000000, 1, 0},
                                               false,
                                               true,
                                               2048},
                                              bmi::chip_id, bmi::Bmi270::parts);
};
/// Over SPI its halves have a chip select each: BusPair (spi.hpp), not the table's one bus.
struct Bmi088 {
    template <class Bus>
    using Driver = port::Bmi088<Bus>;
    static constexpr ChipInfo info =
        with_ids({"bmi088", "BMI088", "bmi088.hpp", {0x68, 0x69}, 0, {}, 0, {}, false, false, 1024},
                 bmi088::chip_id, bmi088::parts);
};

// ---- magnetometers
struct Lis3mdl {
    template <class Bus>
    using Driver = port::Lis3mdl<Bus>;
    static constexpr ChipInfo info = with_ids({"lis3mdl",
                                               "LIS3MDL",
                                               "lis3mdl.hpp",
                                               {0x1C, 0x1E},
                                               0,
                                               {},
                                               0,
                                               {10000000, 0, 0x40},
                                               false,
                                               false,
                                               0},
                                              lis3mdl::who_am_i, lis3mdl::parts);
};
struct Ak09916 {
    template <class Bus>
    using Driver = port::Ak09916<Bus>;
    static constexpr ChipInfo info = with_ids({"ak09916",
                                               "AK09916 (in ICM-20948)",
                                               "ak09916.hpp",
                                               {0x0C, 0},
                                               0,
                                               {},
                                               0,
                                               {},
                                               true,
                                               false,
                                               0},
                                              ak09916::wia2, ak09916::parts);
};
struct Ak8963 {
    template <class Bus>
    using Driver = port::Ak8963<Bus>;
    static constexpr ChipInfo info = with_ids({"ak8963",
                                               "AK8963 (in MPU-9250, MPU-9255)",
                                               "ak8963.hpp",
                                               {0x0C, 0},
                                               0,
                                               {},
                                               0,
                                               {},
                                               true,
                                               false,
                                               0},
                                              ak8963::wia, ak8963::parts);
};
struct Qmc5883l {
    template <class Bus>
    using Driver = port::Qmc5883l<Bus>;
    static constexpr ChipInfo info =
        with_ids({"qmc5883l", "QMC5883L", "qmc5883.hpp", {0x0D, 0}, 0, {}, 0, {}, false, false, 0},
                 qmc5883::L::id_reg, qmc5883::L::parts);
};
struct Qmc5883p {
    template <class Bus>
    using Driver = port::Qmc5883p<Bus>;
    static constexpr ChipInfo info =
        with_ids({"qmc5883p", "QMC5883P", "qmc5883.hpp", {0x2C, 0}, 0, {}, 0, {}, false, false, 0},
                 qmc5883::P::id_reg, qmc5883::P::parts);
};
struct Iis2mdc {
    template <class Bus>
    using Driver = port::Iis2mdc<Bus>;
    static constexpr ChipInfo info = with_ids(
        {"iis2mdc", "IIS2MDC, LIS2MDL", "iis2mdc.hpp", {0x1E, 0}, 0, {}, 0, {}, false, false, 0},
        iis2mdc::who_am_i, iis2mdc::parts);
};
struct Mmc5983ma {
    template <class Bus>
    using Driver = port::Mmc5983ma<Bus>;
    static constexpr ChipInfo info = with_ids({"mmc5983ma",
                                               "MMC5983MA",
                                               "mmc5983ma.hpp",
                                               {0x30, 0},
                                               0,
                                               {},
                                               0,
                                               {10000000, 0, 0},
                                               false,
                                               false,
                                               0},
                                              mmc5983ma::product_id, mmc5983ma::parts);
};

}  // namespace chips

/// Chips as types, with what can be asked of them by name.
template <class... Chip>
struct ChipList {
    static constexpr std::array<ChipInfo, sizeof...(Chip)> infos{Chip::info...};

    /// Null where no chip has that name.
    static constexpr const ChipInfo* find(std::string_view name) noexcept {
        for (const ChipInfo& info : infos)
            if (name == info.name) return &info;
        return nullptr;
    }
    /// Calls use(Chip{}) for the chip of that name. False: there is none.
    template <class Use>
    static bool visit(std::string_view name, Use use) {
        return ((name == Chip::info.name ? (use(Chip{}), true) : false) || ...);
    }
};

using ImuChips =
    ChipList<chips::Icm42688, chips::Icm45686, chips::Icm20948, chips::Lsm6dso, chips::Lsm6dsv,
             chips::Mpu6050, chips::Bmi160, chips::Bmi270, chips::Bmi088>;
using MagChips = ChipList<chips::Lis3mdl, chips::Ak09916, chips::Ak8963, chips::Qmc5883l,
                          chips::Qmc5883p, chips::Iis2mdc, chips::Mmc5983ma>;

}  // namespace fairlead::port
