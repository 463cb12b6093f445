#include "host_sim/chip_models/bmi088_model.hpp"

#include <algorithm>

namespace fairlead::sim {

// ---- the accelerometer

void Bmi088Accel::reset() {
    regs_ = {};
    regs_[0x40] = 0xA8;
    regs_[0x41] = 0x01;
    regs_[0x45] = 0x80;
    regs_[0x47] = 0x02;
    regs_[0x48] = 0x02;
    regs_[0x49] = 0x10;
    regs_[0x7C] = 0x03;
    accel_ = {};
    temperature_ = -1024;
    fresh_ = false;
    fifo_.clear();
    fifo_at_ = 0;
    skipped_ = 0;
}

double Bmi088Accel::period_ns() const {
    if ((regs_[0x7D] & 0x04) == 0 || regs_[0x7C] != 0) return 0;
    const int code = regs_[0x40] & 0x0F;
    return code >= 5 && code <= 12 ? 80e6 / (1 << (code - 5)) : 0;
}

void Bmi088Accel::sample(const Truth& truth, std::int64_t) {
    accel_ = counts(truth.accel_m_s2, m_s2_per_count());
    if ((regs_[0x6D] & 0x09) == 0x09 && !defective) {
        const double sign = (regs_[0x6D] & 0x04) != 0 ? 1 : -1;
        const double moved_g[3] = {0.6, 0.7, 0.3};  // a little more than half of what is asked
        for (std::size_t i = 0; i < 3; ++i)
            accel_[i] = static_cast<std::int16_t>(std::clamp(
                accel_[i] + sign * moved_g[i] * g_m_s2 / m_s2_per_count(), -32768.0, 32767.0));
    }
    temperature_ = static_cast<int>(std::lround((truth.temperature_c - 23) * 8));
    fresh_ = true;
    if ((regs_[0x49] & 0x40) == 0) return;
    if (fifo_.size() == frames) {
        fifo_.pop_front();
        fifo_at_ = 0;
        skipped_ = std::min(skipped_ + 1, 255u);
    }
    std::array<std::uint8_t, frame> f{0x84};
    for (std::size_t i = 0; i < 3; ++i) {
        f[1 + 2 * i] = low_byte(accel_[i]);
        f[2 + 2 * i] = high_byte(accel_[i]);
    }
    fifo_.push_back(f);
}

/// One byte of the oldest frame. After an overflow a frame that says so comes first.
std::uint8_t Bmi088Accel::pop() {
    if (skipped_ > 0) {
        const std::uint8_t byte = fifo_at_ == 0 ? 0x40 : static_cast<std::uint8_t>(skipped_);
        if (++fifo_at_ == 2) fifo_at_ = skipped_ = 0;
        return byte;
    }
    if (fifo_.empty()) return 0x80;
    const std::uint8_t byte = fifo_at_ == 0 && foreign_frame ? 0x48 : fifo_.front()[fifo_at_];
    foreign_frame = false;
    if (++fifo_at_ == frame) {
        fifo_.pop_front();
        fifo_at_ = 0;
    }
    return byte;
}

std::uint8_t Bmi088Accel::get(std::uint8_t reg) {
    const auto bytes = static_cast<int>(fifo_.size() * frame);
    switch (reg) {
        case 0x00: return 0x1E;
        case 0x03: return fresh_ ? 0x90 : 0x10;
        case 0x22: return static_cast<std::uint8_t>(temperature_ >> 3 & 0xFF);
        case 0x23: return static_cast<std::uint8_t>((temperature_ & 7) << 5);
        case 0x24: fifo_at_ = 0; return low_byte(bytes);  // a frame in pieces begins again
        case 0x25: return high_byte(bytes);
        case 0x26: return pop();
        default: break;
    }
    if (reg >= 0x12 && reg <= 0x17) {
        fresh_ = false;
        const int v = accel_[(reg - 0x12u) / 2];
        return (reg & 1) != 0 ? high_byte(v) : low_byte(v);
    }
    return regs_[reg & 0x7F];
}

void Bmi088Accel::set(std::uint8_t reg, std::uint8_t value) {
    const bool asleep = regs_[0x7C] != 0, hasty = now() - written_ns_ < 450000;
    written_ns_ = now();
    if (asleep && hasty) return;
    if (reg == 0x7E && value == 0xB6) {
        reset();
        reset_done_ns_ = now() + 1000000;
    } else if (reg == 0x7E && value == 0xB0) {
        fifo_.clear();
        fifo_at_ = 0;
        skipped_ = 0;
    } else if (reg >= 0x40 && reg < 0x7E) {
        regs_[reg] = value;
    }
    reschedule();
}

// ---- the gyroscope

void Bmi088Model::clear() {
    regs_ = {};
    regs_[0x10] = 0x80;
    regs_[0x16] = 0x0F;
    regs_[0x1E] = 0x08;
    gyro_ = {};
    sampled_ns_ = INT64_MIN / 2;
    empty();
}

void Bmi088Model::empty() {
    fifo_.clear();
    fifo_at_ = 0;
    overrun_ = false;
    set_line(false, now());
}

double Bmi088Model::period_ns() const {
    if (!present() || regs_[0x11] != 0) return 0;
    const double hz[8] = {2000, 2000, 1000, 400, 200, 100, 200, 100};
    return 1e9 / hz[regs_[0x10] & 7];
}

void Bmi088Model::sample(const Truth& truth, std::int64_t t_ns) {
    accel.advance(t_ns);
    gyro_ = counts(truth.gyro_rad_s, 2000.0 / (1 << (regs_[0x0F] & 7)) / 32768 * pi / 180);
    sampled_ns_ = t_ns;
    if ((regs_[0x3E] & 0xC0) == 0x80) {
        if (fifo_.size() == frames - 1) {
            fifo_.pop_front();
            fifo_at_ = 0;
            overrun_ = true;
        }
        std::array<std::uint8_t, frame> f{};
        for (std::size_t i = 0; i < 3; ++i) {
            f[2 * i] = low_byte(gyro_[i]);
            f[2 * i + 1] = high_byte(gyro_[i]);
        }
        fifo_.push_back(f);
    }
    const bool high = (regs_[0x16] & 0x03) == 0x01;  // push-pull, active high
    if (high && (regs_[0x15] & 0x80) != 0 && (regs_[0x18] & 0x01) != 0) pulse(t_ns);
    update_line(t_ns);
}

void Bmi088Model::update_line(std::int64_t t_ns) {
    const bool routed = (regs_[0x15] & 0x40) != 0 && (regs_[0x18] & 0x04) != 0 &&
                        (regs_[0x1E] & 0x80) != 0 && (regs_[0x16] & 0x03) == 0x01;
    const std::size_t level = regs_[0x3D] & 0x7F;
    if (routed) set_line(level > 0 && fifo_.size() >= level, t_ns);
}

std::uint8_t Bmi088Model::get(std::uint8_t reg) {
    switch (reg) {
        case 0x00: return 0x0F;
        case 0x0A: return now() - sampled_ns_ < 300000 ? 0x80 : 0x00;  // it falls by itself
        case 0x0E:
            fifo_at_ = 0;
            return static_cast<std::uint8_t>(fifo_.size() | (overrun_ ? 0x80u : 0u));
        case 0x3C: return (regs_[0x3C] & 1) == 0 ? 0x10 : defective ? 0x06 : 0x12;
        case 0x3F: {
            if (fifo_.empty()) return 0x00;
            const std::uint8_t byte = fifo_.front()[fifo_at_];
            if (++fifo_at_ == frame) {
                fifo_.pop_front();
                fifo_at_ = 0;
                update_line(now());
            }
            return byte;
        }
        default: break;
    }
    if (reg >= 0x02 && reg <= 0x07) {
        const int v = gyro_[(reg - 0x02u) / 2];
        return (reg & 1) != 0 ? high_byte(v) : low_byte(v);
    }
    return regs_[reg & 0x7F];
}

void Bmi088Model::set(std::uint8_t reg, std::uint8_t value) {
    accel.defective = defective;
    if (reg == 0x14 && value == 0xB6) {
        clear();
        reset_done_ns_ = now() + 30000000;
    } else if (reg >= 0x0F && reg < 0x40) {
        regs_[reg] = value;
        if (reg == 0x10) regs_[reg] |= 0x80;  // reads as set
        if (reg == 0x3D || reg == 0x3E) empty();
    }
    reschedule();
}

}  // namespace fairlead::sim
