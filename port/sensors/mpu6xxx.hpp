#pragma once
// InvenSense MPU-6050, MPU-6500, MPU-9250 and relatives: one driver, one table of parts.
//
// read() is one burst of 14 bytes. The FIFO of these parts has no watermark, no clock and no packet
// marks: INT signals every sample, the sample count is the clock, and an overflow shifts the bytes
// against each other, so that the driver then empties it and says so (overrun, then gap_before).
// The magnetometer of the 9250 family stands behind a bypass: Config::bypass connects it to the
// bus. Source: RM-MPU-6000A, RM-MPU-9250A, and the self-test notes of both. start(): at most 125
// transactions and 105 ms of pauses; of a chip that resets in the typical 11 ms, 36 and 16 ms.
// After a brown-out, told by two registers, no reset is added to the chip's own.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"

namespace fairlead::port {

namespace mpu6xxx {

/// 1 kHz / (1 + divider): all the rates of the part that have a low-pass filter before them.
struct Rate {
    std::uint8_t divider{1};
    constexpr std::int64_t period_ns() const noexcept { return 1000000LL * (1 + divider); }
};
inline constexpr Rate hz_1000{0}, hz_500{1}, hz_333{2}, hz_250{3}, hz_200{4}, hz_100{9}, hz_50{19};

/// The codes' own order: full scale = 250 deg/s * 2^code, and 2 g * 2^code.
enum class GyroRange : std::uint8_t { dps_250, dps_500, dps_1000, dps_2000 };
enum class AccelRange : std::uint8_t { g_2, g_4, g_8, g_16 };
constexpr float rad_s_per_count(GyroRange r) noexcept {
    return static_cast<float>(250 << static_cast<int>(r)) / 32768.0f * rad_per_deg;
}
constexpr float m_s2_per_count(AccelRange r) noexcept {
    return static_cast<float>(2 << static_cast<int>(r)) / 32768.0f * standard_gravity_m_s2;
}
/// Gyroscope cut-off; the accelerometer's is within a few Hz of it. Names are the 6500's values.
enum class Filter : std::uint8_t { hz_184 = 1, hz_92, hz_41, hz_20, hz_10, hz_5 };

struct Config {
    Rate rate{hz_500};
    GyroRange gyro{GyroRange::dps_2000};
    AccelRange accel{AccelRange::g_16};
    Filter filter{Filter::hz_184};
    std::uint8_t watermark{0};  // samples per FIFO read, at most 32; 0: data-ready, no FIFO
    bool bypass{false};         // connect the auxiliary bus (the magnetometer) to ours
};

struct Part {
    std::uint8_t id;
    const char* name;
    bool second_generation;  // 6500 and later: own accelerometer filter, other self test and
                             // thermometer
    std::uint16_t fifo_size;
};
inline constexpr Part parts[] = {{0x68, "MPU-6050", false, 1024}, {0x70, "MPU-6500", true, 512},
                                 {0x71, "MPU-9250", true, 512},   {0x73, "MPU-9255", true, 512},
                                 {0x74, "MPU-6515", true, 512},   {0x78, "MPU-6880", true, 4096}};

enum Reg : std::uint8_t {
    gyro_st_6500 = 0x00,
    st_6050 = 0x0D,
    accel_st_6500 = 0x0D,
    smplrt_div = 0x19,
    config = 0x1A,
    gyro_config = 0x1B,
    accel_config = 0x1C,
    accel_config2 = 0x1D,
    fifo_en = 0x23,
    int_pin_cfg = 0x37,
    int_enable = 0x38,
    int_status = 0x3A,
    accel_out = 0x3B,
    user_ctrl = 0x6A,
    pwr_mgmt1 = 0x6B,
    pwr_mgmt2 = 0x6C,
    fifo_count = 0x72,
    fifo_rw = 0x74,
    who_am_i = 0x75,
};

constexpr float power(float base, int exponent) noexcept {
    float v = 1.0f;
    for (int i = 0; i < exponent; ++i) v *= base;
    return v;
}
/// The factory's responses in counts at 250 deg/s and, for the 6050, 8 g; for later parts 2 g.
constexpr float gyro_trim_6050(int code) noexcept {
    return code == 0 ? 0.0f : 25.0f * 131.0f * power(1.046f, code - 1);
}
constexpr float accel_trim_6050(int code) noexcept {  // 0.34 * (0.92 / 0.34)^((code - 1) / 30) g
    return code == 0 ? 0.0f : 4096.0f * 0.34f * power(1.03373896f, code - 1);
}
constexpr float trim_6500(int code) noexcept {
    return code == 0 ? 0.0f : 2620.0f * power(1.01f, code - 1);
}

}  // namespace mpu6xxx

template <class Bus>
class Mpu6xxx : public ImuDriver<Bus, 12> {
    using Base = ImuDriver<Bus, 12>;
    using Base::chip_, Base::unknown_, Base::settings_, Base::scale_, Base::line_;
    using Base::temperature_c_, Base::settle, Base::settle_for;

