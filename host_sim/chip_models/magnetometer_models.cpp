#include "host_sim/chip_models/magnetometer_models.hpp"

namespace fairlead::sim {

void Lis3mdlModel::reset() {
    regs_ = {};
    regs_[0x0F] = 0x3D;
    regs_[0x20] = 0x10;
    regs_[0x22] = 0x03;  // power-down
    field_ = {};
    status_ = 0;
    set_line(false, now());
}

double Lis3mdlModel::period_ns() const {
    if ((regs_[0x22] & 3) != 0) return 0;
    const double fast_hz[4] = {1000, 560, 300, 155};
    if (regs_[0x20] & 0x02) return 1e9 / fast_hz[regs_[0x20] >> 5 & 3];
    return 1.6e9 / (1 << (regs_[0x20] >> 2 & 7));
}

void Lis3mdlModel::sample(const Truth& truth, std::int64_t t_ns) {
    const double counts_per_gauss[4] = {6842, 3421, 2281, 1711};
    const double scale = 100 / counts_per_gauss[regs_[0x21] >> 5 & 3];
    field_ = counts(truth.mag_uT, scale);
    temperature_ = counts(truth.temperature_c - 25.0f, 1.0 / 8);
    if ((regs_[0x20] & 1) && !defective) {
        const double uT[3] = {180, 180, 50};
        for (std::size_t i = 0; i < 3; ++i)
            field_[i] = static_cast<std::int16_t>(field_[i] + uT[i] / scale);
    }
    status_ = static_cast<std::uint8_t>((status_ & 0x08) ? 0xFF : 0x0F);  // overrun when unread
    set_line(false, t_ns);
    set_line(true, t_ns);  // the DRDY pin
}

std::uint8_t Lis3mdlModel::get(std::uint8_t reg) {
    if (reg == 0x27) return status_;
    if (reg >= 0x28 && reg <= 0x2D) {
        const int v = field_[(reg - 0x28u) / 2];
        if (reg == 0x2D) {
            status_ = 0;
            set_line(false, now());
        }
        return (reg & 1) ? high_byte(v) : low_byte(v);
    }
    if (reg == 0x2E) return low_byte(temperature_);
    if (reg == 0x2F) return high_byte(temperature_);
    return regs_[reg];
}

void Lis3mdlModel::set(std::uint8_t reg, std::uint8_t value) {
    if (reg < 0x20 || (reg >= 0x27 && reg <= 0x2F)) return;
    regs_[reg] = value;
    if (reg == 0x21 && (value & 0x04)) reset();
    reschedule();
}

void Ak09916Model::reset() {
    regs_ = {};
    regs_[0x00] = 0x48;
    regs_[0x01] = 0x09;
    // Not in the data sheet: Linux's driver reads sensitivity adjustments here, as in the AK09912,
    // and takes 128 for none.
    regs_[0x60] = regs_[0x61] = regs_[0x62] = 0x80;
    field_ = {};
    overflow_ = locked_ = false;
}

double Ak09916Model::period_ns() const {
    switch (regs_[0x31] & 0x1F) {
        case 0x01: return 7.2e6;  // one conversion
        case 0x02: return 100e6;
        case 0x04: return 50e6;
        case 0x06: return 20e6;
        case 0x08: return 10e6;
        case 0x10: return 7.2e6;  // self test
        default: return 0;
    }
}

void Ak09916Model::sample(const Truth& truth, std::int64_t) {
    if (locked_) return;
    const int mode = regs_[0x31] & 0x1F;
    if (regs_[0x10] & 0x01) regs_[0x10] |= 0x02;  // the last one was never read
    regs_[0x10] |= 0x01;
    field_ = counts(truth.mag_uT, 0.15);
    const Vec3& m = truth.mag_uT;
    overflow_ = std::abs(m.x) + std::abs(m.y) + std::abs(m.z) >= 4912.0f;
    if (mode == 0x10) {
        field_ = {20, -30, -500};
        if (defective) field_ = {0, 0, 0};
    }
    if (mode == 0x10 || mode == 0x01) {
        regs_[0x31] = 0;
        reschedule();
    }
}

std::uint8_t Ak09916Model::get(std::uint8_t reg) {
    if (reg >= 0x11 && reg <= 0x16) {
        locked_ = true;
        const int v = field_[(reg - 0x11u) / 2];
        return (reg & 1) ? low_byte(v) : high_byte(v);
    }
    if (reg == 0x18) {
        locked_ = false;
        regs_[0x10] = 0;
        return overflow_ ? 0x08 : 0x00;
    }
    return reg < regs_.size() ? regs_[reg] : 0;
}

void Ak09916Model::set(std::uint8_t reg, std::uint8_t value) {
    if (reg == 0x32 && (value & 1)) {
        reset();
    } else if (reg == 0x31) {
        regs_[0x31] = value & 0x1F;
        regs_[0x10] = 0;
        locked_ = false;
    }
    reschedule();
}

}  // namespace fairlead::sim
