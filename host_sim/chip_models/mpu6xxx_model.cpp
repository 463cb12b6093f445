#include "host_sim/chip_models/mpu6xxx_model.hpp"

namespace fairlead::sim {
namespace {

// the factory's codes: 6050 packs 5 bits each, 6500 has a byte each
constexpr int gyro_code_6050 = 14, accel_code_6050 = 18, gyro_code_6500 = 80, accel_code_6500 = 70;

}  // namespace

void Mpu6xxxModel::reset() {
    regs_ = {};
    regs_[0x6B] = second() ? 0x01 : 0x40;
    if (second()) {
        for (std::size_t i = 0; i < 3; ++i) {
            regs_[i] = gyro_code_6500;
            regs_[0x0D + i] = accel_code_6500;
        }
    } else {
        for (std::size_t i = 0; i < 3; ++i)
            regs_[0x0D + i] =
                static_cast<std::uint8_t>((accel_code_6050 >> 2) << 5 | gyro_code_6050);
        regs_[0x10] = static_cast<std::uint8_t>((accel_code_6050 & 3) * 0x15);
    }
    gyro_ = accel_ = {};
    temperature_ = 0;
    status_ = 0;
    fifo_.clear();
    set_line(false, now());
}

double Mpu6xxxModel::period_ns() const {
    if (regs_[0x6B] & 0x40) return 0;
    const int filter = regs_[0x1A] & 7;
    return (filter == 0 || filter == 7 ? 125e3 : 1e6) * (1 + regs_[0x19]);
}

void Mpu6xxxModel::sample(const Truth& truth, std::int64_t t_ns) {
    const int gyro_fs = regs_[0x1B] >> 3 & 3, accel_fs = regs_[0x1C] >> 3 & 3;
    gyro_ = counts(truth.gyro_rad_s, 250.0 * (1 << gyro_fs) / 32768 * pi / 180);
    accel_ = counts(truth.accel_m_s2, 2.0 * (1 << accel_fs) / 32768 * g_m_s2);
    temperature_ = second() ? static_cast<std::int16_t>(std::lround(
                                  static_cast<double>(truth.temperature_c) / 2.995178e-3 - 7011))
                            : counts(truth.temperature_c - 36.53f, 1.0 / 340);
    if (!defective) self_test();
    status_ |= 0x01;
    const std::uint8_t on = regs_[0x23];
    if (regs_[0x6A] & 0x40) {
        if (on & 0x08)
            for (const int v : accel_) push(v);
        if (on & 0x80) push(temperature_);
        for (std::size_t i = 0; i < 3; ++i)
            if (on >> (6 - i) & 1) push(gyro_[i]);
    }
    if (regs_[0x38] & 0x01) pulse(t_ns);
}

void Mpu6xxxModel::self_test() {
    const int gyro_fs = regs_[0x1B] >> 3 & 3, accel_fs = regs_[0x1C] >> 3 & 3;
    for (std::size_t i = 0; i < 3; ++i) {
        const double y = i == 1 ? -1 : 1;
        const double gyro = second() ? 2620 * std::pow(1.01, gyro_code_6500 - 1)
                                     : y * 25 * 131 * std::pow(1.046, gyro_code_6050 - 1);
        const double accel =
            second() ? 2620 * std::pow(1.01, accel_code_6500 - 1)
                     : 4 * 4096 * 0.34 * std::pow(0.92 / 0.34, (accel_code_6050 - 1) / 30.0);
        if (regs_[0x1B] >> (7 - i) & 1)
            gyro_[i] = static_cast<std::int16_t>(gyro_[i] + gyro / (1 << gyro_fs));
        if (regs_[0x1C] >> (7 - i) & 1)
            accel_[i] = static_cast<std::int16_t>(accel_[i] + accel / (1 << accel_fs));
    }
}

void Mpu6xxxModel::push(int v) {
    for (const std::uint8_t byte : {high_byte(v), low_byte(v)}) {
        if (fifo_.size() == fifo_size()) {
            fifo_.pop_front();  // the oldest byte goes: what is left is out of step
            status_ |= 0x10;
        }
        fifo_.push_back(byte);
    }
}

std::uint8_t Mpu6xxxModel::get(std::uint8_t reg) {
    if (reg >= 0x3B && reg <= 0x48) {
        const std::size_t i = (reg - 0x3Bu) / 2;
        const int v = i < 3 ? accel_[i] : i == 3 ? temperature_ : gyro_[i - 4];
        return (reg & 1) ? high_byte(v) : low_byte(v);
    }
    switch (reg) {
        case 0x3A: {
            const std::uint8_t value = status_;
            status_ = 0;
            return value;
        }
        case 0x72: return high_byte(static_cast<int>(fifo_.size()));
        case 0x73: return low_byte(static_cast<int>(fifo_.size()));
        case 0x74: {
            if (fifo_.empty()) return 0xFF;
            const std::uint8_t byte = fifo_.front();
            fifo_.pop_front();
            return byte;
        }
        case 0x6B: return resetting() ? regs_[reg] | 0x80 : regs_[reg];
        case 0x75: return id_;
        default: return regs_[reg];
    }
}

void Mpu6xxxModel::set(std::uint8_t reg, std::uint8_t value) {
    if (reg == 0x75 || (reg >= 0x3A && reg <= 0x48) || resetting()) return;
    if (reg == 0x6B && (value & 0x80)) {
        reset();
        reset_done_ns_ = now() + start_up_ns;
    } else if (reg == 0x6A) {
        if (value & 0x04) fifo_.clear();
        regs_[reg] = value & 0xF8;
    } else if (reg == 0x68) {
        gyro_ = accel_ = {};
    } else {
        regs_[reg] = value;
    }
    reschedule();
}

}  // namespace fairlead::sim
