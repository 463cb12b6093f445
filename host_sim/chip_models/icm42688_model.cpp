#include "host_sim/chip_models/icm42688_model.hpp"

namespace fairlead::sim {
namespace {

// the factory's self-test codes and what the test moves: 2620 * 1.01^(code - 1) counts
constexpr std::uint8_t gyro_code = 90, accel_code = 60;
double factory(int code) { return 2620.0 * std::pow(1.01, code - 1); }

}  // namespace

void Icm42688Model::reset() {
    bank_ = 0;
    bank0_ = {};
    bank0_[0x4C] = 0x30;
    bank0_[0x4D] = 0x91;
    bank0_[0x4F] = bank0_[0x50] = 0x06;
    bank0_[0x51] = 0x16;
    bank0_[0x52] = 0x11;
    bank0_[0x53] = 0x0D;
    bank0_[0x54] = 0x23;
    bank0_[0x64] = 0x10;  // asynchronous reset of INT: must be cleared for the pin to work
    bank0_[0x65] = 0x10;
    gyro_ = accel_ = {INT16_MIN, INT16_MIN, INT16_MIN};
    temperature_ = INT16_MIN;
    status_ = 0x10;  // reset done
    fifo_.clear();
    fifo_at_ = 0;
    set_line(false, now());
}

double Icm42688Model::period_ns() const {
    if (!gyro_on() && !accel_on()) return 0;
    switch (bank0_[gyro_on() ? 0x4F : 0x50] & 0x0F) {
        case 3: return 125e3;
        case 4: return 250e3;
        case 5: return 500e3;
        case 6: return 1e6;
        case 7: return 5e6;
        case 8: return 10e6;
        case 9: return 20e6;
        case 10: return 40e6;
        case 11: return 80e6;
        case 15: return 2e6;
        default: return 0;
    }
}

void Icm42688Model::sample(const Truth& truth, std::int64_t t_ns) {
    const int gyro_fs = bank0_[0x4F] >> 5, accel_fs = bank0_[0x50] >> 5;
    gyro_ = counts(truth.gyro_rad_s, 2000.0 / (1 << gyro_fs) / 32768 * pi / 180);
    accel_ = counts(truth.accel_m_s2, 16.0 / (1 << (accel_fs & 3)) / 32768 * g_m_s2);
    temperature_ = counts(truth.temperature_c - 25.0f, 1 / 132.48);
    constexpr std::array<std::int16_t, 3> none{INT16_MIN, INT16_MIN, INT16_MIN};
    if (!gyro_on()) gyro_ = none;
    if (!accel_on()) accel_ = none;
    const std::uint8_t st = defective ? 0 : bank0_[0x70];
    for (std::size_t i = 0; i < 3; ++i) {
        // trims hold at 250 deg/s and 2 g: code 3 of either range
        if (st >> i & 1)
            gyro_[i] = static_cast<std::int16_t>(gyro_[i] +
                                                 factory(gyro_code) / (1 << 3) * (1 << gyro_fs));
        if ((st & 0x40) && (st >> (3 + i) & 1))
            accel_[i] = static_cast<std::int16_t>(accel_[i] +
                                                  factory(accel_code) / (1 << 3) * (1 << accel_fs));
    }
    status_ |= 0x08;
    const bool pin_works = (bank0_[0x64] & 0x10) == 0;
    if (pin_works && (bank0_[0x65] & 0x08)) pulse(t_ns);
    if (fifo_on()) push_packet(t_ns);
}

void Icm42688Model::push_packet(std::int64_t t_ns) {
    if ((bank0_[0x5F] & 0x03) != 0x03) return;  // accelerometer and gyroscope
    if (fifo_.size() == fifo_packets) {
        status_ |= 0x02;
        if ((bank0_[0x16] & 0x80) != 0) return;  // stop on full
        fifo_.pop_front();
        fifo_at_ = 0;
    }
    std::array<std::uint8_t, packet> p{};
    p[0] = 0x68;
    for (std::size_t i = 0; i < 3; ++i) {
        p[1 + 2 * i] = high_byte(accel_[i]);
        p[2 + 2 * i] = low_byte(accel_[i]);
        p[7 + 2 * i] = high_byte(gyro_[i]);
        p[8 + 2 * i] = low_byte(gyro_[i]);
    }
    p[13] = low_byte(static_cast<int>(std::lround(temperature_ / 132.48 * 2.07)));
    const double tick_ns = (bank0_[0x54] & 0x08) ? 16000 : 1000;
    const auto tick = static_cast<std::int64_t>(chip_time_ns(t_ns) / tick_ns);
    p[14] = high_byte(static_cast<int>(tick & 0xFFFF));
    p[15] = low_byte(static_cast<int>(tick & 0xFFFF));
    fifo_.push_back(p);
    const int watermark = bank0_[0x60] | (bank0_[0x61] & 0x0F) << 8;
    const int level = fifo_count();
    const int step = (bank0_[0x4C] & 0x40) ? 1 : static_cast<int>(packet);
    const bool crossed = level >= watermark && level - step < watermark;
    const bool again = (bank0_[0x5F] & 0x20) && level >= watermark;
    if (watermark == 0 || !(crossed || again)) return;
    status_ |= 0x04;
    if ((bank0_[0x64] & 0x10) == 0 && (bank0_[0x65] & 0x04)) pulse(t_ns);
}

int Icm42688Model::fifo_count() const {
    const bool records = (bank0_[0x4C] & 0x40) != 0;
    return static_cast<int>(fifo_.size() * (records ? 1 : packet));
}

std::uint8_t Icm42688Model::fifo_byte() {
    if (fifo_.empty()) return 0x80;  // header of an empty FIFO
    const std::uint8_t byte = fifo_.front()[fifo_at_];
    if (++fifo_at_ == packet) {
        fifo_.pop_front();
        fifo_at_ = 0;
    }
    return byte;
}

std::uint8_t Icm42688Model::get(std::uint8_t reg) {
    if (reg == 0x76) return bank_;
    if (bank_ == 1) return reg >= 0x5F && reg <= 0x61 ? gyro_code : 0;
    if (bank_ == 2) return reg >= 0x3B && reg <= 0x3D ? accel_code : 0;
    if (bank_ != 0) return 0;
    const bool big = (bank0_[0x4C] & 0x10) != 0;
    if (reg >= 0x1D && reg <= 0x2A) {
        const std::size_t i = (reg - 0x1Du) / 2;
        const int v = i == 0 ? temperature_ : i < 4 ? accel_[i - 1] : gyro_[i - 4];
        return ((reg - 0x1D) % 2 == 0) == big ? high_byte(v) : low_byte(v);
    }
    switch (reg) {
        case 0x2D: {
            const std::uint8_t value = status_;
            status_ = 0;
            return value;
        }
        case 0x2E: return (bank0_[0x4C] & 0x20) ? high_byte(fifo_count()) : low_byte(fifo_count());
        case 0x2F: return (bank0_[0x4C] & 0x20) ? low_byte(fifo_count()) : high_byte(fifo_count());
        case 0x30: return fifo_byte();
        case 0x75: return id_;
        default: return bank0_[reg];
    }
}

void Icm42688Model::set(std::uint8_t reg, std::uint8_t value) {
    if (reg == 0x76) {
        bank_ = value & 7;
        return;
    }
    if (bank_ != 0) return;
    if (reg == 0x11 && (value & 1)) {
        reset();
    } else if (reg == 0x4B) {
        if (value & 0x02) {
            fifo_.clear();
            fifo_at_ = 0;
        }
    } else if (reg != 0x75 && !(reg >= 0x1D && reg <= 0x30)) {
        bank0_[reg] = value;
        if (reg == 0x16 && (value & 0xC0) == 0) fifo_.clear();
    }
    reschedule();
}

}  // namespace fairlead::sim
