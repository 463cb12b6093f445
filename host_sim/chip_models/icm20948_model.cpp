#include "host_sim/chip_models/icm20948_model.hpp"

namespace fairlead::sim {
namespace {

// the factory's self-test codes and what the test moves: 2620 * 1.01^(code - 1) counts
constexpr std::uint8_t gyro_code = 85, accel_code = 65;
double factory(int code) { return 2620.0 * std::pow(1.01, code - 1); }

}  // namespace

void Icm20948Model::reset() {
    bank_ = 0;
    bank0_ = bank2_ = {};
    bank0_[0x00] = 0xEA;
    bank0_[0x06] = 0x41;  // asleep
    bank2_[0x01] = bank2_[0x14] = 0x01;
    gyro_ = accel_ = {};
    temperature_ = 0;
    ready_ = overflow_ = 0;
    fifo_.clear();
    set_line(false, now());
}

double Icm20948Model::period_ns() const {
    if (bank0_[0x06] & 0x40) return 0;
    return 1e9 / 1125 * (1 + bank2_[0x00]);
}

void Icm20948Model::sample(const Truth& truth, std::int64_t t_ns) {
    const int gyro_fs = bank2_[0x01] >> 1 & 3, accel_fs = bank2_[0x14] >> 1 & 3;
    gyro_ = counts(truth.gyro_rad_s, 250.0 * (1 << gyro_fs) / 32768 * pi / 180);
    accel_ = counts(truth.accel_m_s2, 2.0 * (1 << accel_fs) / 32768 * g_m_s2);
    temperature_ = counts(truth.temperature_c - 21.0f, 1 / 333.87);
    if (!defective) self_test();
    ready_ = 1;
    if ((bank0_[0x03] & 0x40) && (bank0_[0x67] & 0x1F) == 0x1F) {
        for (const int v : accel_) push(v);
        for (const int v : gyro_) push(v);
        push(temperature_);
    }
    if (bank0_[0x11] & 0x01) pulse(t_ns);
}

void Icm20948Model::self_test() {
    const int gyro_fs = bank2_[0x01] >> 1 & 3, accel_fs = bank2_[0x14] >> 1 & 3;
    for (std::size_t i = 0; i < 3; ++i) {
        if (bank2_[0x02] >> (5 - i) & 1)
            gyro_[i] = static_cast<std::int16_t>(gyro_[i] + factory(gyro_code) / (1 << gyro_fs));
        if (bank2_[0x15] >> (4 - i) & 1)
            accel_[i] =
                static_cast<std::int16_t>(accel_[i] + factory(accel_code) / (1 << accel_fs));
    }
}

void Icm20948Model::push(int v) {
    for (const std::uint8_t byte : {high_byte(v), low_byte(v)}) {
        if (fifo_.size() == fifo_size) {
            fifo_.pop_front();  // the oldest byte goes: what is left is out of step
            overflow_ = 1;
        }
        fifo_.push_back(byte);
    }
}

std::uint8_t Icm20948Model::get(std::uint8_t reg) {
    if (reg == 0x7F) return static_cast<std::uint8_t>(bank_ << 4);
    if (bank_ == 1) {
        if (reg >= 0x02 && reg <= 0x04) return gyro_code;
        return reg >= 0x0E && reg <= 0x10 ? accel_code : 0;
    }
    if (bank_ == 2) return bank2_[reg & 0x7F];
    if (bank_ != 0) return 0;
    if (reg >= 0x2D && reg <= 0x3A) {
        const std::size_t i = (reg - 0x2Du) / 2;
        const int v = i < 3 ? accel_[i] : i < 6 ? gyro_[i - 3] : temperature_;
        return (reg & 1) ? high_byte(v) : low_byte(v);
    }
    switch (reg) {
        case 0x1A: {
            const std::uint8_t value = ready_;
            ready_ = 0;
            return value;
        }
        case 0x1B: {
            const std::uint8_t value = overflow_;
            overflow_ = 0;
            return value;
        }
        case 0x70: return high_byte(static_cast<int>(fifo_.size()));
        case 0x71: return low_byte(static_cast<int>(fifo_.size()));
        case 0x72: {
            if (fifo_.empty()) return 0xFF;
            const std::uint8_t byte = fifo_.front();
            fifo_.pop_front();
            return byte;
        }
        default: return bank0_[reg & 0x7F];
    }
}

void Icm20948Model::set(std::uint8_t reg, std::uint8_t value) {
    if (reg == 0x7F) {
        bank_ = value >> 4 & 3;
        return;
    }
    if (bank_ == 2) bank2_[reg & 0x7F] = value;
    if (bank_ == 0) {
        if (reg == 0x06 && (value & 0x80)) {
            reset();
        } else if (reg == 0x68) {
            if (value & 0x1F) fifo_.clear();
        } else if (reg != 0x00 && !(reg >= 0x1A && reg <= 0x3A)) {
            bank0_[reg & 0x7F] = value;
        }
    }
    reschedule();
}

}  // namespace fairlead::sim
