#pragma once
// TDK InvenSense ICM-42688-P and its register-compatible relatives ICM-42605 and IIM-42652.
//
// start() resets, configures and reads every setting back; read() is one burst of 14 bytes; with a
// watermark the FIFO delivers packets of 16 bytes, each with the chip's own 16-bit time.
// Two facts that public drivers paid for: INT_ASYNC_RESET must be cleared for INT1 to work at all,
// and the adaptive full-scale range of the gyroscope must be off, or the gyro stalls.
// Source: data sheet DS-000347. Bounded: start() at most 40 transactions and 32 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"

namespace fairlead::port {

namespace icm426xx {

enum class Rate : std::uint8_t {
    hz_8000 = 3,
    hz_4000 = 4,
    hz_2000 = 5,
    hz_1000 = 6,
    hz_500 = 15,
    hz_200 = 7,
    hz_100 = 8,
    hz_50 = 9,
    hz_25 = 10,
    hz_12_5 = 11,
};
constexpr std::int64_t period_ns(Rate r) noexcept {
    switch (r) {
        case Rate::hz_8000: return 125000;
        case Rate::hz_4000: return 250000;
        case Rate::hz_2000: return 500000;
        case Rate::hz_1000: return 1000000;
        case Rate::hz_500: return 2000000;
        case Rate::hz_200: return 5000000;
        case Rate::hz_100: return 10000000;
        case Rate::hz_50: return 20000000;
        case Rate::hz_25: return 40000000;
        case Rate::hz_12_5: break;
    }
    return 80000000;
}

/// The code is also the exponent: full scale = 2000 deg/s / 2^code.
enum class GyroRange : std::uint8_t {
    dps_2000,
    dps_1000,
    dps_500,
    dps_250,
    dps_125,
    dps_62_5,
    dps_31_25,
    dps_15_625,
};
constexpr float rad_s_per_count(GyroRange r) noexcept {
    return 2000.0f / static_cast<float>(1 << static_cast<int>(r)) / 32768.0f * rad_per_deg;
}
/// Full scale = 16 g / 2^code.
enum class AccelRange : std::uint8_t { g_16, g_8, g_4, g_2 };
constexpr float m_s2_per_count(AccelRange r) noexcept {
    return 16.0f / static_cast<float>(1 << static_cast<int>(r)) / 32768.0f * standard_gravity_m_s2;
}

struct Config {
    Rate rate{Rate::hz_500};
    GyroRange gyro{GyroRange::dps_2000};
    AccelRange accel{AccelRange::g_16};
    std::uint8_t bandwidth{1};  // code of UI_FILT_BW: 0 is rate/2, 1 max(400 Hz, rate)/4, up to 7
    std::uint8_t watermark{0};  // samples per FIFO interrupt, at most 64; 0: data-ready, no FIFO
};

inline constexpr Part parts[] = {{0x47, "ICM-42688-P"}, {0x42, "ICM-42605"}, {0x6F, "IIM-42652"}};

enum Reg : std::uint8_t {
    device_config = 0x11,
    int_config = 0x14,
    fifo_config = 0x16,
    temp_data1 = 0x1D,
    int_status = 0x2D,
    fifo_data = 0x30,
    signal_path_reset = 0x4B,
    intf_config0 = 0x4C,
    intf_config1 = 0x4D,
    pwr_mgmt0 = 0x4E,
    gyro_config0 = 0x4F,
    accel_config0 = 0x50,
    gyro_accel_config0 = 0x52,
    tmst_config = 0x54,
    fifo_config1 = 0x5F,
    fifo_config2 = 0x60,
    fifo_config3 = 0x61,
    int_config1 = 0x64,
    int_source0 = 0x65,
    self_test_config = 0x70,
    who_am_i = 0x75,
    bank_select = 0x76,
    bank1_gyro_st = 0x5F,   // x, y, z
    bank2_accel_st = 0x3B,  // x, y, z
};

/// The factory's self-test response in counts at 250 deg/s or 2 g: 2620 * 1.01^(code - 1).
constexpr float factory_response(std::uint8_t code) noexcept {
    float v = 2620.0f;
    for (int i = 1; i < code; ++i) v *= 1.01f;
    return v;
}

}  // namespace icm426xx

template <class Bus>
class Icm426xx : public ImuDriver<Bus, 15> {
    using Base = ImuDriver<Bus, 15>;
    using Base::chip_, Base::unknown_, Base::settings_, Base::scale_, Base::line_;
    using Base::temperature_c_, Base::settle, Base::settle_for;

  public:
    using Config = icm426xx::Config;
    static constexpr std::uint8_t default_address = 0x68;