  public:
    using Config = mpu6xxx::Config;
    static constexpr std::uint8_t default_address = 0x68;

    explicit Mpu6xxx(Bus& bus, std::uint8_t address = default_address,
                     UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    /// Also learns which part it is; an unknown one that is accepted counts as second generation.
    Probe probe() noexcept {
        const Probe p = probe_for(chip_, mpu6xxx::who_am_i, mpu6xxx::parts, unknown_);
        second_generation_ = true;
        fifo_size_ = 512;
        for (const auto& part : mpu6xxx::parts)
            if (part.id == p.got) {
                second_generation_ = part.second_generation;
                fifo_size_ = part.fifo_size;
            }
        return p;
    }

    /// Reset, identity, settings, each read back. Until the gyroscope has started, 35 ms, samples
    /// carry flag::settling.
    Status start(const Config& wanted) noexcept {
        using namespace mpu6xxx;
        if (wanted.watermark > 32) return Status::bad_argument;  // 448 of the 512 bytes
        config_ = wanted;
        if (const Status s = reset(); s != Status::ok) return s;
        if (const Status s = chip_.set(pwr_mgmt1, 0x01); s != Status::ok) return s;
        chip_.bus().pause_us(5000);  // out of sleep
        const bool fifo = wanted.watermark > 0;
        const auto filter = static_cast<std::uint8_t>(wanted.filter);
        settings_.clear();
        settings_.add(pwr_mgmt1, 0x01);  // gyroscope's oscillator
        settings_.add(pwr_mgmt2, 0x00);
        settings_.add(smplrt_div, wanted.rate.divider);
        settings_.add(mpu6xxx::config, filter);
        settings_.add(gyro_config, range_code(static_cast<std::uint8_t>(wanted.gyro)));
        settings_.add(accel_config, range_code(static_cast<std::uint8_t>(wanted.accel)));
        if (second_generation_) settings_.add(accel_config2, filter, 0x0F);
        settings_.add(int_pin_cfg, wanted.bypass ? 0x02 : 0x00);  // push-pull, high, 50 us pulse
        settings_.add(int_enable, 0x01);
        settings_.add(fifo_en, fifo ? 0xF8 : 0x00);  // temperature, gyroscope, accelerometer
        settings_.add(user_ctrl, fifo ? 0x40 : 0x00, 0x60);
        if (const Status s = settings_.write(chip_); s != Status::ok) return s;
        scale_ = {rad_s_per_count(wanted.gyro), m_s2_per_count(wanted.accel)};
        const std::int64_t period = wanted.rate.period_ns();
        line_.configure(period * 1000, period, 32);
        settle_for(35000000);
        started_ = true;
        return fifo ? empty() : Status::ok;
    }

    /// Reading clears the bit.
    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(mpu6xxx::int_status);
        if (!status) return status.status();
        return (*status & 0x01) != 0;
    }

