#pragma once
// ST LSM6DSO / LSM6DSOX and LSM6DSV / LSM6DSV16X: one driver, two register tables.
//
// read() is one burst of 14 bytes; with a watermark the FIFO delivers words of 7 bytes, three a
// sample: the chip's time (25 or 21.7 us), gyroscope, accelerometer. The tables hold what differs:
// the place and the width of the FIFO count (10 bits against 9), codes of rates and ranges, the
// oscillator's trim register.
// Source: data sheets DS12140 (DSO), DS13510 (DSV16X), AN5192, AN5763. start(): at most 45
// transactions, and pauses of at most 12 ms.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"

namespace fairlead::port {

namespace lsm6 {

enum Reg : std::uint8_t {  // common to both families
    fifo_ctrl1 = 0x07,
    fifo_ctrl2 = 0x08,
    fifo_ctrl3 = 0x09,
    fifo_ctrl4 = 0x0A,
    int1_ctrl = 0x0D,
    who_am_i = 0x0F,
    ctrl1 = 0x10,
    ctrl2 = 0x11,
    ctrl3 = 0x12,
    ctrl4 = 0x13,
    status = 0x1E,
    out_temp = 0x20,
    fifo_data = 0x78,
};

/// True values: 6667 Hz / 2^n, although the data sheet prints 12.5, 26, 52 ...
struct Dso {
    enum class Rate : std::uint8_t {
        hz_12_5 = 1,
        hz_26,
        hz_52,
        hz_104,
        hz_208,
        hz_417,
        hz_833,
        hz_1667,
        hz_3333,
        hz_6667,
    };
    enum class GyroRange : std::uint8_t {
        dps_125 = 1,
        dps_250 = 0,
        dps_500 = 2,
        dps_1000 = 4,
        dps_2000 = 6,
    };
    enum class AccelRange : std::uint8_t { g_2 = 0, g_4 = 2, g_8 = 3, g_16 = 1 };

    static constexpr Part parts[] = {{0x6C, "LSM6DSO"}};
    static constexpr std::uint8_t self_test = 0x14, fifo_status = 0x3A, freq_fine = 0x63;
    static constexpr std::uint8_t count_mask = 0x03;  // of the FIFO status' high byte
    static constexpr std::int64_t tick_ps = 25000000;
    static constexpr std::int64_t freq_step_ppm = 1500;
    static constexpr std::int64_t period_ns(Rate r) noexcept {
        return (1000000000LL << (10 - static_cast<int>(r))) / 6667;
    }
    static constexpr int dps_range(GyroRange r) noexcept {
        return r == GyroRange::dps_125 ? 125 : 250 << (static_cast<int>(r) / 2);
    }
    static constexpr int g_range(AccelRange r) noexcept {
        return r == AccelRange::g_16 ? 16 : r == AccelRange::g_8 ? 8 : r == AccelRange::g_4 ? 4 : 2;
    }
    /// Ranges, rates, time stamps; the last of them switch the sensors on.
    template <class Config, class S>
    static void add_settings(const Config& c, S& settings) noexcept {
        const auto rate = static_cast<std::uint8_t>(static_cast<int>(c.rate) << 4);
        settings.add(0x18, 0xE2);        // CTRL9_XL: I3C off
        settings.add(0x0B, 0x80, 0x80);  // COUNTER_BDR_REG1: data-ready as a pulse
        settings.add(0x19, 0x20);        // CTRL10_C: time stamps on
        settings.add(ctrl1, static_cast<std::uint8_t>(rate | static_cast<int>(c.accel) << 2));
        settings.add(ctrl2, static_cast<std::uint8_t>(rate | static_cast<int>(c.gyro) << 1));
    }
};

struct Dsv {
    enum class Rate : std::uint8_t {
        hz_7_5 = 2,
        hz_15,
        hz_30,
        hz_60,
        hz_120,
        hz_240,
        hz_480,
        hz_960,
        hz_1920,
        hz_3840,
        hz_7680,
    };
    enum class GyroRange : std::uint8_t {
        dps_125 = 0,
        dps_250,
        dps_500,
        dps_1000,
        dps_2000,
        dps_4000 = 12,
    };
    enum class AccelRange : std::uint8_t { g_2, g_4, g_8, g_16 };

