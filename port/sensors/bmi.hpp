#pragma once
// Bosch BMI160 and BMI270: one driver, two register tables.
//
// read() is one transaction; with a watermark the FIFO delivers frames of 12 bytes without headers,
// gyroscope first. The frames carry no time: the sample count is the clock, so after an overrun the
// FIFO is emptied and the time between tells how many are missing.
// A BMI270 measures nothing until its configuration file has been loaded: the caller passes its
// bytes (Config::blob, 8192 of them in Bosch's file), start() uploads them in pieces of 32 and
// waits for the chip's verdict: bad_data when the chip refuses them. On SPI both parts listen only
// after a first, useless read, which start() and probe() make. Source: data sheets BST-BMI160-DS000
// and BST-BMI270-DS000; registers beside Linux's bmi160_core.c and bmi270_core.c, the self test's
// limit of the BMI160 beside Bosch's own driver. start(): at most 40 transactions and 100 ms of
// pauses, for a BMI270 550 more and 160 ms.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"

namespace fairlead::port {

namespace bmi {

/// The codes of both parts: 25 Hz * 2^(code - 6).
enum class Rate : std::uint8_t { hz_25 = 6, hz_50, hz_100, hz_200, hz_400, hz_800, hz_1600 };
constexpr std::int64_t period_ns(Rate r) noexcept { return 40000000 >> (static_cast<int>(r) - 6); }
/// Full scale = 2000 deg/s / 2^code.
enum class GyroRange : std::uint8_t { dps_2000, dps_1000, dps_500, dps_250, dps_125 };
constexpr float rad_s_per_count(GyroRange r) noexcept {
    return 2000.0f / static_cast<float>(1 << static_cast<int>(r)) / 32768.0f * rad_per_deg;
}
/// Full scale = 2 g * 2^code.
enum class AccelRange : std::uint8_t { g_2, g_4, g_8, g_16 };
constexpr float m_s2_per_count(AccelRange r) noexcept {
    return static_cast<float>(2 << static_cast<int>(r)) / 32768.0f * standard_gravity_m_s2;
}

enum Reg : std::uint8_t {  // common to both
    chip_id = 0x00,
    data = 0x0C,
    acc_conf = 0x40,
    acc_range = 0x41,
    gyr_conf = 0x42,
    gyr_range = 0x43,
    self_test = 0x6D,
    command = 0x7E,
};
inline constexpr std::uint8_t soft_reset = 0xB6, fifo_flush = 0xB0;
inline constexpr std::size_t frame_size = 12, blob_max = 8192, blob_piece = 32;

struct Bmi160 {
    static constexpr Part parts[] = {{0xD1, "BMI160"}};
    static constexpr bool has_blob = false, gyro_first = true;
    static constexpr std::uint8_t address = 0x68, dummy = 0x7F, status = 0x1B, temperature = 0x20;
    static constexpr std::uint8_t fifo_length = 0x22, fifo_data = 0x24;
    static constexpr std::size_t fifo_size = 1024;
    static constexpr std::uint16_t length_mask = 0x07FF;
    static constexpr std::uint8_t range_code(AccelRange r) noexcept {
        constexpr std::uint8_t codes[4] = {0x03, 0x05, 0x08, 0x0C};
        return codes[static_cast<int>(r)];
    }
    static constexpr std::uint8_t acc_mode = 0x20, gyr_mode = 0x20;  // normal bandwidth
    template <class S>
    static void add_interrupts(std::uint8_t watermark, S& settings) noexcept {
        const bool fifo = watermark > 0;
        settings.add(0x46, static_cast<std::uint8_t>(3 * watermark));  // in words of 4 bytes
        settings.add(0x47, fifo ? 0xC0 : 0x00);                        // both sensors, no headers
        settings.add(0x53, 0x0A);                                      // INT1: output, active high
        settings.add(0x56, fifo ? 0x40 : 0x80);  // INT1: watermark, or data-ready
        settings.add(0x51, fifo ? 0x40 : 0x10);
    }
};

struct Bmi270 {
    static constexpr Part parts[] = {{0x24, "BMI270"}, {0x27, "BMI260"}};
    static constexpr bool has_blob = true, gyro_first = false;
    static constexpr std::uint8_t address = 0x68, dummy = 0x00, status = 0x03, temperature = 0x22;
    static constexpr std::uint8_t fifo_length = 0x24, fifo_data = 0x26;
    static constexpr std::size_t fifo_size = 2048;
    static constexpr std::uint16_t length_mask = 0x3FFF;
    static constexpr std::uint8_t range_code(AccelRange r) noexcept {
        return static_cast<std::uint8_t>(r);
    }
    static constexpr std::uint8_t acc_mode = 0xA0, gyr_mode = 0xE0;  // performance, low noise
    template <class S>
    static void add_interrupts(std::uint8_t watermark, S& settings) noexcept {
        const bool fifo = watermark > 0;
        const int bytes = static_cast<int>(frame_size) * watermark;
        settings.add(0x46, static_cast<std::uint8_t>(bytes & 0xFF));
        settings.add(0x47, static_cast<std::uint8_t>(bytes >> 8));
        settings.add(0x48, 0x00);  // the oldest give way, no sensor time
        settings.add(0x49, fifo ? 0xC0 : 0x00);
        settings.add(0x53, 0x0A);
        settings.add(0x58, fifo ? 0x02 : 0x04);
    }
};

}  // namespace bmi

template <class Bus, class Family>
class Bmi : public ImuDriver<Bus, 12> {
    using Base = ImuDriver<Bus, 12>;
    using Base::chip_, Base::unknown_, Base::settings_, Base::scale_, Base::line_;
    using Base::temperature_c_, Base::settle, Base::settle_for;

