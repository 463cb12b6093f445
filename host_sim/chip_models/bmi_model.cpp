#include "host_sim/chip_models/bmi_model.hpp"

#include <algorithm>

namespace fairlead::sim {

void BmiModel::reset() {
    regs_ = {};
    regs_[0x40] = is_160() ? 0x28 : 0xA8;
    regs_[0x41] = is_160() ? 0x03 : 0x02;
    regs_[0x42] = is_160() ? 0x28 : 0xA9;
    if (is_160()) regs_[0x46] = 0x80;
    if (is_160()) regs_[0x47] = 0x10;
    if (!is_160()) regs_[0x48] = 0x02;
    if (!is_160()) regs_[0x49] = 0x10;
    if (!is_160()) regs_[0x7C] = 0x03;
    uploaded_ = 0;
    init_ns_ = INT64_MAX;
    blob_good_ = gyro_ok_ = fresh_ = false;
    pmu_ = 0;
    gyro_ = accel_ = {};
    temperature_ = INT16_MIN;
    fifo_.clear();
    fifo_at_ = 0;
    set_line(false, now());
}

bool BmiModel::on() const {
    if (is_160()) return pmu_ == 0x14;
    return internal_status() == 1 && (regs_[0x7D] & 0x06) == 0x06;
}

double BmiModel::period_ns() const {
    if (!on()) return 0;
    const int code = regs_[0x42] & 0x0F;
    return code >= 6 && code <= 12 ? 40e6 / (1 << (code - 6)) : 0;
}

std::uint8_t BmiModel::internal_status() const {
    if (now() < init_ns_) return 0;
    return blob_good_ ? 1 : 2;
}

int BmiModel::accel_g() const {
    const int code = regs_[0x41] & 0x0F;
    if (!is_160()) return 2 << (code & 3);
    return code == 0x0C ? 16 : code == 0x08 ? 8 : code == 0x05 ? 4 : 2;
}

void BmiModel::sample(const Truth& truth, std::int64_t t_ns) {
    const double dps = 2000.0 / (1 << (regs_[0x43] & 7));
    gyro_ = counts(truth.gyro_rad_s, dps / 32768 * pi / 180);
    accel_ = counts(truth.accel_m_s2, accel_g() / 32768.0 * g_m_s2);
    temperature_ = counts(truth.temperature_c - 23.0f, 1.0 / 512);
    self_test();
    fresh_ = true;
    if (fifo_on()) {
        if (fifo_.size() == fifo_frames()) {
            fifo_.pop_front();
            fifo_at_ = 0;
        }
        std::array<std::uint8_t, frame> f{};
        for (std::size_t i = 0; i < 3; ++i) {
            f[2 * i] = low_byte(gyro_[i]);
            f[2 * i + 1] = high_byte(gyro_[i]);
            f[6 + 2 * i] = low_byte(accel_[i]);
            f[7 + 2 * i] = high_byte(accel_[i]);
        }
        fifo_.push_back(f);
    }
    const bool output = (regs_[0x53] & 0x0A) == 0x0A;
    const bool ready =
        is_160() ? (regs_[0x51] & 0x10) && (regs_[0x56] & 0x80) : (regs_[0x58] & 0x04) != 0;
    if (output && ready) pulse(t_ns);
    update_line(t_ns);
}

void BmiModel::self_test() {
    const std::uint8_t st = regs_[0x6D];
    if ((st & 0x09) != 0x09 || defective) return;
    const double sign = (st & 0x04) ? 1 : -1;
    // a little more than half of what the two directions must differ by
    const double g160[3] = {1.2, 1.3, 1.1}, g270[3] = {9, -8, 6};
    for (std::size_t i = 0; i < 3; ++i) {
        const double moved = sign * (is_160() ? g160[i] : g270[i]) / accel_g() * 32768;
        accel_[i] = static_cast<std::int16_t>(std::clamp(accel_[i] + moved, -32768.0, 32767.0));
    }
}

void BmiModel::update_line(std::int64_t t_ns) {
    const bool mapped =
        is_160() ? (regs_[0x51] & 0x40) && (regs_[0x56] & 0x40) : (regs_[0x58] & 0x02) != 0;
    if (!fifo_on() || !mapped || (regs_[0x53] & 0x0A) != 0x0A) return;
    set_line(watermark_bytes() > 0 && fifo_.size() * frame >= watermark_bytes(), t_ns);
}

std::uint8_t BmiModel::get(std::uint8_t reg) {
    if (reg == 0x00) return is_160() ? 0xD1 : 0x24;
    if (reg >= 0x0C && reg <= 0x17) {
        const std::size_t i = (reg - 0x0Cu) / 2;
        const bool gyro_first = is_160();
        const int v = (i < 3) == gyro_first ? gyro_[i % 3] : accel_[i % 3];
        if (reg == 0x17) fresh_ = false;
        return (reg & 1) ? high_byte(v) : low_byte(v);
    }
    if (reg == (is_160() ? 0x1B : 0x03))
        return static_cast<std::uint8_t>((fresh_ ? 0xC0 : 0) | (gyro_ok_ ? 0x02 : 0));
    if (reg == 0x03) return pmu_;
    if (reg == 0x21 && !is_160()) return internal_status();
    const std::uint8_t temperature = is_160() ? 0x20 : 0x22;
    if (reg == temperature) return low_byte(temperature_);
    if (reg == temperature + 1) return high_byte(temperature_);
    const std::uint8_t length = is_160() ? 0x22 : 0x24;
    const auto bytes = static_cast<int>(fifo_.size() * frame - fifo_at_);
    if (reg == length) return low_byte(bytes);
    if (reg == length + 1) return high_byte(bytes);
    if (reg == fifo_reg()) {
        if (fifo_.empty()) return 0x80;
        const std::uint8_t byte = fifo_.front()[fifo_at_];
        if (++fifo_at_ == frame) {
            fifo_.pop_front();
            fifo_at_ = 0;
            update_line(now());
        }
        return byte;
    }
    return regs_[reg & 0x7F];
}

void BmiModel::run_command(std::uint8_t value) {
    switch (value) {
        case 0xB6: reset(); break;
        case 0xB0:
            fifo_.clear();
            fifo_at_ = 0;
            update_line(now());
            break;
        case 0x11: pmu_ = static_cast<std::uint8_t>((pmu_ & 0x0F) | 0x10); break;
        case 0x15: pmu_ = static_cast<std::uint8_t>((pmu_ & 0x33) | 0x04); break;
        default: break;
    }
}

void BmiModel::set(std::uint8_t reg, std::uint8_t value) {
    if (reg == 0x7E) {
        run_command(value);
    } else if (reg == 0x5E && !is_160()) {
        if ((regs_[0x7C] & 1) || (regs_[0x59] & 1)) return;  // asleep, or not in the upload
        const std::size_t at =
            ((regs_[0x5B] & 0x0Fu) | std::size_t{regs_[0x5C]} << 4) * 2u + uploaded_;
        if (at < memory_.size()) memory_[at] = value;
        ++uploaded_;
        return;
    } else if (reg >= 0x40 && reg < 0x7E) {
        if (reg == 0x5B) uploaded_ = 0;
        if (reg == 0x59 && !is_160() && (value & 1) && !(regs_[0x59] & 1)) {
            blob_good_ = !blob_.empty() && std::equal(blob_.begin(), blob_.end(), memory_.begin());
            init_ns_ = now() + 20000000;
        }
        regs_[reg] = value;
        if (reg == 0x6D && is_160() && (value & 0x10)) gyro_ok_ = !defective;
    }
    reschedule();
}

}  // namespace fairlead::sim
