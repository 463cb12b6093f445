// Samples as a source: a chip's model under the port's own sampling loop in real time, and an IMU's
// recording. What a reader rebuilds from the registers is held to the poses that the same samples
// give when they are led through the pipeline again.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "examples/gateway/chain.hpp"
#include "examples/gateway/reader.hpp"
#include "examples/gateway/register_map.hpp"
#include "examples/gateway/sensor.hpp"
#include "examples/gateway/unit_table.hpp"
#include "fairlead/math/quat.hpp"
#include "host_sim/chip_models/icm42688_model.hpp"
#include "host_sim/chip_models/magnetometer_models.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/writers.hpp"
#include "port/linux/clock.hpp"

namespace fairlead::gateway {
namespace {

using port::CurveChannel;
namespace reg = register_map;

/// A swing about all axes, in the sensor's own terms.
sim::Truth swing(std::int64_t t_ns) {
    const double t = static_cast<double>(t_ns % 1'000'000'000'000) * 1e-9;
    sim::Truth truth;
    truth.gyro_rad_s = {static_cast<float>(std::sin(3 * t)),
                        static_cast<float>(1.3 * std::cos(2 * t)),
                        static_cast<float>(0.6 * std::sin(5 * t))};
    truth.accel_m_s2 = {static_cast<float>(std::sin(t)), 0.5f, 9.7f};
    truth.mag_uT = {20, static_cast<float>(5 * std::sin(t)), -40};
    return truth;
}

/// Chip models in real time: transfers answer at once, pauses are slept.
class LiveBus {
  public:
    std::vector<sim::ChipModel*> chips;
    bool broken{false};

    Status transfer(const port::Transfer* list, std::size_t count) noexcept {
        if (broken) return Status::io_error;
        for (std::size_t i = 0; i < count; ++i) {
            const port::Transfer& t = list[i];
            sim::ChipModel* const chip = find(t.address);
            if (chip == nullptr) return Status::no_acknowledge;
            chip->begin_write();
            for (std::size_t k = 0; k < t.out_size; ++k) chip->write(t.out[k]);
            for (std::size_t k = 0; k < t.in_size; ++k) t.in[k] = chip->read();
        }
        return Status::ok;
    }
    static std::size_t read_max() noexcept { return 8192; }
    static void pause_us(std::uint32_t us) noexcept {
        port::sleep_until(port::now_ns() + std::int64_t{us} * port::us);
    }

  private:
    sim::ChipModel* find(std::uint8_t address) const noexcept {
        for (auto* chip : chips) {
            chip->advance(port::now_ns());
            if (chip->address() == address && chip->answers()) return chip;
        }
        return nullptr;
    }
};

class LiveEdges {
  public:
    explicit LiveEdges(sim::ChipModel& chip) : chip_{&chip} {}
    Result<std::int64_t> wait(std::int64_t deadline_ns) noexcept {
        for (;;) {
            chip_->advance(port::now_ns());
            if (!chip_->edges.empty()) break;
            if (port::now_ns() >= deadline_ns) return Status::timeout;
            port::sleep_until(std::min(deadline_ns, chip_->next_ns()));
        }
        const std::int64_t edge = chip_->edges.front();
        chip_->edges.pop_front();
        return edge;
    }

  private:
    sim::ChipModel* chip_;
};

/// Keeps what the loop gave, for the comparison.
class Witness final : public port::ImuLoop {
  public:
    Witness(std::unique_ptr<port::ImuLoop> inner, std::vector<Sample>& seen)
        : inner_{std::move(inner)}, seen_{&seen} {}
    port::Probe probe() noexcept override { return inner_->probe(); }
    port::Probe probe_mag() noexcept override { return inner_->probe_mag(); }
    Status start() noexcept override { return inner_->start(); }
    Status step(port::Batch& batch) noexcept override {
        const Status s = inner_->step(batch);
        seen_->insert(seen_->end(), batch.samples.begin(), batch.samples.begin() + batch.count);
        return s;
    }
    const port::SamplerCounts& counts() const noexcept override { return inner_->counts(); }
    bool running() const noexcept override { return inner_->running(); }
    std::int64_t period_ns() const noexcept override { return inner_->period_ns(); }