  public:
    struct Config {
        bmi::Rate rate{bmi::Rate::hz_400};
        bmi::GyroRange gyro{bmi::GyroRange::dps_2000};
        bmi::AccelRange accel{bmi::AccelRange::g_16};
        std::uint8_t watermark{
            0};  // samples per FIFO interrupt, at most 64; 0: data-ready, no FIFO
        const std::uint8_t* blob{};  // BMI270: the configuration file; must outlive the driver
        std::size_t blob_size{};     // even, at most 8192
    };
    static constexpr std::uint8_t default_address = Family::address;

    explicit Bmi(Bus& bus, std::uint8_t address = default_address,
                 UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    Probe probe() const noexcept {
        if (const auto first = chip_.read(Family::dummy); !first) {
            Probe p;
            p.address = chip_.address();
            p.reg = bmi::chip_id;
            p.expected = Family::parts[0].id;
            p.status = first.status();
            return p;
        }
        return probe_for(chip_, bmi::chip_id, Family::parts, unknown_);
    }

    /// Reset, identity, configuration file (BMI270), settings, each read back. Until the gyroscope
    /// has started, 80 ms, samples carry flag::settling. bad_argument: no blob for a BMI270.
    Status start(const Config& config) noexcept {
        using namespace bmi;
        if (config.watermark > Batch::capacity) return Status::bad_argument;
        if (Family::has_blob && (config.blob == nullptr || config.blob_size == 0 ||
                                 config.blob_size > blob_max || config.blob_size % 2 != 0))
            return Status::bad_argument;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        if constexpr (Family::has_blob)
            if (const Status s = upload(); s != Status::ok) return s;
        const auto rate = static_cast<std::uint8_t>(config.rate);
        settings_.clear();
        settings_.add(acc_conf, Family::acc_mode | rate);
        settings_.add(acc_range, Family::range_code(config.accel));
        settings_.add(gyr_conf, Family::gyr_mode | rate);
        settings_.add(gyr_range, static_cast<std::uint8_t>(config.gyro));
        Family::add_interrupts(config.watermark, settings_);
        if (const Status s = settings_.write(chip_); s != Status::ok) return s;
        if (const Status s = power_on(); s != Status::ok) return s;
        scale_ = {rad_s_per_count(config.gyro), m_s2_per_count(config.accel)};
        const std::int64_t period = bmi::period_ns(config.rate);
        line_.configure(period * 1000, period, 32);
        settle_for(80000000);
        return config.watermark > 0 ? empty() : Status::ok;
    }

    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(Family::status);
        if (!status) return status.status();
        return (*status & 0xC0) == 0xC0;
    }

