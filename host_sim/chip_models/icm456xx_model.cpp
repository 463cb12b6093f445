#include "host_sim/chip_models/icm456xx_model.hpp"

namespace fairlead::sim {

void Icm456xxModel::reset() {
    regs_ = {};
    regs_[0x1B] = regs_[0x1C] = 0x06;
    regs_[0x18] = 0x04;
    regs_[0x20] = 0x20;
    regs_[0x72] = id_;
    smc_ = 0x60;
    status_ = 0x80;  // reset done
    gyro_ = accel_ = {INT16_MIN, INT16_MIN, INT16_MIN};
    temperature_ = INT16_MIN;
    fifo_.clear();
    fifo_at_ = 0;
    set_line(false, now());
}

double Icm456xxModel::period_ns() const {
    if ((regs_[0x10] & 0x0F) != 0x0F) return 0;  // both in low-noise mode, or nothing
    const int code = regs_[0x1C] & 0x0F;
    return code >= 3 && code <= 12 ? 156250.0 * (1 << (code - 3)) : 0;
}

void Icm456xxModel::sample(const Truth& truth, std::int64_t t_ns) {
    const int gyro_fs = (regs_[0x1C] >> 4) + first(), accel_fs = (regs_[0x1B] >> 4 & 7) + first();
    gyro_ = counts(truth.gyro_rad_s, 4000.0 / (1 << gyro_fs) / 32768 * pi / 180);
    accel_ = counts(truth.accel_m_s2, 32.0 / (1 << accel_fs) / 32768 * g_m_s2);
    temperature_ = counts(truth.temperature_c - 25.0f, 1.0 / 128);
    status_ |= 0x04;
    if ((regs_[0x18] & 0x01) && (regs_[0x16] & 0x04)) pulse(t_ns);
    if ((regs_[0x1D] & 0xC0) == 0x40 && (regs_[0x21] & 0x07) == 0x07) push_packet(t_ns);
}

void Icm456xxModel::push_packet(std::int64_t t_ns) {
    if (fifo_.size() == fifo_packets) {
        status_ |= 0x01;
        fifo_.pop_front();
        fifo_at_ = 0;
    }
    std::array<std::uint8_t, packet> p{};
    p[0] = (regs_[0x22] & 0x02) ? 0x68 : 0x60;
    for (std::size_t i = 0; i < 3; ++i) {
        p[1 + 2 * i] = low_byte(accel_[i]);
        p[2 + 2 * i] = high_byte(accel_[i]);
        p[7 + 2 * i] = low_byte(gyro_[i]);
        p[8 + 2 * i] = high_byte(gyro_[i]);
    }
    p[13] = low_byte(static_cast<int>(std::lround(temperature_ / 128.0 * 2)));
    if (smc_ & 0x01) {  // otherwise the counter stands
        const auto tick = static_cast<std::int64_t>(chip_time_ns(t_ns) / 1000);
        p[14] = low_byte(static_cast<int>(tick & 0xFFFF));
        p[15] = high_byte(static_cast<int>(tick & 0xFFFF));
    }
    fifo_.push_back(p);
    update_line(t_ns);
}

void Icm456xxModel::update_line(std::int64_t t_ns) {
    const std::size_t watermark = regs_[0x1E] | static_cast<std::size_t>(regs_[0x1F]) << 8;
    if (!(regs_[0x16] & 0x02)) return;
    set_line(watermark > 0 && fifo_.size() >= watermark, t_ns);
}

std::uint8_t Icm456xxModel::get(std::uint8_t reg) {
    if (reg <= 0x0D) {
        const std::size_t i = reg / 2u;
        const int v = i < 3 ? accel_[i] : i < 6 ? gyro_[i - 3] : temperature_;
        return (reg & 1) ? high_byte(v) : low_byte(v);
    }
    switch (reg) {
        case 0x12: return low_byte(static_cast<int>(fifo_.size()));
        case 0x13: return high_byte(static_cast<int>(fifo_.size()));
        case 0x14: {
            if (fifo_.empty()) return 0xFF;
            const std::uint8_t byte = fifo_.front()[fifo_at_];
            if (++fifo_at_ == packet) {
                fifo_.pop_front();
                fifo_at_ = 0;
                update_line(now());
            }
            return byte;
        }
        case 0x19: {
            const std::uint8_t value = status_;
            status_ = 0;
            return value;
        }
        case 0x7E: return ireg_ == smc_control ? smc_ : 0;
        default: return regs_[reg & 0x7F];
    }
}

void Icm456xxModel::set(std::uint8_t reg, std::uint8_t value) {
    if (reg == 0x7F && (value & 0x02)) {
        reset();
    } else if (reg == 0x7C) {
        ireg_ = static_cast<std::uint16_t>((ireg_ & 0xFF) | value << 8);
    } else if (reg == 0x7D) {
        ireg_ = static_cast<std::uint16_t>((ireg_ & 0xFF00) | value);
    } else if (reg == 0x7E) {
        if (ireg_ == smc_control) smc_ = value;
    } else if (reg >= 0x10 && reg != 0x72 && reg != 0x12 && reg != 0x13 && reg != 0x19) {
        if (reg == 0x20 && (value & 0x80)) {
            fifo_.clear();
            fifo_at_ = 0;
            update_line(now());
            value &= 0x7F;
        }
        regs_[reg & 0x7F] = value;
    }
    reschedule();
}

}  // namespace fairlead::sim