    explicit Icm426xx(Bus& bus, std::uint8_t address = default_address,
                      UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    Probe probe() const noexcept {
        return probe_for(chip_, icm426xx::who_am_i, icm426xx::parts, unknown_);
    }

    /// Reset, identity, settings, each read back; then sensors on. Valid data follow after 60 ms,
    /// and until then samples carry flag::settling.
    Status start(const Config& config) noexcept {
        using namespace icm426xx;
        if (config.watermark > Batch::capacity || config.bandwidth > 7) return Status::bad_argument;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        const bool fifo = config.watermark > 0;
        settings_.clear();
        settings_.add(intf_config0, 0x70);  // big endian, FIFO counted in records
        settings_.add(intf_config1, 0x40, 0xC0);
        settings_.add(int_config, 0x03, 0x07);  // INT1 pulsed, push-pull, active high
        settings_.add(gyro_config0, sensor_code(static_cast<std::uint8_t>(config.gyro)));
        settings_.add(accel_config0, sensor_code(static_cast<std::uint8_t>(config.accel)));
        settings_.add(gyro_accel_config0,
                      static_cast<std::uint8_t>(config.bandwidth << 4 | config.bandwidth));
        settings_.add(tmst_config, 0x21);  // time stamps on, frame sync off, 1 us
        settings_.add(fifo_config1, fifo ? 0x0F : 0x00);
        settings_.add(fifo_config2, config.watermark);
        settings_.add(fifo_config3, 0);
        settings_.add(fifo_config, fifo ? 0x40 : 0x00);
        settings_.add(int_config1, 0x00, 0x10);
        settings_.add(int_source0, fifo ? 0x04 : 0x08);
        settings_.add(pwr_mgmt0, 0x0F);
        // the reserved bits of this one must survive, so it is read first
        const auto interface = chip_.read(intf_config1);
        if (!interface) return interface.status();
        const auto no_afsr = static_cast<std::uint8_t>((*interface & 0x3F) | 0x40);
        if (const Status s = chip_.write(intf_config1, no_afsr); s != Status::ok) return s;
        if (const Status s = write_settings(no_afsr); s != Status::ok) return s;
        chip_.bus().pause_us(200);  // no write so soon after power-on
        scale_ = {rad_s_per_count(config.gyro), m_s2_per_count(config.accel)};
        line_.configure(1000000, icm426xx::period_ns(config.rate), 16);
        settle_for(60000000);
        return chip_.write(signal_path_reset, 0x02);  // begin with an empty FIFO
    }

    /// Reading clears the bit.
    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(icm426xx::int_status);
        if (!status) return status.status();
        return (*status & 0x08) != 0;
    }

    /// One transaction: the newest sample, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t b[14] = {};
        const Status s = chip_.read(icm426xx::temp_data1, b, sizeof b);
        if (s != Status::ok) return s;
        RawImu raw;
        raw.temperature = big_endian(b);
        raw.accel = triple<big_endian>(b + 2);
        raw.gyro = triple<big_endian>(b + 8);
        temperature_c_ = static_cast<float>(raw.temperature) / 132.48f + 25.0f;
        Sample sample = to_sample(raw, scale_, edge_ns, 0);
        mark(raw, sample);
        return sample;
    }

    /// Everything in the FIFO, up to a batch. edge_ns: when the watermark was reached, or no_edge.
    Status read_fifo(std::int64_t edge_ns, std::int64_t now_ns, Batch& batch) noexcept {
        using namespace icm426xx;
        batch.clear();
        std::uint8_t status[3] = {};
        Status s = chip_.read(int_status, status, sizeof status);
        if (s != Status::ok) return s;
        const auto records = static_cast<std::uint16_t>(big_endian(status + 1));
        if ((status[0] & 0x02) != 0) {  // full: the oldest are gone
            batch.state = FifoState::overrun;
            edge_ns = no_edge;
            // the chip's 16-bit time tells how many, unless it may have wrapped since the last look
            if (now_ns - last_fifo_ns_ > 60000000) line_.restart();
        }
        last_fifo_ns_ = now_ns;
        const std::size_t count = records < Batch::capacity ? records : Batch::capacity;
        batch.more = records > count;
        s = read_packets(chip_, fifo_data, 16, count, [&](const std::uint8_t* p) {
            if ((p[0] & 0xF0) != 0x60) return false;  // accel and gyro, 16 bits, a real packet
            RawImu raw;
            raw.accel = triple<big_endian>(p + 1);
            raw.gyro = triple<big_endian>(p + 7);
            temperature_c_ = static_cast<float>(static_cast<std::int8_t>(p[13])) / 2.07f + 25.0f;
            raw.tick = static_cast<std::uint16_t>(big_endian(p + 14));
            Sample& sample = batch.samples[batch.count++];
            sample = to_sample(raw, scale_, line_.unwrap(raw.tick), 0);
            mark(raw, sample);
            return true;
        });
        // a full FIFO's newest sample is this much younger than the batch's last
        const std::int64_t left = static_cast<std::int64_t>(records - count) * line_.period_ns();
        stamp(batch, line_, config_.watermark - 1u, edge_ns, now_ns - left);
        if (s != Status::bad_data) return s;
        batch.state = FifoState::resync;
        line_.restart();
        return chip_.write(signal_path_reset, 0x02);
    }