    /// One transaction: the newest sample, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t b[bmi::frame_size] = {}, t[2] = {};
        const std::uint8_t data = bmi::data, temperature = Family::temperature;
        const Transfer both[2] = {{chip_.address(), &data, 1, b, sizeof b},
                                  {chip_.address(), &temperature, 1, t, sizeof t}};
        const Status s = chip_.bus().transfer(both, 2);
        if (s != Status::ok) return s;
        const std::int16_t raw = little_endian(t);
        if (raw != INT16_MIN) temperature_c_ = static_cast<float>(raw) / 512.0f + 23.0f;
        return to_sample(parse(b, Family::gyro_first), scale_, edge_ns, settle());
    }

    /// Everything in the FIFO, up to a batch. edge_ns: when the watermark was reached, or no_edge.
    Status read_fifo(std::int64_t edge_ns, std::int64_t now_ns, Batch& batch) noexcept {
        batch.clear();
        std::uint8_t size[2] = {};
        Status s = chip_.read(Family::fifo_length, size, sizeof size);
        if (s != Status::ok) return s;
        const std::size_t bytes =
            static_cast<std::uint16_t>(little_endian(size)) & Family::length_mask;
        if (bytes + bmi::frame_size > Family::fifo_size) {  // full: the oldest give way, uncounted
            batch.state = FifoState::overrun;
            return empty();
        }
        const std::size_t frames = bytes / bmi::frame_size;
        const std::size_t count = frames < Batch::capacity ? frames : Batch::capacity;
        batch.more = frames > count;
        const std::uint32_t first = next_tick_;
        s = read_packets(
            chip_, Family::fifo_data, bmi::frame_size, count, [&](const std::uint8_t* p) {
                const std::int64_t tick = line_.unwrap(next_tick_++);
                batch.samples[batch.count++] = to_sample(parse(p, true), scale_, tick, settle());
                return true;
            });
        stamp(batch, line_, config_.watermark - 1u, edge_ns, now_ns);
        if (s == Status::ok) return s;
        next_tick_ = first + static_cast<std::uint32_t>(count);
        batch.state = FifoState::resync;  // how much was taken out is unknown: begin again
        const Status emptied = empty();
        return emptied == Status::ok ? s : emptied;
    }

    /// Accelerometer: what the two directions of the test differ by, m/s^2, in the last three; a
    /// BMI160 passes from 2 g up, a BMI270 from 16, 15 and 10 g (x, y, z). Gyroscope: 1 where the
    /// BMI160's own test passed; a BMI270's needs a function of its configuration file and is not
    /// run. Leaves the chip reset: start() again. At most 0.4 s.
    Status self_test(SelfTest& result) noexcept {
        using namespace bmi;
        result = {};
        Config test = config_;
        test.rate = Rate::hz_1600;
        test.accel = Family::has_blob ? AccelRange::g_16 : AccelRange::g_8;
        test.watermark = 0;
        if (const Status s = start(test); s != Status::ok) return s;
        Vec3 high, low;
        if (const Status s = push(0x0D, high); s != Status::ok) return s;  // on, large, positive
        if (const Status s = push(0x09, low); s != Status::ok) return s;
        const float difference[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
        const float least[3] = {Family::has_blob ? 16.0f : 2.0f, Family::has_blob ? 15.0f : 2.0f,
                                Family::has_blob ? 10.0f : 2.0f};
        result.passed = true;
        for (std::size_t i = 0; i < 3; ++i) {
            const float moved = difference[i] < 0 ? -difference[i] : difference[i];
            result.response[3 + i] = moved;
            if (moved < least[i] * standard_gravity_m_s2) result.passed = false;
        }
        if constexpr (!Family::has_blob) {
            if (const Status s = chip_.write(bmi::self_test, 0x10); s != Status::ok) return s;
            chip_.bus().pause_us(20000);
            const auto status = chip_.read(Family::status);
            if (!status) return status.status();
            const bool good = (*status & 0x02) != 0;
            for (std::size_t i = 0; i < 3; ++i) result.response[i] = good ? 1.0f : 0.0f;
            result.passed = result.passed && good;
        }
        return reset();
    }

    std::size_t watermark() const noexcept { return config_.watermark; }
    std::size_t samples_per_edge() const noexcept {
        return config_.watermark > 0 ? config_.watermark : 1;
    }

  private:
    Status reset() noexcept {
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(bmi::command, bmi::soft_reset); s != Status::ok) return s;
        chip_.bus().pause_us(2000);
        return probe().status;  // and on SPI: listen again
    }

