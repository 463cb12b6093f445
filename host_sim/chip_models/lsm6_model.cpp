#include "host_sim/chip_models/lsm6_model.hpp"

namespace fairlead::sim {

void Lsm6Model::reset() {
    regs_ = hub_ = embedded_ = {};
    regs_[0x0F] = dso() ? 0x6C : 0x70;
    regs_[0x12] = dso() ? 0x04 : 0x44;
    if (dso()) regs_[0x18] = 0xE0;
    regs_[dso() ? 0x63 : 0x4F] = static_cast<std::uint8_t>(trim);
    gyro_ = accel_ = {};
    temperature_ = 0;
    fresh_gyro_ = fresh_accel_ = false;
    fifo_.clear();
    overrun_ = overrun_latched_ = false;
    tick_zero_ns_ = now();
    set_line(false, now());
    i3c_only_ = false;
}

double Lsm6Model::period_ns() const {
    const int code = dso() ? regs_[0x10] >> 4 : regs_[0x10] & 0x0F;
    if (code == 0 || (dso() && code > 10) || (!dso() && code > 12)) return 0;
    return dso() ? 1e9 / 6667 * (1 << (10 - code)) : 1e9 / 7680 * (1 << (12 - code));
}

std::uint32_t Lsm6Model::ticks(std::int64_t t_ns) const {
    const double tick_ns = dso() ? 25000.0 : 1e9 / 46080;
    return static_cast<std::uint32_t>(
        static_cast<std::int64_t>(chip_time_ns(t_ns - tick_zero_ns_) / tick_ns));
}

void Lsm6Model::sample(const Truth& truth, std::int64_t t_ns) {
    double dps = 0, g = 0;
    if (dso()) {
        const int fs = regs_[0x11] >> 1 & 7;  // bit 0 of the code selects 125 deg/s
        dps = (fs & 1) ? 125 : 250 << (fs >> 1);
        const int ranges[4] = {2, 16, 4, 8};
        g = ranges[regs_[0x10] >> 2 & 3];
    } else {
        const int fs = regs_[0x15] & 0x0F;
        dps = fs == 12 ? 4000 : 125 << (fs & 7);
        g = 2 << (regs_[0x17] & 3);
    }
    gyro_ = counts(truth.gyro_rad_s, dps / 125 * 4.375e-3 * pi / 180);
    accel_ = counts(truth.accel_m_s2, g / 2 * 0.061e-3 * g_m_s2);
    temperature_ = counts(truth.temperature_c - 25.0f, 1.0 / 256);
    if (!defective) self_test();
    fresh_gyro_ = fresh_accel_ = true;
    const bool pulsed = dso() ? (regs_[0x0B] & 0x80) != 0 : (regs_[0x13] & 0x02) != 0;
    if (regs_[0x0D] & 0x03) {
        if (pulsed)
            pulse(t_ns);
        else
            set_line(true, t_ns);
    }
    batch(t_ns);
}

void Lsm6Model::self_test() {
    const std::uint8_t st = regs_[dso() ? 0x14 : 0x19];
    const double dps_count = 70e-3, g_count = 0.122e-3;  // at 2000 deg/s and 4 g, where it is used
    for (std::size_t i = 0; i < 3; ++i) {
        if ((st >> 2 & 3) == 1) gyro_[i] = static_cast<std::int16_t>(gyro_[i] + 400 / dps_count);
        if ((st & 3) == 1) accel_[i] = static_cast<std::int16_t>(accel_[i] + 0.5 / g_count);
    }
}

void Lsm6Model::batch(std::int64_t t_ns) {
    const int mode = regs_[0x0A] & 7;
    if (mode == 0 || regs_[0x09] == 0) return;
    slot_ = (slot_ + 1) & 3;
    std::uint8_t six[6] = {};
    if (regs_[0x0A] & 0xC0) {
        const std::uint32_t t = ticks(t_ns);
        for (unsigned i = 0; i < 4; ++i) six[i] = static_cast<std::uint8_t>(t >> 8 * i & 0xFF);
        push_word(4, six);
    }
    const auto put = [&](int tag, const std::array<std::int16_t, 3>& v) {
        for (std::size_t i = 0; i < 3; ++i) {
            six[2 * i] = low_byte(v[i]);
            six[2 * i + 1] = high_byte(v[i]);
        }
        push_word(tag, six);
    };
    if (regs_[0x09] & 0xF0) put(1, gyro_);
    if (regs_[0x09] & 0x0F) put(2, accel_);
    update_line(t_ns);
}

void Lsm6Model::push_word(int tag, const std::uint8_t* six) {
    if (fifo_.size() == fifo_words()) {
        overrun_ = overrun_latched_ = true;
        if ((regs_[0x0A] & 7) == 1) return;  // FIFO mode stops when full
        fifo_.pop_front();
    }
    Word w{};
    w[0] = static_cast<std::uint8_t>(tag << 3 | static_cast<int>(slot_) << 1);
    if (corrupt_tag) w[0] = 0xF8;
    corrupt_tag = false;
    for (std::size_t i = 0; i < 6; ++i) w[1 + i] = six[i];
    fifo_.push_back(w);
}

void Lsm6Model::update_line(std::int64_t t_ns) {
    if (!(regs_[0x0D] & 0x08)) return;
    const std::size_t watermark =
        regs_[0x07] | (dso() ? static_cast<std::size_t>(regs_[0x08] & 1) << 8 : 0);
    set_line(watermark > 0 && fifo_.size() >= watermark, t_ns);
}

std::uint8_t Lsm6Model::fifo_status(bool high) {
    const std::size_t level = fifo_.size();
    if (!high) return static_cast<std::uint8_t>(level & 0xFF);
    auto value = static_cast<unsigned>(level >> 8 & (dso() ? 3 : 1));
    const std::size_t watermark =
        regs_[0x07] | (dso() ? static_cast<std::size_t>(regs_[0x08] & 1) << 8 : 0);
    if (watermark > 0 && level >= watermark) value |= 0x80;
    if (overrun_) value |= 0x40;
    if (level == fifo_words()) value |= 0x20;
    if (overrun_latched_) value |= 0x08;
    overrun_latched_ = false;
    return static_cast<std::uint8_t>(value);
}

/// Reading the last byte of a word takes it out.
std::uint8_t Lsm6Model::fifo_byte(std::uint8_t reg) {
    if (fifo_.empty()) return 0;
    const std::uint8_t byte = fifo_.front()[reg - 0x78u];
    if (reg == 0x7E) {
        fifo_.pop_front();
        overrun_ = false;
        update_line(now());
    }
    return byte;
}

std::uint8_t Lsm6Model::after(std::uint8_t reg) const {
    if (reg == 0x7E) return 0x78;
    return (regs_[0x12] & 0x04) ? static_cast<std::uint8_t>(reg + 1) : reg;
}

/// The page that the bus sees instead of the main one, or null.
std::array<std::uint8_t, 256>* Lsm6Model::page() {
    if (regs_[0x01] & 0x80) return &embedded_;
    return (regs_[0x01] & 0x40) ? &hub_ : nullptr;
}

std::uint8_t Lsm6Model::get(std::uint8_t reg) {
    if (reg != 0x01 && page() != nullptr) return (*page())[reg];
    if (reg >= 0x20 && reg <= 0x2D) {
        const std::size_t i = (reg - 0x20u) / 2;
        const int v = i == 0 ? temperature_ : i < 4 ? gyro_[i - 1] : accel_[i - 4];
        if (i >= 1 && i < 4) fresh_gyro_ = false;
        if (i >= 4) fresh_accel_ = false;
        if (!(regs_[0x0D] & 0x08)) set_line(false, now());
        return (reg & 1) ? high_byte(v) : low_byte(v);
    }
    if (reg >= 0x40 && reg <= 0x43)
        return static_cast<std::uint8_t>(ticks(now()) >> 8 * (reg - 0x40u) & 0xFF);
    if (reg >= 0x78 && reg <= 0x7E) return fifo_byte(reg);
    const std::uint8_t status = dso() ? 0x3A : 0x1B;
    if (reg == status) return fifo_status(false);
    if (reg == status + 1) return fifo_status(true);
    if (reg == 0x1E)
        return static_cast<std::uint8_t>((fresh_accel_ ? 1 : 0) | (fresh_gyro_ ? 2 : 0) |
                                         (fresh_gyro_ ? 4 : 0));
    return regs_[reg];
}

void Lsm6Model::set(std::uint8_t reg, std::uint8_t value) {
    if (reg != 0x01 && page() != nullptr) {
        (*page())[reg] = value;
        return;
    }
    const std::uint8_t trim_reg = dso() ? 0x63 : 0x4F;
    if (reg == 0x0F || reg == 0x1E || (reg >= 0x20 && reg <= 0x2D) || reg == trim_reg) return;
    if (reg == 0x42 && value == 0xAA) {
        tick_zero_ns_ = now();
        return;
    }
    if (reg == 0x12 && (value & 0x81)) {
        const bool i3c_only = line() && (value & 0x01);
        reset();
        i3c_only_ = i3c_only;
        reschedule();
        return;
    }
    regs_[reg] = value;
    if (reg == 0x0D && value == 0) set_line(false, now());
    if (reg == 0x0A && (value & 7) == 0) {
        fifo_.clear();
        overrun_ = overrun_latched_ = false;
        update_line(now());
    }
    reschedule();
}

}  // namespace fairlead::sim
