#pragma once
// Bosch BMI088: a gyroscope and an accelerometer in one package, each with its own address, clock,
// FIFO and reset.
//
// The gyroscope leads: its data-ready or watermark line (INT3) gives the edges, its sample count is
// the clock, and every sample that leaves here is a sample of the gyroscope. The accelerometer runs
// at least 1.6 times as fast (2000 Hz: 0.8), filtered below half the gyroscope's rate, and gives
// each of them the reading that is nearest in time: in read() the newest one, at most one of its
// periods old; in read_fifo() the one that is found by age, counted back from the newest of both
// FIFOs, at most one of its periods away (and as much more as the two clocks differ over the time
// that the sample waited in the FIFO; half a sample period more where no edge tells how old the
// newest is). A sample without such a reading lacks flag::accel_valid; only the first ones after a
// start can.
//
// Over SPI the halves have a chip select each: BusPair (spi.hpp) makes one bus of the two. The
// accelerometer listens to SPI after its first, useless read, which probe() and start() make.
// Source: data sheet BST-BMI088-DS001; registers and FIFO headers beside Bosch's own bmi08_defs.h.
// start(): at most 48 transactions and 90 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"
#include "port/sensors/spi.hpp"

namespace fairlead::port {

namespace bmi088 {

/// Codes of GYRO_BANDWIDTH; the widest filter below half the rate, 230 Hz at 2000 Hz.
enum class Rate : std::uint8_t { hz_2000 = 1, hz_1000 = 2, hz_400 = 3, hz_200 = 6, hz_100 = 7 };
constexpr std::int64_t period_ns(Rate r) noexcept {
    switch (r) {
        case Rate::hz_2000: return 500000;
        case Rate::hz_1000: return 1000000;
        case Rate::hz_400: return 2500000;
        case Rate::hz_200: return 5000000;
        case Rate::hz_100: return 10000000;
        default: return 0;
    }
}
/// The accelerometer beside it: 25 Hz * 2^(code - 6).
constexpr std::uint8_t accel_code(Rate r) noexcept {
    switch (r) {
        case Rate::hz_2000:
        case Rate::hz_1000: return 12;
        case Rate::hz_400: return 11;
        case Rate::hz_200: return 10;
        default: return 9;
    }
}
constexpr std::int64_t accel_period_ns(Rate r) noexcept { return 40000000 >> (accel_code(r) - 6); }

/// Full scale = 2000 deg/s / 2^code.
enum class GyroRange : std::uint8_t { dps_2000, dps_1000, dps_500, dps_250, dps_125 };
constexpr float rad_s_per_count(GyroRange r) noexcept {
    return 2000.0f / static_cast<float>(1 << static_cast<int>(r)) / 32768.0f * rad_per_deg;
}
/// Full scale = 3 g * 2^code.
enum class AccelRange : std::uint8_t { g_3, g_6, g_12, g_24 };
constexpr float m_s2_per_count(AccelRange r) noexcept {
    return static_cast<float>(3 << static_cast<int>(r)) / 32768.0f * standard_gravity_m_s2;
}

inline constexpr std::uint8_t chip_id = 0x00, soft_reset = 0xB6;
inline constexpr Part parts[] = {{0x0F, "BMI088"}};               // what the gyroscope answers
inline constexpr Part accel_parts[] = {{0x1E, "accelerometer"}};  // and the accelerometer

/// The two chip selects, for BusPair.
inline constexpr SpiStyle gyro_spi{10000000, 0, 0}, accel_spi{10000000, 1, 0};

enum GyroReg : std::uint8_t {
    rate_x = 0x02,
    gyro_fifo_status = 0x0E,
    gyro_range = 0x0F,
    gyro_bandwidth = 0x10,
    gyro_reset = 0x14,
    int_ctrl = 0x15,
    int_io_conf = 0x16,
    int_io_map = 0x18,
    fifo_wm_enable = 0x1E,
    gyro_self_test = 0x3C,
    gyro_watermark = 0x3D,  // writing it empties the FIFO and clears its overrun
    gyro_fifo_mode = 0x3E,
    gyro_fifo_data = 0x3F,
};
enum AccelReg : std::uint8_t {
    accel_status = 0x03,
    accel_x = 0x12,
    temperature = 0x22,
    accel_fifo_length = 0x24,
    accel_fifo_data = 0x26,
    accel_conf = 0x40,
    accel_range = 0x41,
    accel_fifo_mode = 0x48,
    accel_fifo_enable = 0x49,
    accel_self_test = 0x6D,
    power_conf = 0x7C,
    power_ctrl = 0x7D,
    accel_command = 0x7E,
};
inline constexpr std::uint8_t accel_fifo_flush = 0xB0;
inline constexpr std::size_t gyro_frame = 6, gyro_fifo_frames = 99;
inline constexpr std::size_t accel_frame = 7, accel_fifo_bytes = 1024;
/// The header of an acceleration frame, without the two bits of the interrupt pins.
inline constexpr std::uint8_t accel_header = 0x84, accel_header_mask = 0xFC;

}  // namespace bmi088

template <class Bus>
class Bmi088 : public ImuDriver<Bus, 8> {
    using Base = ImuDriver<Bus, 8>;
    using Base::chip_, Base::unknown_, Base::settings_, Base::scale_, Base::line_;
    using Base::temperature_c_, Base::settle, Base::settle_for;

