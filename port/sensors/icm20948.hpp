#pragma once
// TDK InvenSense ICM-20948: gyroscope, accelerometer, and an AK09916 behind its bypass.
//
// read() is one burst of 14 bytes. The FIFO has no watermark, no clock and no packet marks: INT
// signals every sample, the sample count is the clock, and what overflows shifts the bytes against
// each other, so that the driver then empties it and says so (overrun, then gap_before).
// Registers stand in four banks; outside of start() and self_test() bank 0 is selected.
// With Config::bypass the magnetometer is connected to the bus (ak09916.hpp, address 0x0C); on SPI
// it cannot be reached that way.
// Source: data sheet DS-000189 rev. 1.3. start(): at most 60 transactions and 130 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"

namespace fairlead::port {

namespace icm20948 {

/// 1125 Hz / (1 + divider).
struct Rate {
    std::uint8_t divider{2};
    constexpr std::int64_t period_ns() const noexcept {
        return 1000000000LL * (1 + divider) / 1125;
    }
};
inline constexpr Rate hz_1125{0}, hz_562{1}, hz_375{2}, hz_225{4}, hz_102{10};

/// Full scale = 250 deg/s * 2^code, and 2 g * 2^code.
enum class GyroRange : std::uint8_t { dps_250, dps_500, dps_1000, dps_2000 };
enum class AccelRange : std::uint8_t { g_2, g_4, g_8, g_16 };
constexpr float rad_s_per_count(GyroRange r) noexcept {
    return static_cast<float>(250 << static_cast<int>(r)) / 32768.0f * rad_per_deg;
}
constexpr float m_s2_per_count(AccelRange r) noexcept {
    return static_cast<float>(2 << static_cast<int>(r)) / 32768.0f * standard_gravity_m_s2;
}

struct Config {
    Rate rate{hz_375};
    GyroRange gyro{GyroRange::dps_2000};
    AccelRange accel{AccelRange::g_16};
    std::uint8_t filter{1};     // code of both low-pass filters: 1 is 152 Hz (gyro), 246 Hz (accel)
    std::uint8_t watermark{0};  // samples per FIFO read, at most 32; 0: data-ready, no FIFO
    bool bypass{false};         // connect the magnetometer to the bus
};

inline constexpr Part parts[] = {{0xEA, "ICM-20948"}};

enum Reg : std::uint8_t {
    who_am_i = 0x00,
    user_ctrl = 0x03,
    pwr_mgmt1 = 0x06,
    pwr_mgmt2 = 0x07,
    int_pin_cfg = 0x0F,
    int_enable1 = 0x11,
    int_status1 = 0x1A,
    int_status2 = 0x1B,
    accel_out = 0x2D,
    fifo_en2 = 0x67,
    fifo_rst = 0x68,
    fifo_mode = 0x69,
    fifo_count = 0x70,
    fifo_rw = 0x72,
    bank_select = 0x7F,
    // bank 1
    gyro_st = 0x02,
    accel_st = 0x0E,
    // bank 2
    gyro_div = 0x00,
    gyro_config1 = 0x01,
    gyro_config2 = 0x02,
    accel_div1 = 0x10,
    accel_div2 = 0x11,
    accel_config = 0x14,
    accel_config2 = 0x15,
};

/// The factory's self-test response in counts at 250 deg/s or 2 g: 2620 * 1.01^(code - 1).
constexpr float factory_response(std::uint8_t code) noexcept {
    float v = code == 0 ? 0.0f : 2620.0f;
    for (int i = 1; i < code; ++i) v *= 1.01f;
    return v;
}

}  // namespace icm20948

template <class Bus>
class Icm20948 : public ImuDriver<Bus, 12> {
    using Base = ImuDriver<Bus, 12>;
    using Base::chip_, Base::unknown_, Base::settings_, Base::scale_, Base::line_;
    using Base::temperature_c_, Base::settle, Base::settle_for;

  public:
    using Config = icm20948::Config;
    static constexpr std::uint8_t default_address = 0x68;

    explicit Icm20948(Bus& bus, std::uint8_t address = default_address,
                      UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    Probe probe() const noexcept {
        return probe_for(chip_, icm20948::who_am_i, icm20948::parts, unknown_);
    }

    /// Reset, identity, settings, each read back. Until the gyroscope has started, 35 ms, samples
    /// carry flag::settling.
    Status start(const Config& config) noexcept {
        using namespace icm20948;
        if (config.watermark > 32 || config.filter > 7) return Status::bad_argument;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        if (const Status s = chip_.set(pwr_mgmt1, 0x01); s != Status::ok) return s;
        chip_.bus().pause_us(5000);  // out of sleep
        if (const Status s = write_bank2(); s != Status::ok) return s;
        const bool fifo = config.watermark > 0;
        settings_.clear();
        settings_.add(pwr_mgmt1, 0x01);
        settings_.add(pwr_mgmt2, 0x00);
        settings_.add(int_pin_cfg, config.bypass ? 0x02 : 0x00);
        settings_.add(int_enable1, 0x01);
        settings_.add(fifo_mode, 0x00);               // the oldest give way
        settings_.add(fifo_en2, fifo ? 0x1F : 0x00);  // accelerometer, gyroscope, thermometer
        settings_.add(user_ctrl, fifo ? 0x40 : 0x00, 0x60);
        if (const Status s = settings_.write(chip_); s != Status::ok) return s;
        scale_ = {rad_s_per_count(config.gyro), m_s2_per_count(config.accel)};
        const std::int64_t period = config.rate.period_ns();
        line_.configure(period * 1000, period, 32);
        settle_for(35000000);
        return fifo ? empty() : Status::ok;
    }

    /// Reading clears the bit.
    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(icm20948::int_status1);
        if (!status) return status.status();
        return (*status & 0x01) != 0;
    }