    Status power_on() noexcept {
        if constexpr (Family::has_blob) return chip_.set(0x7D, 0x0E);  // gyro, accel, thermometer
        if (const Status s = chip_.write(bmi::command, 0x11); s != Status::ok) return s;
        chip_.bus().pause_us(4000);
        if (const Status s = chip_.write(bmi::command, 0x15); s != Status::ok) return s;
        chip_.bus().pause_us(81000);
        return chip_.expect(0x03, 0x14, 0x3C);  // both in normal mode
    }

    Status upload() noexcept {
        if (const Status s = chip_.write(0x7C, 0x00); s != Status::ok) return s;  // no power saving
        chip_.bus().pause_us(450);
        if (const Status s = chip_.write(0x59, 0x00); s != Status::ok) return s;
        for (std::size_t at = 0; at < config_.blob_size; at += bmi::blob_piece) {
            const std::size_t word = at / 2;
            const std::uint8_t place[3] = {0x5B, static_cast<std::uint8_t>(word & 0x0F),
                                           static_cast<std::uint8_t>(word >> 4)};
            std::uint8_t piece[1 + bmi::blob_piece] = {0x5E};
            const std::size_t n =
                config_.blob_size - at < bmi::blob_piece ? config_.blob_size - at : bmi::blob_piece;
            for (std::size_t i = 0; i < n; ++i) piece[1 + i] = config_.blob[at + i];
            const Transfer to{chip_.address(), place, sizeof place, nullptr, 0};
            if (const Status s = chip_.bus().transfer(&to, 1); s != Status::ok) return s;
            const Transfer data{chip_.address(), piece, static_cast<std::uint16_t>(1 + n), nullptr,
                                0};
            if (const Status s = chip_.bus().transfer(&data, 1); s != Status::ok) return s;
        }
        if (const Status s = chip_.write(0x59, 0x01); s != Status::ok) return s;
        for (int i = 0; i < 15; ++i) {
            chip_.bus().pause_us(10000);
            const auto status = chip_.read(0x21);
            if (!status) return status.status();
            if ((*status & 0x0F) == 0x01) return Status::ok;
            if ((*status & 0x0F) != 0x00) return Status::bad_data;  // the chip refuses the file
        }
        return Status::timeout;
    }

    /// Empties the FIFO; the line begins anew, since the count is its clock.
    Status empty() noexcept {
        line_.restart();
        return chip_.write(bmi::command, bmi::fifo_flush);
    }

    static RawImu parse(const std::uint8_t* b, bool gyro_first) noexcept {
        RawImu raw;
        raw.gyro = triple<little_endian>(b + (gyro_first ? 0 : 6));
        raw.accel = triple<little_endian>(b + (gyro_first ? 6 : 0));
        return raw;
    }

    Status push(std::uint8_t code, Vec3& accel) noexcept {
        if (const Status s = chip_.write(bmi::self_test, code); s != Status::ok) return s;
        chip_.bus().pause_us(60000);
        const auto sample = read(0);
        if (!sample) return sample.status();
        accel = sample->accel_m_s2;
        return Status::ok;
    }

    Config config_{};
    std::uint32_t next_tick_{0};
};

template <class Bus>
using Bmi160 = Bmi<Bus, bmi::Bmi160>;
template <class Bus>
using Bmi270 = Bmi<Bus, bmi::Bmi270>;

}  // namespace fairlead::port