  public:
    struct Config {
        bmi088::Rate rate{bmi088::Rate::hz_400};
        bmi088::GyroRange gyro{bmi088::GyroRange::dps_2000};
        bmi088::AccelRange accel{bmi088::AccelRange::g_24};
        std::uint8_t watermark{0};  // samples per FIFO interrupt, at most 64; 0: no FIFO
    };
    static constexpr std::uint8_t default_address = 0x68;

    /// `address`: the gyroscope's, 0x68 or 0x69. `accel_address`: 0x18 or 0x19; 0: strapped alike.
    explicit Bmi088(Bus& bus, std::uint8_t address = default_address,
                    UnknownId unknown = UnknownId::refuse, std::uint8_t accel_address = 0) noexcept
        : Base{bus, address, unknown},
          accel_{bus, accel_address != 0 ? accel_address
                                         : static_cast<std::uint8_t>(0x18 | (address & 1))} {}

    /// Both halves: the report is the gyroscope's, unless the accelerometer is what is wrong.
    Probe probe() const noexcept {
        using namespace bmi088;
        Probe p = probe_for(chip_, chip_id, parts, unknown_);
        if (p.status != Status::ok) return p;
        for (int i = 0; i < 2; ++i) {  // on SPI the first read is what wakes it
            const Probe accel = probe_for(accel_, chip_id, accel_parts, unknown_);
            if (accel.status == Status::ok) continue;
            const bool asleep = i == 0 && accel.status == Status::unexpected_id;
            if (!asleep) return accel;
        }
        return p;
    }

    /// Resets, identities, settings, each read back. For 30 ms after it samples carry
    /// flag::settling.
    Status start(const Config& config) noexcept {
        using namespace bmi088;
        if (config.watermark > Batch::capacity || bmi088::period_ns(config.rate) == 0)
            return Status::bad_argument;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        if (const Status s = accel_.write(power_conf, 0x00); s != Status::ok) return s;
        accel_.bus().pause_us(1000);
        if (const Status s = accel_.write(power_ctrl, 0x04); s != Status::ok) return s;
        accel_.bus().pause_us(50000);
        describe(config);
        if (const Status s = accel_settings_.write(accel_); s != Status::ok) return s;
        if (const Status s = settings_.write(chip_); s != Status::ok) return s;
        scale_ = {rad_s_per_count(config.gyro), m_s2_per_count(config.accel)};
        const std::int64_t period = bmi088::period_ns(config.rate);
        line_.configure(period * 1000, period, 32);
        settle_for(30000000);
        return config.watermark > 0 ? empty() : Status::ok;
    }