  private:
    std::unique_ptr<port::ImuLoop> inner_;
    std::vector<Sample>* seen_;
};

struct Bench {
    sim::Icm42688Model imu{swing};
    sim::Lis3mdlModel mag{swing};
    LiveBus bus;
    LiveEdges edges{imu};
    std::vector<Sample> seen;
    std::vector<Event> pressed;  // that the contacts have told
    std::atomic<std::int64_t> power_cycle_ns{INT64_MAX};
    std::atomic<int> refused_opens{0};
    std::atomic<int> opens{0};
};

class ModelHardware final : public SensorHardware {
  public:
    explicit ModelHardware(Bench& bench) : bench_{&bench} {}
    Opened open(const UnitConfig& unit) override {
        if (bench_->refused_opens > 0) {
            --bench_->refused_opens;
            return {Status::not_found, "i2c bus"};
        }
        ++bench_->opens;
        bench_->bus.chips = {&bench_->imu, &bench_->mag};
        loop_ = std::make_unique<Witness>(
            port::make_imu_loop(unit.imu, bench_->bus, bench_->edges, port::MonotonicClock{}),
            bench_->seen);
        return {};
    }
    void close() noexcept override { loop_.reset(); }
    port::ImuLoop& loop() noexcept override { return *loop_; }
    std::size_t events(std::int64_t now_ns, std::array<Event, events_max>& out) noexcept override {
        if (now_ns >= bench_->power_cycle_ns) {
            bench_->power_cycle_ns = INT64_MAX;
            bench_->imu.power_cycle();
        }
        if (++turns_ % 7 != 0) return 0;
        out[0] = {now_ns - 12345, 3, static_cast<std::uint16_t>(turns_ / 7 % 2), 0};
        bench_->pressed.push_back(out[0]);
        return 1;
    }