    /// One transaction: the newest sample, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t b[14] = {};
        const Status s = chip_.read(mpu6xxx::accel_out, b, sizeof b);
        if (s != Status::ok) return s;
        return to_sample(parse(b), scale_, edge_ns, settle());
    }

    /// Everything in the FIFO, up to a batch. edge_ns: of the newest sample, or no_edge.
    Status read_fifo(std::int64_t edge_ns, std::int64_t now_ns, Batch& batch) noexcept {
        using namespace mpu6xxx;
        batch.clear();
        std::uint8_t status = 0, size[2] = {};
        const std::uint8_t status_reg = int_status, count_reg = fifo_count;
        const Transfer both[2] = {{chip_.address(), &status_reg, 1, &status, 1},
                                  {chip_.address(), &count_reg, 1, size, 2}};
        Status s = chip_.bus().transfer(both, 2);
        if (s != Status::ok) return s;
        const auto bytes = static_cast<std::uint16_t>(big_endian(size));
        if ((status & 0x10) != 0 || bytes > fifo_size_ - 14) {  // the next sample shifts the bytes
            batch.state = FifoState::overrun;
            return empty();
        }
        const std::size_t records = bytes / 14u;
        const std::size_t count = records < Batch::capacity ? records : Batch::capacity;
        batch.more = records > count;
        const std::uint32_t first = next_tick_;
        s = read_packets(chip_, fifo_rw, 14, count, [&](const std::uint8_t* p) {
            const std::int64_t tick = line_.unwrap(next_tick_++);
            batch.samples[batch.count++] = to_sample(parse(p), scale_, tick, settle());
            return true;
        });
        if (count > 0 && edge_ns != no_edge && !batch.more) {
            const std::int64_t age = (now_ns - edge_ns) / line_.period_ns();  // edges since, unseen
            const auto index = static_cast<std::int64_t>(count) - 1 - (age > 0 ? age : 0);
            stamp(batch, line_, index < 0 ? Batch::capacity : static_cast<std::size_t>(index),
                  edge_ns, now_ns);
        } else {
            stamp(batch, line_, 0, no_edge, now_ns);
        }
        if (s == Status::ok) return s;
        next_tick_ = first + static_cast<std::uint32_t>(count);
        batch.state = FifoState::resync;  // how much was taken out is unknown: begin again
        const Status emptied = empty();
        return emptied == Status::ok ? s : emptied;
    }

    /// Change against the factory's, per axis: passes within 14 % (6050), or from 0.5 up for the
    /// gyroscope and 0.5 to 1.5 for the accelerometer (6500 and later). Leaves the chip reset:
    /// start() again. At most 1.3 s.
    Status self_test(SelfTest& result) noexcept {
        using namespace mpu6xxx;
        result = {};
        Config test;
        test.rate = hz_1000;
        test.filter = Filter::hz_92;
        test.gyro = GyroRange::dps_250;
        test.accel = AccelRange::g_2;
        if (const Status s = start(test); s != Status::ok) return s;
        if (!second_generation_) test.accel = AccelRange::g_8;
        std::array<float, 6> trim{}, off{}, on{};
        if (const Status s = read_trim(trim); s != Status::ok) return s;
        if (const Status s = self_test_bits(test, 0x00); s != Status::ok) return s;
        if (const Status s = average(off); s != Status::ok) return s;
        if (const Status s = self_test_bits(test, 0xE0); s != Status::ok) return s;
        if (const Status s = average(on); s != Status::ok) return s;
        result.passed = true;
        for (std::size_t i = 0; i < 6; ++i) {
            if (trim[i] == 0.0f) {
                result.passed = false;
                continue;
            }
            const float ratio = (on[i] - off[i]) / trim[i];
            result.response[i] = ratio;
            const float low = second_generation_ ? 0.5f : 0.86f;
            const float high = !second_generation_ ? 1.14f : i < 3 ? 1e9f : 1.5f;
            if (ratio < low || ratio > high) result.passed = false;
        }
        return reset();
    }