    static constexpr Part parts[] = {{0x70, "LSM6DSV"}};
    static constexpr std::uint8_t self_test = 0x19, fifo_status = 0x1B, freq_fine = 0x4F;
    static constexpr std::uint8_t count_mask = 0x01;
    static constexpr std::int64_t tick_ps = 21701389;
    static constexpr std::int64_t freq_step_ppm = 1300;
    static constexpr std::int64_t period_ns(Rate r) noexcept {
        return (1000000000LL << (12 - static_cast<int>(r))) / 7680;
    }
    static constexpr int dps_range(GyroRange r) noexcept {
        return r == GyroRange::dps_4000 ? 4000 : 125 << static_cast<int>(r);
    }
    static constexpr int g_range(AccelRange r) noexcept { return 2 << static_cast<int>(r); }
    template <class Config, class S>
    static void add_settings(const Config& c, S& settings) noexcept {
        settings.add(ctrl4, 0x02, 0x02);                         // data-ready as a pulse
        settings.add(0x50, 0x40, 0x40);                          // FUNCTIONS_ENABLE: time stamps on
        settings.add(0x15, static_cast<std::uint8_t>(c.gyro));   // CTRL6
        settings.add(0x17, static_cast<std::uint8_t>(c.accel));  // CTRL8
        settings.add(ctrl1, static_cast<std::uint8_t>(c.rate));  // high-performance mode
        settings.add(ctrl2, static_cast<std::uint8_t>(c.rate));
    }
};

}  // namespace lsm6

template <class Bus, class Family>
class Lsm6 : public ImuDriver<Bus, 12> {
    using Base = ImuDriver<Bus, 12>;
    using Base::chip_, Base::unknown_, Base::settings_, Base::scale_, Base::line_;
    using Base::temperature_c_, Base::settle, Base::settle_for;

  public:
    using Rate = typename Family::Rate;
    using GyroRange = typename Family::GyroRange;
    using AccelRange = typename Family::AccelRange;
    static constexpr std::uint8_t default_address = 0x6A;

    struct Config {
        Rate rate{static_cast<Rate>(Family::count_mask == 3 ? 6 : 8)};  // 417 or 480 Hz
        GyroRange gyro{GyroRange::dps_2000};
        AccelRange accel{AccelRange::g_16};
        std::uint8_t watermark{
            0};  // samples per FIFO interrupt, at most 64; 0: data-ready, no FIFO
    };

    explicit Lsm6(Bus& bus, std::uint8_t address = default_address,
                  UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    /// 4.375 mdeg/s at 125 deg/s, in proportion above.
    static constexpr float rad_s_per_count(GyroRange r) noexcept {
        return static_cast<float>(Family::dps_range(r)) * 0.035e-3f * rad_per_deg;
    }
    /// 0.061 mg at 2 g, in proportion above.
    static constexpr float m_s2_per_count(AccelRange r) noexcept {
        return static_cast<float>(Family::g_range(r)) * 0.0305e-3f * standard_gravity_m_s2;
    }

    Probe probe() const noexcept {
        return probe_for(chip_, lsm6::who_am_i, Family::parts, unknown_);
    }

    /// Reset, identity, settings, each read back. Until the gyroscope has started, 70 ms, samples
    /// carry flag::settling.
    Status start(const Config& config) noexcept {
        using namespace lsm6;
        if (config.watermark > Batch::capacity) return Status::bad_argument;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        const auto trim = chip_.read(Family::freq_fine);
        if (!trim) return trim.status();
        const bool fifo = config.watermark > 0;
        const int words = 3 * config.watermark;
        const auto rate = static_cast<std::uint8_t>(config.rate);
        settings_.clear();
        settings_.add(ctrl3, 0x44);  // block data update, address increment
        settings_.add(fifo_ctrl1, static_cast<std::uint8_t>(words & 0xFF));
        settings_.add(fifo_ctrl3, fifo ? static_cast<std::uint8_t>(rate << 4 | rate) : 0);
        settings_.add(fifo_ctrl4, fifo ? 0x46 : 0x00);  // continuous, a time stamp with each sample
        settings_.add(int1_ctrl, fifo ? 0x08 : 0x02);   // FIFO threshold, or gyro data-ready
        Family::add_settings(config, settings_);
        if (const Status s = settings_.write(chip_); s != Status::ok) return s;
        scale_ = {rad_s_per_count(config.gyro), m_s2_per_count(config.accel)};
        const std::int64_t ppm = static_cast<std::int8_t>(*trim) * Family::freq_step_ppm;
        line_.configure(Family::tick_ps * 1000000 / (1000000 + ppm),
                        Family::period_ns(config.rate) * 1000000 / (1000000 + ppm), 32);
        settle_for(70000000);
        have_ = 0;
        return Status::ok;
    }

    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(lsm6::status);
        if (!status) return status.status();
        return (*status & 0x03) == 0x03;
    }

    /// One transaction: the newest sample, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t b[14] = {};
        const Status s = chip_.read(lsm6::out_temp, b, sizeof b);
        if (s != Status::ok) return s;
        RawImu raw;
        raw.gyro = triple<little_endian>(b + 2);
        raw.accel = triple<little_endian>(b + 8);
        temperature_c_ = static_cast<float>(little_endian(b)) / 256.0f + 25.0f;
        return to_sample(raw, scale_, edge_ns, settle());
    }

