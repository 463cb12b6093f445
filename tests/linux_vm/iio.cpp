// The models judged by others: binds the kernel's own driver to one, reads every axis through IIO,
// unbinds it, reads the same axes with our driver, and compares both with what the chip feels.
// usage: iio TYPE ADDRESS GPIO /dev/i2c-N     (the model must run on the motion "still")
#include <dirent.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "host_sim/recording/recording.hpp"
#include "port/linux/clock.hpp"
#include "port/linux/i2c.hpp"
#include "port/sensors/ak09916.hpp"
#include "port/sensors/ak8963.hpp"
#include "port/sensors/bmi.hpp"
#include "port/sensors/icm426xx.hpp"
#include "port/sensors/iis2mdc.hpp"
#include "port/sensors/lis3mdl.hpp"
#include "port/sensors/lsm6.hpp"
#include "port/sensors/mpu6xxx.hpp"
#include "tests/linux_vm/source.hpp"

using namespace fairlead;
using namespace fairlead::port;

namespace {

const char* const parameter = "/sys/module/fairlead_i2c/parameters/client";
const std::string devices = "/sys/bus/iio/devices/";

bool write_text(const char* path, const std::string& text) {
    std::FILE* const f = std::fopen(path, "w");
    if (f == nullptr) return false;
    const bool written = std::fwrite(text.data(), 1, text.size(), f) == text.size();
    return std::fclose(f) == 0 && written;
}

bool read_number(const std::string& path, double& value) {
    std::FILE* const f = std::fopen(path.c_str(), "r");
    if (f == nullptr) return false;
    const bool good = std::fscanf(f, "%lf", &value) == 1;
    std::fclose(f);
    return good;
}

struct Axis {
    std::string name;  // as IIO says it: anglvel_x
    double value{0}, scale{0};
};

/// raw x scale of one quantity, whichever IIO device has it.
std::vector<Axis> read_iio(const std::string& quantity) {
    std::vector<Axis> axes;
    DIR* const dir = opendir(devices.c_str());
    if (dir == nullptr) return axes;
    while (const dirent* const e = readdir(dir)) {
        const std::string base = devices + e->d_name + "/in_" + quantity + "_";
        for (const char* const axis : {"x", "y", "z"}) {
            double raw = 0, scale = 0;
            if (!read_number(base + axis + "_raw", raw)) continue;
            if (!read_number(base + "scale", scale) && !read_number(base + axis + "_scale", scale))
                continue;
            axes.push_back({quantity + "_" + axis, raw * scale, scale});
        }
    }
    closedir(dir);
    return axes;
}

struct Reading {
    Status status{Status::not_found};
    Sample sample{};
    double gyro_count{0}, accel_count{0}, mag_count{0};
};

template <class Driver>
Reading read_ours(I2c& bus, std::uint8_t address) {
    Reading r;
    Driver driver{bus, address};
    typename Driver::Config config;
    // the kernel's driver gives the chip's own axes, ours those of the MPU-9250 around it
    if constexpr (std::is_same_v<Driver, Ak8963<I2c>>) config.own_axes = true;
    r.status = driver.start(config);
    if (r.status != Status::ok) return r;
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
    const auto sample = driver.read(now_ns());
    r.status = sample.status();
    r.sample = *sample;
    if constexpr (std::is_same_v<Driver, Lis3mdl<I2c>>)
        r.mag_count = static_cast<double>(lis3mdl::uT_per_count(lis3mdl::Range::gauss_4));
    else if constexpr (std::is_same_v<Driver, Ak09916<I2c>>)
        r.mag_count = static_cast<double>(ak09916::uT_per_count);
    else if constexpr (std::is_same_v<Driver, Ak8963<I2c>>)
        r.mag_count = 1.25 * static_cast<double>(ak8963::uT_per_count);  // the model's adjustments
    else if constexpr (std::is_same_v<Driver, Iis2mdc<I2c>>)
        r.mag_count = static_cast<double>(iis2mdc::uT_per_count);
    else {
        r.gyro_count = static_cast<double>(driver.scale().gyro_rad_s);
        r.accel_count = static_cast<double>(driver.scale().accel_m_s2);
    }
    return r;
}

Reading read_ours(const std::string& type, I2c& bus, std::uint8_t address) {
    if (type.rfind("icm", 0) == 0) return read_ours<Icm426xx<I2c>>(bus, address);
    if (type == "lsm6dso") return read_ours<Lsm6dso<I2c>>(bus, address);
    if (type.rfind("mpu", 0) == 0) return read_ours<Mpu6xxx<I2c>>(bus, address);
    if (type == "lis3mdl") return read_ours<Lis3mdl<I2c>>(bus, address);
    if (type == "bmi160") return read_ours<Bmi160<I2c>>(bus, address);
    if (type == "ak8963") return read_ours<Ak8963<I2c>>(bus, address);
    if (type == "iis2mdc") return read_ours<Iis2mdc<I2c>>(bus, address);
    return read_ours<Ak09916<I2c>>(bus, address);
}

/// unit: of IIO's value in ours. Half a count of either side, and a little for its printed scale.
bool compare(const char* quantity, const std::vector<Axis>& theirs, const Vec3& ours,
             const Vec3& truth, double our_count, double unit) {
    if (our_count == 0) return true;
    const float our_values[3] = {ours.x, ours.y, ours.z}, truths[3] = {truth.x, truth.y, truth.z};
    bool good = theirs.size() == 3;
    for (std::size_t i = 0; i < theirs.size() && i < 3; ++i) {
        const double value = theirs[i].value * unit, count = theirs[i].scale * unit;
        const double mine = static_cast<double>(our_values[i]),
                     real = static_cast<double>(truths[i]);
        const double slack = 1e-3 * std::abs(real);
        std::printf("  %s kernel %.6f ours %.6f chip feels %.6f\n", theirs[i].name.c_str(), value,
                    mine, real);
        good = good && std::abs(value - real) <= 0.51 * count + slack &&
               std::abs(mine - real) <= 0.51 * our_count + slack;
    }
    if (!good) std::printf("  %s: kernel's driver gave %zu axes\n", quantity, theirs.size());
    return good;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) return 2;
    const std::string type = argv[1];
    const auto address = static_cast<std::uint8_t>(std::strtoul(argv[2], nullptr, 0));
    I2c bus;
    if (bus.open(argv[4]) != Status::ok) return 1;
    const bool bound = write_text(parameter, type + " " + argv[2] + " " + argv[3] + "\n");
    std::this_thread::sleep_for(std::chrono::milliseconds{300});
    const auto gyro = read_iio("anglvel"), accel = read_iio("accel"), mag = read_iio("magn");
    write_text(parameter, "-\n");
    const Reading ours = read_ours(type, bus, address);
    const sim::Truth truth = vm::Source{"still"}.at(0);
    bool good = bound && ours.status == Status::ok;
    if (!good) std::printf("  bound %d, our driver says %s\n", bound, to_string(ours.status));
    good = compare("anglvel", gyro, ours.sample.gyro_rad_s, truth.gyro_rad_s, ours.gyro_count, 1) &&
           compare("accel", accel, ours.sample.accel_m_s2, truth.accel_m_s2, ours.accel_count, 1) &&
           compare("magn", mag, ours.sample.mag_uT, truth.mag_uT, ours.mag_count, 100) && good;
    std::printf("%s linux_vm.kernel-driver-and-ours-agree.%s\n", good ? "ok" : "FAIL",
                type.c_str());
    return good ? 0 : 1;
}
