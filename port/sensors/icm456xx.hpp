#pragma once
// TDK InvenSense ICM-45686 and its relatives ICM-45605, ICM-45608, ICM-45689: the successors of
// the ICM-426xx, with other registers: no banks, little-endian data, indirect access to what is
// rare.
//
// read() is one burst of 14 bytes; with a watermark the 8 KiB FIFO delivers packets of 16 bytes,
// each with the chip's own 16-bit time in microseconds. Source: data sheet DS-000577; registers,
// packet and times beside Linux's inv_icm45600. The self test needs a program in the chip's own
// memory (application note AN-000478) and is not offered. start(): at most 40 transactions and 12
// ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"

namespace fairlead::port {

namespace icm456xx {

/// 6400 Hz / 2^(code - 3).
enum class Rate : std::uint8_t {
    hz_6400 = 3,
    hz_3200,
    hz_1600,
    hz_800,
    hz_400,
    hz_200,
    hz_100,
    hz_50,
    hz_25,
    hz_12_5,
};
constexpr std::int64_t period_ns(Rate r) noexcept { return 156250LL << (static_cast<int>(r) - 3); }

/// Full scale = 4000 deg/s / 2^code; the ICM-45605's code is one less and starts at 2000.
enum class GyroRange : std::uint8_t {
    dps_4000,
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
    return 4000.0f / static_cast<float>(1 << static_cast<int>(r)) / 32768.0f * rad_per_deg;
}
/// Full scale = 32 g / 2^code; the ICM-45605's code is one less and starts at 16 g.
enum class AccelRange : std::uint8_t { g_32, g_16, g_8, g_4, g_2 };
constexpr float m_s2_per_count(AccelRange r) noexcept {
    return 32.0f / static_cast<float>(1 << static_cast<int>(r)) / 32768.0f * standard_gravity_m_s2;
}

struct Config {
    Rate rate{Rate::hz_400};
    GyroRange gyro{GyroRange::dps_2000};
    AccelRange accel{AccelRange::g_16};
    std::uint8_t watermark{0};  // samples per FIFO interrupt, at most 64; 0: data-ready, no FIFO
};

struct Part {
    std::uint8_t id;
    const char* name;
    std::uint8_t first;  // what its codes of ranges are less than those above
};
inline constexpr Part parts[] = {{0xE9, "ICM-45686", 0},
                                 {0xE5, "ICM-45605", 1},
                                 {0x81, "ICM-45608", 1},
                                 {0x83, "ICM-45689", 0},
                                 {0xE7, "ICM-45688-P", 0}};

enum Reg : std::uint8_t {
    accel_data = 0x00,
    temp_data = 0x0C,
    pwr_mgmt0 = 0x10,
    fifo_count = 0x12,
    fifo_data = 0x14,
    int1_config0 = 0x16,
    int1_config2 = 0x18,
    int1_status0 = 0x19,
    accel_config0 = 0x1B,
    gyro_config0 = 0x1C,
    fifo_config0 = 0x1D,
    fifo_watermark = 0x1E,  // low, then high
    fifo_config2 = 0x20,
    fifo_config3 = 0x21,
    fifo_config4 = 0x22,
    who_am_i = 0x72,
    ireg_addr = 0x7C,  // high, low, then data
    ireg_data = 0x7E,
    reg_misc2 = 0x7F,
};
inline constexpr std::uint16_t smc_control_0 = 0xA258;  // bit 0: time stamps on

}  // namespace icm456xx

template <class Bus>
class Icm456xx : public ImuDriver<Bus, 12> {
    using Base = ImuDriver<Bus, 12>;
    using Base::chip_, Base::unknown_, Base::settings_, Base::scale_, Base::line_;
    using Base::temperature_c_, Base::settle, Base::settle_for;

  public:
    using Config = icm456xx::Config;
    static constexpr std::uint8_t default_address = 0x68;

    explicit Icm456xx(Bus& bus, std::uint8_t address = default_address,
                      UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    Probe probe() const noexcept {
        return probe_for(chip_, icm456xx::who_am_i, icm456xx::parts, unknown_);
    }

    /// Reset, identity, settings, each read back; then sensors on. Valid data follow after 60 ms,
    /// and until then samples carry flag::settling. bad_argument: a range that the part lacks.
    Status start(const Config& config) noexcept {
        using namespace icm456xx;
        if (config.watermark > Batch::capacity) return Status::bad_argument;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        const auto gyro = static_cast<std::uint8_t>(config.gyro);
        const auto accel = static_cast<std::uint8_t>(config.accel);
        if (gyro < first_ || accel < first_) return Status::bad_argument;
        if (const Status s = time_stamps_on(); s != Status::ok) return s;
        const bool fifo = config.watermark > 0;
        const auto rate = static_cast<std::uint8_t>(config.rate);
        settings_.clear();
        settings_.add(int1_config2, 0x05, 0x07);  // push-pull, pulsed, active high
        settings_.add(gyro_config0, static_cast<std::uint8_t>((gyro - first_) << 4 | rate));
        settings_.add(accel_config0, static_cast<std::uint8_t>((accel - first_) << 4 | rate));
        settings_.add(fifo_watermark, config.watermark);
        settings_.add(fifo_watermark + 1, 0);
        settings_.add(fifo_config2, 0x08, 0x08);  // the interrupt stands while the level is high
        settings_.add(fifo_config4, 0x02);        // a time stamp in each packet
        settings_.add(fifo_config0, fifo ? 0x5F : 0x1F);  // stream, all of the memory
        settings_.add(fifo_config3, fifo ? 0x07 : 0x00);  // both sensors, 16 bits
        settings_.add(int1_config0, fifo ? 0x02 : 0x04);
        settings_.add(pwr_mgmt0, 0x0F);
        if (const Status s = settings_.write(chip_); s != Status::ok) return s;
        scale_ = {rad_s_per_count(config.gyro), m_s2_per_count(config.accel)};
        line_.configure(1000000, icm456xx::period_ns(config.rate), 16);
        settle_for(60000000);
        return flush();
    }

    /// Reading clears the bit.
    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(icm456xx::int1_status0);
        if (!status) return status.status();
        return (*status & 0x04) != 0;
    }