    /// Do the settings of both halves still stand?
    Status check() const noexcept {
        const Status s = Base::check();
        return s == Status::ok ? accel_settings_.check(accel_) : s;
    }

    /// Asked of the accelerometer, the faster of the two: the gyroscope's own bit falls by itself
    /// after 0.3 ms. True while nobody has read the newest acceleration.
    Result<bool> data_ready() const noexcept {
        const auto status = accel_.read(bmi088::accel_status);
        if (!status) return status.status();
        return (*status & 0x80) != 0;
    }

    /// One transaction: the newest sample of both, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t g[6] = {}, a[6] = {}, t[2] = {};
        const std::uint8_t from[3] = {bmi088::rate_x, bmi088::accel_x, bmi088::temperature};
        const Transfer all[3] = {{chip_.address(), &from[0], 1, g, sizeof g},
                                 {accel_.address(), &from[1], 1, a, sizeof a},
                                 {accel_.address(), &from[2], 1, t, sizeof t}};
        const Status s = chip_.bus().transfer(all, 3);
        if (s != Status::ok) return s;
        if (t[0] != 0x80) {  // 11 bits, an eighth of a degree each; 0x80: not measured yet
            const int high = t[0] < 0x80 ? t[0] : t[0] - 256;
            temperature_c_ = static_cast<float>(high * 8 + (t[1] >> 5)) * 0.125f + 23.0f;
        }
        RawImu raw;
        raw.gyro = triple<little_endian>(g);
        raw.accel = triple<little_endian>(a);
        return to_sample(raw, scale_, edge_ns, settle());
    }

    /// Everything in the FIFOs, up to a batch. edge_ns: when the watermark was reached, or no_edge.
    /// Where either FIFO ran over or could not be read to the end both are emptied, and what was
    /// taken out is counted as lost.
    Status read_fifo(std::int64_t edge_ns, std::int64_t now_ns, Batch& batch) noexcept {
        using namespace bmi088;
        batch.clear();
        std::uint8_t level = 0, size[2] = {};
        const std::uint8_t from[2] = {gyro_fifo_status, accel_fifo_length};
        const Transfer both[2] = {{chip_.address(), &from[0], 1, &level, 1},
                                  {accel_.address(), &from[1], 1, size, sizeof size}};
        Status s = chip_.bus().transfer(both, 2);
        if (s != Status::ok) return s;
        const std::size_t frames = level & 0x7F;
        const std::size_t bytes = static_cast<std::uint16_t>(little_endian(size)) & 0x3FFF;
        if ((level & 0x80) != 0 || frames > gyro_fifo_frames ||
            bytes + 2 * accel_frame > accel_fifo_bytes) {
            batch.state = FifoState::overrun;
            return empty();
        }
        batch.count = frames < Batch::capacity ? frames : Batch::capacity;
        batch.more = frames > batch.count;
        s = read_gyro(batch);
        if (s == Status::ok)
            s = read_accel(batch, Ages{*this, edge_ns, now_ns, frames, bytes / accel_frame});
        if (s == Status::ok) {
            stamp(batch, line_, config_.watermark - 1u, edge_ns, now_ns);
            return s;
        }
        batch.count = 0;
        batch.more = false;
        batch.state = FifoState::resync;
        const Status emptied = empty();
        return emptied == Status::ok ? s : emptied;
    }