    /// One transaction: the newest sample, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t b[14] = {};
        const Status s = chip_.read(icm20948::accel_out, b, sizeof b);
        if (s != Status::ok) return s;
        return to_sample(parse(b), scale_, edge_ns, settle());
    }

    /// Everything in the FIFO, up to a batch. edge_ns: of the newest sample, or no_edge.
    Status read_fifo(std::int64_t edge_ns, std::int64_t now_ns, Batch& batch) noexcept {
        using namespace icm20948;
        batch.clear();
        std::uint8_t status = 0, size[2] = {};
        const std::uint8_t status_reg = int_status2, count_reg = fifo_count;
        const Transfer both[2] = {{chip_.address(), &status_reg, 1, &status, 1},
                                  {chip_.address(), &count_reg, 1, size, 2}};
        Status s = chip_.bus().transfer(both, 2);
        if (s != Status::ok) return s;
        const unsigned bytes = static_cast<std::uint16_t>(big_endian(size)) & 0x1FFFu;
        if ((status & 0x1F) != 0 || bytes > fifo_size - 14) {  // the next sample shifts the bytes
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

    /// Response over the factory's, per axis; passes from 0.5 up (gyro) and 0.5 to 1.5 (accel).
    /// Leaves the chip reset: start() again. At most 0.9 s.
    Status self_test(SelfTest& result) noexcept {
        using namespace icm20948;
        result = {};
        Config test;
        test.rate = hz_1125;
        test.gyro = GyroRange::dps_250;
        test.accel = AccelRange::g_2;
        if (const Status s = start(test); s != Status::ok) return s;
        std::uint8_t codes[6] = {};
        if (const Status s = select(1); s != Status::ok) return s;
        if (const Status s = chip_.read(gyro_st, codes, 3); s != Status::ok) return s;
        if (const Status s = chip_.read(accel_st, codes + 3, 3); s != Status::ok) return s;
        if (const Status s = select(0); s != Status::ok) return s;
        std::array<float, 6> off{}, on{};
        if (const Status s = average(off); s != Status::ok) return s;
        if (const Status s = select(2); s != Status::ok) return s;
        if (const Status s = chip_.set(gyro_config2, 0x38); s != Status::ok) return s;
        if (const Status s = chip_.set(accel_config2, 0x1C); s != Status::ok) return s;
        if (const Status s = select(0); s != Status::ok) return s;
        if (const Status s = average(on); s != Status::ok) return s;
        result.passed = true;
        for (std::size_t i = 0; i < 6; ++i) {
            const float factory = factory_response(codes[i]);
            const float change = on[i] - off[i];
            const float ratio = factory == 0.0f ? 0.0f : (change < 0 ? -change : change) / factory;
            result.response[i] = ratio;
            if (ratio < 0.5f || (i >= 3 && ratio > 1.5f)) result.passed = false;
        }
        return reset();
    }

    std::size_t watermark() const noexcept { return config_.watermark; }
    std::size_t samples_per_edge() const noexcept { return 1; }

  private:
    static constexpr unsigned fifo_size = 512;

    Status select(int bank) const noexcept {
        return chip_.write(icm20948::bank_select, static_cast<std::uint8_t>(bank << 4));
    }

    /// Bank 0 first: a program that ended in another one must not make the identity unreadable.
    Status reset() noexcept {
        using namespace icm20948;
        if (const Status s = select(0); s != Status::ok) return s;
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(pwr_mgmt1, 0x80); s != Status::ok) return s;
        chip_.bus().pause_us(11000);
        return chip_.await(pwr_mgmt1, 0x80, 0x00, 100, 1000);
    }

    /// Rates, ranges and filters, and back to bank 0.
    Status write_bank2() noexcept {
        using namespace icm20948;
        if (const Status s = select(2); s != Status::ok) return s;
        const auto code = [this](std::uint8_t range) {
            return static_cast<std::uint8_t>(config_.filter << 3 | range << 1 | 0x01);
        };
        settings_.clear();
        settings_.add(gyro_div, config_.rate.divider);
        settings_.add(gyro_config1, code(static_cast<std::uint8_t>(config_.gyro)));
        settings_.add(accel_div1, 0x00);
        settings_.add(accel_div2, config_.rate.divider);
        settings_.add(accel_config, code(static_cast<std::uint8_t>(config_.accel)));
        if (const Status s = settings_.write(chip_); s != Status::ok) return s;
        return select(0);
    }

    /// Empties the FIFO; the line begins anew, since the count is its clock.
    Status empty() noexcept {
        line_.restart();
        const std::uint8_t on[2] = {icm20948::fifo_rst, 0x1F}, off[2] = {icm20948::fifo_rst, 0x00};
        const Transfer both[2] = {{chip_.address(), on, sizeof on, nullptr, 0},
                                  {chip_.address(), off, sizeof off, nullptr, 0}};
        return chip_.bus().transfer(both, 2);
    }

    /// In registers and FIFO alike: accelerometer, gyroscope, thermometer.
    RawImu parse(const std::uint8_t* b) noexcept {
        RawImu raw;
        raw.accel = triple<big_endian>(b);
        raw.gyro = triple<big_endian>(b + 6);
        temperature_c_ = static_cast<float>(big_endian(b + 12)) / 333.87f + 21.0f;
        return raw;
    }

    Status average(std::array<float, 6>& mean) const noexcept {
        return Base::template average<14>(icm20948::accel_out, 6, 0, 50000, mean);
    }

    Config config_{};
    std::uint32_t next_tick_{0};
};

}  // namespace fairlead::port