  private:
    Bench* bench_;
    std::unique_ptr<port::ImuLoop> loop_;
    std::uint64_t turns_{0};
};

/// One unit's table under a source, asked by a reader now and then.
class Unit {
  public:
    explicit Unit(const UnitConfig& config) : config_{config} {
        table->begin(1, "unit", config.source, 77, 2'000'000'000);
        server.counters = &counters;
    }
    void follow(Source& source, std::int64_t for_ns) {
        source.start(*feed, 77);
        const std::int64_t until_ns = port::now_ns() + for_ns;
        while (port::now_ns() < until_ns) {
            port::sleep_until(port::now_ns() + 20 * port::ms);
            poll();
            if ((reader.status() & reg::status_bit::finished) != 0) break;
        }
        source.stop();
        poll();
    }
    std::uint64_t field(const char* name) const {
        return reg::get_word(table->registers(), reg::field(name));
    }

    std::unique_ptr<UnitFeed> feed = std::make_unique<UnitFeed>();
    std::unique_ptr<UnitTable> table = std::make_unique<UnitTable>();
    port::ModbusCounters counters;
    ServerState server;
    CurveReader reader{[this](std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
        std::copy_n(table->registers() + address, count, out);
        return true;
    }};

    /// Every covered pose within the tolerance. @return how many are covered.
    std::size_t check(const std::vector<Sample>& samples, std::int64_t period_ns, bool mag) {
        const auto chain = make_sample_chain(config_, period_ns, mag);
        const auto limit = static_cast<float>(config_.tolerance_deg * 0.017453292519943295);
        std::size_t covered = 0;
        for (const Sample& sample : samples) {
            chain->push(sample);
            const auto pose = chain->pose();
            if (!pose) continue;
            const auto* span = reader.covering(CurveChannel::orientation, pose->t_ns);
            if (span == nullptr) continue;
            ++covered;
            EXPECT_LE(rotation_angle(port::curve::orientation(*span, pose->t_ns), pose->q_wb),
                      limit * 1.0001f);
        }
        return covered;
    }

  private:
    void poll() {
        table->collect(*feed);
        table->refresh(server, port::now_ns());
        EXPECT_EQ(reader.poll(), PollResult::ok);
    }
    UnitConfig config_;
};

UnitConfig sensor_config(const char* mag) {
    UnitConfig config;
    config.source = SourceKind::sensor;
    config.imu.sensor = "icm42688";
    config.imu.mag = mag;
    return config;
}

class SensorSource : public ::testing::TestWithParam<const char*> {};

TEST_P(SensorSource, WhatAReaderRebuildsIsWhatTheSamplesSay) {
    const UnitConfig config = sensor_config(GetParam());
    Bench bench;
    Unit unit{config};
    const auto source = make_sensor(config, std::make_unique<ModelHardware>(bench));
    unit.follow(*source, 2'500'000'000);
    ASSERT_GT(bench.seen.size(), 800u);
    const std::size_t covered = unit.check(bench.seen, 2'000'000, *GetParam() != 0);
    EXPECT_GT(covered + 300, bench.seen.size()) << "all but what levelling and the reducer hold";
    EXPECT_EQ(unit.field("health.samples"), bench.seen.size());
    EXPECT_EQ(unit.field("health.period_us"), 2000u);
    EXPECT_EQ(unit.field("unit.source"), 3u);
    EXPECT_EQ(unit.field("live.t_ns"), unit.field("clock.source_ns"));
    EXPECT_EQ(unit.field("live.t_ns"), static_cast<std::uint64_t>(bench.seen.back().t_ns));
    const auto status = static_cast<unsigned>(unit.field("live.status"));
    EXPECT_TRUE(status & reg::status_bit::valid_orientation);
    EXPECT_FALSE(status & (reg::status_bit::valid_position | reg::status_bit::source_lost));
}
INSTANTIATE_TEST_SUITE_P(Magnetometer, SensorSource, ::testing::Values("", "lis3mdl"),
                         [](const auto& chosen) { return *chosen.param ? "With" : "Without"; });

TEST(SensorSource, ContactsBecomeEventsWithTheirExactTimes) {
    const UnitConfig config = sensor_config("");
    Bench bench;
    Unit unit{config};
    const auto source = make_sensor(config, std::make_unique<ModelHardware>(bench));
    unit.follow(*source, 1'200'000'000);
    ASSERT_GT(bench.pressed.size(), 5u);
    const auto& events = unit.reader.events();
    ASSERT_EQ(events.size(), bench.pressed.size());
    for (std::size_t i = 0; i < events.size(); ++i) {
        EXPECT_EQ(events[i].t_ns, bench.pressed[i].t_ns);
        EXPECT_EQ(events[i].channel, bench.pressed[i].channel);
        EXPECT_EQ(events[i].value, bench.pressed[i].value);
    }
    EXPECT_EQ(unit.field("events.lost"), 0u);
}

TEST(SensorSource, AResetIsCountedAndTheCurveGoesOn) {
    const UnitConfig config = sensor_config("");
    Bench bench;
    Unit unit{config};
    bench.power_cycle_ns = port::now_ns() + 1'000'000'000;
    const auto source = make_sensor(config, std::make_unique<ModelHardware>(bench));
    unit.follow(*source, 2'500'000'000);
    EXPECT_EQ(unit.field("sensor.resets"), 1u);
    EXPECT_GT(unit.field("sensor.lost"), 0u);
    EXPECT_GT(unit.check(bench.seen, 2'000'000, false), 600u);
    std::size_t gaps = 0;
    for (const Sample& s : bench.seen) gaps += (s.flags & flag::gap_before) != 0 ? 1u : 0u;
    EXPECT_GE(gaps, 1u);
}

TEST(SensorSource, ABusThatComesLaterIsOpenedThen) {
    const UnitConfig config = sensor_config("");
    Bench bench;
    bench.refused_opens = 1;
    Unit unit{config};
    const auto source = make_sensor(config, std::make_unique<ModelHardware>(bench));
    unit.follow(*source, 1'500'000'000);
    EXPECT_EQ(bench.opens, 1);
    EXPECT_EQ(unit.field("health.source_opened"), 1u);
    EXPECT_GT(bench.seen.size(), 200u);
}

TEST(ReplaySource, AnImuRecordingPassesTheAttitudeStage) {
    sim::Recording recording;
    recording.name = "swing";
    recording.period_s = 0.004;
    for (int i = 0; i < 2000; ++i) {
        const std::int64_t t_ns = i * 4'000'000LL;
        const sim::Truth truth = swing(t_ns);
        recording.samples.push_back({t_ns, truth.gyro_rad_s, truth.accel_m_s2, truth.mag_uT,
                                     flag::gyro_valid | flag::accel_valid | flag::mag_valid});
    }
    UnitConfig config;
    config.file = ::testing::TempDir() + "fairlead_gateway_replay.imu";
    config.speed = 5;
    sim::write_bytes(config.file, sim::to_imu(recording));
    const sim::Recording kept = sim::read_recording(config.file);
    Unit unit{config};
    const auto source = make_replay(config);
    unit.follow(*source, 20'000'000'000);
    std::remove(config.file.c_str());
    ASSERT_TRUE(unit.reader.status() & reg::status_bit::finished);
    EXPECT_EQ(unit.field("health.samples"), 2000u);
    EXPECT_EQ(unit.reader.counters().lost_spans, 0u);
    EXPECT_GT(unit.check(kept.samples, 4'000'000, true), 1800u);
}

}  // namespace
}  // namespace fairlead::gateway