    /// Response over the factory's, per axis; passes from 0.5 up (gyro) and 0.5 to 1.5 (accel).
    /// Leaves the chip reset: start() again. At most 0.7 s.
    Status self_test(SelfTest& result) noexcept {
        using namespace icm426xx;
        result = {};
        Config test;
        test.rate = Rate::hz_1000;
        test.gyro = GyroRange::dps_250;
        test.accel = AccelRange::g_2;
        if (const Status s = start(test); s != Status::ok) return s;
        std::uint8_t codes[6] = {};
        if (const Status s = read_banked(1, bank1_gyro_st, codes); s != Status::ok) return s;
        if (const Status s = read_banked(2, bank2_accel_st, codes + 3); s != Status::ok) return s;
        std::array<float, 6> off{}, on{};
        if (const Status s = average(off); s != Status::ok) return s;
        if (const Status s = chip_.set(self_test_config, 0x7F); s != Status::ok) return s;
        if (const Status s = average(on); s != Status::ok) return s;
        result.passed = true;
        for (std::size_t i = 0; i < 6; ++i) {
            const float change = on[i] - off[i];
            result.response[i] = (change < 0 ? -change : change) / factory_response(codes[i]);
            const bool accel = i >= 3;
            if (result.response[i] < 0.5f || (accel && result.response[i] > 1.5f))
                result.passed = false;
        }
        return reset();
    }

    std::size_t watermark() const noexcept { return config_.watermark; }
    std::size_t samples_per_edge() const noexcept {
        return config_.watermark > 0 ? config_.watermark : 1;
    }

  private:
    std::uint8_t sensor_code(std::uint8_t range) const noexcept {
        return static_cast<std::uint8_t>(range << 5 | static_cast<std::uint8_t>(config_.rate));
    }

    Status reset() noexcept {
        using namespace icm426xx;
        if (const Status s = chip_.write(bank_select, 0); s != Status::ok) return s;
        if (const Status s = chip_.write(device_config, 0x01); s != Status::ok) return s;
        chip_.bus().pause_us(1000);
        const Status s = chip_.await(int_status, 0x10, 0x10, 10, 1000);  // RESET_DONE
        return s == Status::ok ? probe().status : s;
    }

    Status write_settings(std::uint8_t interface_config1) noexcept {
        Settings<15> exact = settings_;  // the register with reserved bits is already right
        exact.replace(icm426xx::intf_config1, interface_config1);
        return exact.write(chip_);
    }

    Status read_banked(std::uint8_t bank, std::uint8_t reg, std::uint8_t* three) const noexcept {
        if (const Status s = chip_.write(icm426xx::bank_select, bank); s != Status::ok) return s;
        const Status s = chip_.read(reg, three, 3);
        const Status back = chip_.write(icm426xx::bank_select, 0);
        return s != Status::ok ? s : back;
    }

    Status average(std::array<float, 6>& mean) const noexcept {
        return Base::template average<14>(icm426xx::temp_data1, 8, 2, 100000, mean);
    }

    /// -32768 in all three axes: the chip says that it has no data yet.
    void mark(const RawImu& raw, Sample& sample) noexcept {
        const auto none = [](const std::array<std::int16_t, 3>& v) {
            return v[0] == INT16_MIN && v[1] == INT16_MIN && v[2] == INT16_MIN;
        };
        if (none(raw.gyro)) sample.flags &= ~(flag::gyro_valid | flag::gyro_clipped);
        if (none(raw.accel)) sample.flags &= ~(flag::accel_valid | flag::accel_clipped);
        if ((sample.flags & (flag::gyro_clipped | flag::accel_clipped)) == 0)
            sample.flags &= ~flag::clipped;
        sample.flags |= settle();
    }

    Config config_{};
    std::int64_t last_fifo_ns_{0};
};

}  // namespace fairlead::port