    std::size_t watermark() const noexcept { return config_.watermark; }
    std::size_t samples_per_edge() const noexcept { return 1; }

  private:
    static std::uint8_t range_code(std::uint8_t code) noexcept {
        return static_cast<std::uint8_t>(code << 3);
    }

    /// The bit clears itself when the reset is done; until then the chip need not acknowledge. The
    /// pauses of 100 ms in the register map are those of the SPI interface.
    Status reset() noexcept {
        using namespace mpu6xxx;
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (started_ && has_reset_itself()) return Status::ok;
        started_ = false;
        Status s = chip_.write(pwr_mgmt1, 0x80);
        if (s != Status::ok) return s;
        s = Status::timeout;
        for (int i = 0; i < reset_looks && s != Status::ok; ++i) {
            chip_.bus().pause_us(reset_look_us);
            s = chip_.expect(pwr_mgmt1, 0x00, 0x80);
        }
        return s;
    }

    /// start() sets both registers to something else than their reset values, always.
    bool has_reset_itself() const noexcept {
        return chip_.expect(mpu6xxx::config, 0x00) == Status::ok &&
               chip_.expect(mpu6xxx::int_enable, 0x00) == Status::ok;
    }

    /// Empties the FIFO; the line begins anew, since the count is its clock.
    Status empty() noexcept {
        line_.restart();
        return chip_.write(mpu6xxx::user_ctrl, 0x44);
    }

    RawImu parse(const std::uint8_t* b) noexcept {
        RawImu raw;
        raw.accel = triple<big_endian>(b);
        raw.temperature = big_endian(b + 6);
        raw.gyro = triple<big_endian>(b + 8);
        const auto t = static_cast<float>(raw.temperature);
        temperature_c_ = second_generation_ ? (t + 7011.0f) * 2.995178e-3f : t / 340.0f + 36.53f;
        return raw;
    }

    Status self_test_bits(const Config& c, std::uint8_t bits) const noexcept {
        using namespace mpu6xxx;
        const auto gyro = static_cast<std::uint8_t>(range_code(static_cast<std::uint8_t>(c.gyro)));
        const auto accel =
            static_cast<std::uint8_t>(range_code(static_cast<std::uint8_t>(c.accel)));
        if (const Status s = chip_.set(gyro_config, gyro | bits); s != Status::ok) return s;
        return chip_.set(accel_config, accel | bits);
    }

    Status read_trim(std::array<float, 6>& trim) const noexcept {
        using namespace mpu6xxx;
        std::uint8_t gyro[3] = {}, accel[4] = {};
        if (!second_generation_) {
            if (const Status s = chip_.read(st_6050, accel, 4); s != Status::ok) return s;
            for (std::size_t i = 0; i < 3; ++i) {
                const int low = accel[3] >> (4 - 2 * static_cast<int>(i)) & 3;
                trim[i] = gyro_trim_6050(accel[i] & 0x1F) * (i == 1 ? -1.0f : 1.0f);
                trim[3 + i] = accel_trim_6050((accel[i] >> 5) << 2 | low);
            }
            return Status::ok;
        }
        if (const Status s = chip_.read(gyro_st_6500, gyro, 3); s != Status::ok) return s;
        if (const Status s = chip_.read(accel_st_6500, accel, 3); s != Status::ok) return s;
        for (std::size_t i = 0; i < 3; ++i) {
            trim[i] = trim_6500(gyro[i]);
            trim[3 + i] = trim_6500(accel[i]);
        }
        return Status::ok;
    }

    Status average(std::array<float, 6>& mean) const noexcept {
        return Base::template average<14>(mpu6xxx::accel_out, 8, 0, 50000, mean);
    }

    static constexpr int reset_looks = 100;  // 100 ms: the longest start-up in the data sheets
    static constexpr std::uint32_t reset_look_us = 1000;

    bool started_{false};  // all settings stood
    bool second_generation_{true};
    std::uint16_t fifo_size_{512};
    Config config_{};
    std::uint32_t next_tick_{0};
};

}  // namespace fairlead::port