    /// Everything in the FIFO, up to a batch. edge_ns: when the watermark was reached, or no_edge.
    Status read_fifo(std::int64_t edge_ns, std::int64_t now_ns, Batch& batch) noexcept {
        batch.clear();
        std::uint8_t status[2] = {};
        Status s = chip_.read(Family::fifo_status, status, sizeof status);
        if (s != Status::ok) return s;
        const unsigned words = status[0] | static_cast<unsigned>(status[1] & Family::count_mask)
                                               << 8;
        if ((status[1] & 0x48) != 0) {  // now, or latched since the last look
            batch.state = FifoState::overrun;
            edge_ns = no_edge;
        }
        // every word, whole samples or not: what an overrun has left of one must go, too
        const unsigned count = words < 3 * Batch::capacity ? words : 3 * Batch::capacity;
        batch.more = words > count;
        s = read_packets(chip_, lsm6::fifo_data, 7, count,
                         [&](const std::uint8_t* w) { return take(w, batch); });
        stamp(batch, line_, config_.watermark - 1u, edge_ns, now_ns);
        if (s != Status::bad_data) return s;
        batch.state = FifoState::resync;
        have_ = 0;
        if (const Status r = chip_.write(lsm6::fifo_ctrl4, 0x00); r != Status::ok) return r;
        return chip_.write(lsm6::fifo_ctrl4, 0x46);  // bypass and back empties it
    }

    /// Response in rad/s and m/s^2; passes at 150 to 700 deg/s and 50 to 1700 mg on every axis.
    /// Leaves the chip reset: start() again. At most 0.6 s.
    Status self_test(SelfTest& result) noexcept {
        result = {};
        Config test;
        test.rate = static_cast<Rate>(Family::count_mask == 3 ? 5 : 7);  // 208 or 240 Hz
        test.accel = AccelRange::g_4;
        if (const Status s = start(test); s != Status::ok) return s;
        std::array<float, 6> off{}, on{};
        if (const Status s = average(off); s != Status::ok) return s;
        if (const Status s = chip_.set(Family::self_test, 0x05); s != Status::ok) return s;
        if (const Status s = average(on); s != Status::ok) return s;
        result.passed = true;
        for (std::size_t i = 0; i < 6; ++i) {
            const float change = on[i] - off[i];
            const float response = change < 0 ? -change : change;
            const float unit = i < 3 ? rad_per_deg : standard_gravity_m_s2;
            const float low = (i < 3 ? 150.0f : 0.05f) * unit;
            const float high = (i < 3 ? 700.0f : 1.7f) * unit;
            result.response[i] = response;
            if (response < low || response > high) result.passed = false;
        }
        return reset();
    }

    std::size_t watermark() const noexcept { return config_.watermark; }
    std::size_t samples_per_edge() const noexcept {
        return config_.watermark > 0 ? config_.watermark : 1;
    }

  private:
    enum Have : std::uint8_t { have_gyro = 1, have_accel = 2, have_time = 4, have_all = 7 };

    /// INT1 is let go before: asserted during a reset, it makes the chip speak I3C only.
    Status reset() noexcept {
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(lsm6::int1_ctrl, 0x00); s != Status::ok) return s;
        if (const Status s = chip_.write(lsm6::fifo_ctrl4, 0x00); s != Status::ok) return s;
        if (const Status s = chip_.write(lsm6::ctrl3, 0x01); s != Status::ok) return s;
        return chip_.await(lsm6::ctrl3, 0x01, 0x00, 50, 200);
    }

    /// One word of the FIFO. The three words of a sample carry the same 2-bit counter.
    bool take(const std::uint8_t* w, Batch& batch) noexcept {
        const auto slot = static_cast<std::uint8_t>(w[0] >> 1 & 3);
        if (slot != slot_) have_ = 0;
        slot_ = slot;
        switch (w[0] >> 3) {
            case 1:
                raw_.gyro = triple<little_endian>(w + 1);
                have_ |= have_gyro;
                break;
            case 2:
                raw_.accel = triple<little_endian>(w + 1);
                have_ |= have_accel;
                break;
            case 4:
                raw_.tick = static_cast<std::uint16_t>(little_endian(w + 1)) |
                            static_cast<std::uint32_t>(little_endian(w + 3)) << 16;
                have_ |= have_time;
                break;
            default: return false;
        }
        if (have_ != have_all) return true;
        have_ = 0;
        if (batch.count == Batch::capacity) return true;
        batch.samples[batch.count++] = to_sample(raw_, scale_, line_.unwrap(raw_.tick), settle());
        return true;
    }

    /// Mean of 5 samples after 100 ms, as the application note asks; rad/s and m/s^2.
    Status average(std::array<float, 6>& mean) noexcept {
        chip_.bus().pause_us(100000);
        mean = {};
        for (int n = 0; n < 5; ++n) {
            chip_.bus().pause_us(5000);
            const auto sample = read(0);
            if (!sample) return sample.status();
            const Vec3& g = sample->gyro_rad_s;
            const Vec3& a = sample->accel_m_s2;
            const float values[6] = {g.x, g.y, g.z, a.x, a.y, a.z};
            for (std::size_t i = 0; i < 6; ++i) mean[i] += 0.2f * values[i];
        }
        return Status::ok;
    }

    Config config_{};
    RawImu raw_{};
    std::uint8_t slot_{0};
    std::uint8_t have_{0};
};

template <class Bus>
using Lsm6dso = Lsm6<Bus, lsm6::Dso>;
template <class Bus>
using Lsm6dsv = Lsm6<Bus, lsm6::Dsv>;

}  // namespace fairlead::port