    /// One transaction: the newest sample, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t b[14] = {};
        const Status s = chip_.read(icm456xx::accel_data, b, sizeof b);
        if (s != Status::ok) return s;
        temperature_c_ = static_cast<float>(little_endian(b + 12)) / 128.0f + 25.0f;
        return marked(b, edge_ns);
    }

    /// Everything in the FIFO, up to a batch. edge_ns: when the watermark was reached, or no_edge.
    Status read_fifo(std::int64_t edge_ns, std::int64_t now_ns, Batch& batch) noexcept {
        using namespace icm456xx;
        batch.clear();
        std::uint8_t status = 0, level[2] = {};
        const std::uint8_t status_reg = int1_status0, level_reg = fifo_count;
        const Transfer both[2] = {{chip_.address(), &status_reg, 1, &status, 1},
                                  {chip_.address(), &level_reg, 1, level, 2}};
        Status s = chip_.bus().transfer(both, 2);
        if (s != Status::ok) return s;
        const auto records = static_cast<std::uint16_t>(little_endian(level));
        if ((status & 0x01) != 0) {  // full: the oldest are gone
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
            temperature_c_ = static_cast<float>(static_cast<std::int8_t>(p[13])) / 2.0f + 25.0f;
            const auto tick = static_cast<std::uint16_t>(little_endian(p + 14));
            batch.samples[batch.count++] = marked(p + 1, line_.unwrap(tick));
            return true;
        });
        const std::int64_t left = static_cast<std::int64_t>(records - count) * line_.period_ns();
        stamp(batch, line_, config_.watermark - 1u, edge_ns, now_ns - left);
        if (s != Status::bad_data) return s;
        batch.state = FifoState::resync;
        line_.restart();
        return flush();
    }

    /// not_supported: see above.
    Status self_test(SelfTest& result) noexcept {
        result = {};
        return Status::not_supported;
    }

    std::size_t watermark() const noexcept { return config_.watermark; }
    std::size_t samples_per_edge() const noexcept {
        return config_.watermark > 0 ? config_.watermark : 1;
    }

  private:
    Status reset() noexcept {
        using namespace icm456xx;
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(reg_misc2, 0x02); s != Status::ok) return s;
        chip_.bus().pause_us(1000);
        if (const Status s = chip_.await(int1_status0, 0x80, 0x80, 10, 1000); s != Status::ok)
            return s;
        const Probe p = probe();
        first_ = 0;
        for (const auto& part : parts)
            if (part.id == p.got) first_ = part.first;
        return p.status;
    }

    Status flush() noexcept {
        const auto kept = static_cast<std::uint8_t>(0x80 | 0x08);
        return chip_.write(icm456xx::fifo_config2, kept);
    }

    /// Indirect registers: address, 4 us, data. What the register held is kept.
    Status time_stamps_on() noexcept {
        using namespace icm456xx;
        constexpr auto high = static_cast<std::uint8_t>(smc_control_0 >> 8);
        constexpr auto low = static_cast<std::uint8_t>(smc_control_0 & 0xFF);
        const std::uint8_t where[3] = {ireg_addr, high, low};
        const Transfer address{chip_.address(), where, sizeof where, nullptr, 0};
        if (const Status s = chip_.bus().transfer(&address, 1); s != Status::ok) return s;
        chip_.bus().pause_us(4);
        const auto value = chip_.read(ireg_data);
        if (!value) return value.status();
        chip_.bus().pause_us(4);
        const std::uint8_t what[4] = {ireg_addr, high, low,
                                      static_cast<std::uint8_t>(*value | 0x01)};
        const Transfer write{chip_.address(), what, sizeof what, nullptr, 0};
        const Status s = chip_.bus().transfer(&write, 1);
        chip_.bus().pause_us(4);
        return s;
    }

    /// Accelerometer, then gyroscope. -32768 in all three axes: the chip has no data yet.
    Sample marked(const std::uint8_t* b, std::int64_t t_ns) noexcept {
        const auto none = [](const std::array<std::int16_t, 3>& v) {
            return v[0] == INT16_MIN && v[1] == INT16_MIN && v[2] == INT16_MIN;
        };
        RawImu raw;
        raw.accel = triple<little_endian>(b);
        raw.gyro = triple<little_endian>(b + 6);
        Sample sample = to_sample(raw, scale_, t_ns, settle());
        if (none(raw.gyro)) sample.flags &= ~(flag::gyro_valid | flag::gyro_clipped);
        if (none(raw.accel)) sample.flags &= ~(flag::accel_valid | flag::accel_clipped);
        if ((sample.flags & (flag::gyro_clipped | flag::accel_clipped)) == 0)
            sample.flags &= ~flag::clipped;
        return sample;
    }

    Config config_{};
    std::uint8_t first_{0};
    std::int64_t last_fifo_ns_{0};
};

}  // namespace fairlead::port