    /// Accelerometer: what the two directions of its test differ by, m/s^2, in the last three:
    /// passes from 1, 1 and 0.5 g (x, y, z). Gyroscope: 1 where its built-in test passed. Lay the
    /// part still. Leaves the chip reset: start() again. At most 0.5 s.
    Status self_test(SelfTest& result) noexcept {
        using namespace bmi088;
        result = {};
        Config test;
        test.rate = Rate::hz_1000;  // the accelerometer at 1600 Hz, in its widest range
        if (const Status s = start(test); s != Status::ok) return s;
        Vec3 high, low;
        if (const Status s = push(0x0D, high); s != Status::ok) return s;
        if (const Status s = push(0x09, low); s != Status::ok) return s;
        const float moved[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
        const float least_g[3] = {1.0f, 1.0f, 0.5f};
        result.passed = true;
        for (std::size_t i = 0; i < 3; ++i) {
            result.response[3 + i] = moved[i];
            if (moved[i] < least_g[i] * standard_gravity_m_s2) result.passed = false;
        }
        if (const Status s = chip_.write(gyro_self_test, 0x01); s != Status::ok) return s;
        const Status done = chip_.await(gyro_self_test, 0x02, 0x02, 20, 5000);
        if (done != Status::ok) return done;
        const auto verdict = chip_.read(gyro_self_test);
        if (!verdict) return verdict.status();
        const bool good =
            (*verdict & 0x14) == 0x10;  // not failed, and the running check is content
        for (std::size_t i = 0; i < 3; ++i) result.response[i] = good ? 1.0f : 0.0f;
        result.passed = result.passed && good;
        return reset();
    }

    std::size_t watermark() const noexcept { return config_.watermark; }
    std::size_t samples_per_edge() const noexcept {
        return config_.watermark > 0 ? config_.watermark : 1;
    }

  private:
    /// Which acceleration belongs to which sample of the gyroscope, by their ages when the levels
    /// of the two FIFOs were read. The newest acceleration is half a period old, give or take half.
    struct Ages {
        Ages(const Bmi088& driver, std::int64_t edge_ns, std::int64_t now_ns, std::size_t frames,
             std::size_t accel_frames) noexcept
            : period_ns{bmi088::period_ns(driver.config_.rate)},
              accel_ns{bmi088::accel_period_ns(driver.config_.rate)},
              newest_gyro{static_cast<std::int64_t>(frames) - 1},
              newest_accel{static_cast<std::int64_t>(accel_frames) - 1},
              newest_age_ns{period_ns / 2} {
            if (edge_ns == no_edge) return;
            const std::int64_t after = newest_gyro + 1 - driver.config_.watermark;
            const std::int64_t age = now_ns - edge_ns - after * period_ns;
            newest_age_ns = age < 0 ? 0 : age > period_ns ? period_ns : age;
        }
        /// Negative: a frame that an earlier read took out.
        std::int64_t accel_for(std::size_t i) const noexcept {
            const std::int64_t back = newest_gyro - static_cast<std::int64_t>(i);
            return newest_accel - (newest_age_ns + back * period_ns) / accel_ns;
        }
        std::int64_t period_ns, accel_ns, newest_gyro, newest_accel, newest_age_ns;
    };

    /// After a loss of power the accelerometer sleeps and wants 450 us between writes; it is laid
    /// asleep before its reset, which else cuts off its own acknowledge.
    Status reset() noexcept {
        using namespace bmi088;
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        const std::uint8_t steps[3][2] = {
            {power_ctrl, 0x00}, {power_conf, 0x03}, {accel_command, soft_reset}};
        for (const auto& step : steps) {
            if (const Status s = accel_.write(step[0], step[1]); s != Status::ok) return s;
            accel_.bus().pause_us(1000);
        }
        if (const Status s = chip_.write(gyro_reset, soft_reset); s != Status::ok) return s;
        chip_.bus().pause_us(31000);
        return probe().status;
    }

    void describe(const Config& config) noexcept {
        using namespace bmi088;
        const bool fifo = config.watermark > 0;
        accel_settings_.clear();
        accel_settings_.add(power_conf, 0x00);
        accel_settings_.add(power_ctrl, 0x04);
        accel_settings_.add(accel_conf, 0x90 | accel_code(config.rate));  // oversampled twice
        accel_settings_.add(accel_range, static_cast<std::uint8_t>(config.accel), 0x03);
        accel_settings_.add(accel_fifo_mode, 0x02, 0x01);  // the oldest give way
        accel_settings_.add(accel_fifo_enable, fifo ? 0x50 : 0x10, 0x40);
        settings_.clear();
        settings_.add(gyro_range, static_cast<std::uint8_t>(config.gyro), 0x07);
        settings_.add(gyro_bandwidth, static_cast<std::uint8_t>(config.rate), 0x0F);
        settings_.add(int_io_conf, 0x0D, 0x03);  // INT3: push-pull, active high
        settings_.add(int_io_map, fifo ? 0x04 : 0x01);
        settings_.add(int_ctrl, fifo ? 0x40 : 0x80);
        settings_.add(fifo_wm_enable, fifo ? 0x88 : 0x08, 0x80);
        settings_.add(gyro_watermark, config.watermark, 0x7F);
        settings_.add(gyro_fifo_mode, fifo ? 0x80 : 0x00, 0xC0);  // the oldest give way
    }

    Status read_gyro(Batch& batch) noexcept {
        std::size_t i = 0;
        return read_packets(chip_, bmi088::gyro_fifo_data, bmi088::gyro_frame, batch.count,
                            [&](const std::uint8_t* p) {
                                RawImu raw;
                                raw.gyro = triple<little_endian>(p);
                                Sample& to = batch.samples[i++];
                                to = to_sample(raw, scale_, line_.unwrap(next_tick_++), settle());
                                to.flags &= ~flag::accel_valid;
                                return true;
                            });
    }

    Status read_accel(Batch& batch, const Ages& ages) noexcept {
        using namespace bmi088;
        std::size_t next = 0;  // the oldest sample that waits for its acceleration
        std::int64_t k = -1;
        const auto give = [&] {
            for (; next < batch.count && ages.accel_for(next) <= k; ++next)
                if (known_) add_accel(batch.samples[next]);
        };
        give();
        const std::int64_t last = batch.count == 0 ? -1 : ages.accel_for(batch.count - 1);
        return read_packets(accel_, accel_fifo_data, accel_frame,
                            last < 0 ? 0 : static_cast<std::size_t>(last) + 1,
                            [&](const std::uint8_t* p) {
                                if ((p[0] & accel_header_mask) != accel_header) return false;
                                held_ = triple<little_endian>(p + 1);
                                known_ = true;
                                ++k;
                                give();
                                return true;
                            });
    }

    void add_accel(Sample& s) const noexcept {
        s.accel_m_s2 = scaled(held_, scale_.accel_m_s2);
        s.flags |= flag::accel_valid;
        if (at_end(held_)) s.flags |= flag::clipped | flag::accel_clipped;
    }

    /// Empties both FIFOs; the line begins anew, since the count is its clock.
    Status empty() noexcept {
        line_.restart();
        known_ = false;
        const std::uint8_t accel[2] = {bmi088::accel_command, bmi088::accel_fifo_flush};
        const std::uint8_t gyro[2] = {bmi088::gyro_watermark, config_.watermark};
        const Transfer both[2] = {{accel_.address(), accel, 2, nullptr, 0},
                                  {chip_.address(), gyro, 2, nullptr, 0}};
        return chip_.bus().transfer(both, 2);
    }

    Status push(std::uint8_t code, Vec3& accel) noexcept {
        if (const Status s = accel_.write(bmi088::accel_self_test, code); s != Status::ok) return s;
        accel_.bus().pause_us(60000);
        const auto sample = read(0);
        if (!sample) return sample.status();
        accel = sample->accel_m_s2;
        return Status::ok;
    }

    Registers<Bus> accel_;
    Settings<6> accel_settings_{};
    Config config_{};
    std::uint32_t next_tick_{0};
    std::array<std::int16_t, 3> held_{};  // the newest acceleration that left the FIFO
    bool known_{false};
};

}  // namespace fairlead::port
