#pragma once
// Any supported inertial sensor, chosen by name when the program runs, with a magnetometer beside
// it where there is one: the sampling loop of sampler.hpp behind one interface, for programs that
// learn from a user or a file which chip is on the bus.
//
// Allocates in make_imu_loop() alone. A magnetometer that falls silent for half a second is
// started anew; meanwhile samples lack flag::mag_valid.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "port/linux/clock.hpp"
#include "port/linux/sampler.hpp"
#include "port/sensors/ak09916.hpp"
#include "port/sensors/icm426xx.hpp"
#include "port/sensors/lis3mdl.hpp"
#include "port/sensors/lsm6.hpp"
#include "port/sensors/mpu6xxx.hpp"

namespace fairlead::port {

/// What is on the bus. Names: imu_names, mag_names.
struct ImuSetup {
    std::string sensor{"lsm6dso"};
    std::string mag;        // none
    int address{-1};        // the part's own
    int mag_address{-1};    // the magnetometer's own
    unsigned watermark{8};  // samples per interrupt, at most 32; 0: each one, no FIFO
    bool accept_unknown{};
};
inline constexpr std::array<const char*, 4> imu_names{"icm42688", "lsm6dso", "lsm6dsv", "mpu6050"};
inline constexpr std::array<const char*, 2> mag_names{"lis3mdl", "ak09916"};

class ImuLoop {
  public:
    ImuLoop() = default;
    virtual ~ImuLoop() = default;
    ImuLoop(const ImuLoop&) = delete;
    ImuLoop& operator=(const ImuLoop&) = delete;

    virtual Probe probe() noexcept = 0;
    /// The IMU, then the magnetometer. Where it fails, step() goes on trying.
    virtual Status start() noexcept = 0;
    /// As Sampler::step(); the newest sample carries the magnetometer's newest value, if any.
    virtual Status step(Batch& batch) noexcept = 0;
    virtual const SamplerCounts& counts() const noexcept = 0;
    virtual bool running() const noexcept = 0;
    virtual std::int64_t period_ns() const noexcept = 0;
};

/// A magnetometer that is asked beside an IMU.
template <class Driver, class Clock>
class MagBeside {
  public:
    template <class Bus>
    MagBeside(Bus& bus, Clock clock) noexcept : driver_{bus}, clock_{clock} {}

    Status start() noexcept {
        heard_ns_ = clock_.now();
        return driver_.start({});
    }
    void add_to(Sample& sample) noexcept {
        const auto ready = driver_.data_ready();
        if (ready && *ready) {
            const auto field = driver_.read(sample.t_ns);
            if (field) {
                heard_ns_ = clock_.now();
                sample.mag_uT = field->mag_uT;
                sample.flags |=
                    field->flags & (flag::mag_valid | flag::mag_clipped | flag::clipped);
                return;
            }
        }
        if (clock_.now() - heard_ns_ > patience_ns) static_cast<void>(start());
    }

  private:
    static constexpr std::int64_t patience_ns = 500 * ms;
    Driver driver_;
    Clock clock_;
    std::int64_t heard_ns_{};
};

template <class Driver, class Bus, class Edges, class Clock>
class ImuLoopOf final : public ImuLoop {
  public:
    ImuLoopOf(const ImuSetup& setup, Bus& bus, Edges& edges, Clock clock) noexcept
        : imu_{bus,
               static_cast<std::uint8_t>(setup.address < 0 ? Driver::default_address
                                                           : setup.address),
               setup.accept_unknown ? UnknownId::accept : UnknownId::refuse},
          loop_{imu_, edges, clock} {
        config_.watermark = static_cast<std::uint8_t>(setup.watermark);
        if (setup.mag == "lis3mdl") lis3mdl_.emplace(bus, clock);
        if (setup.mag == "ak09916") ak09916_.emplace(bus, clock);
    }
    Probe probe() noexcept override { return imu_.probe(); }
    Status start() noexcept override {
        const Status s = loop_.start(config_);
        if (s != Status::ok) return s;
        if (lis3mdl_) return lis3mdl_->start();
        if (ak09916_) return ak09916_->start();
        return Status::ok;
    }
    Status step(Batch& batch) noexcept override {
        const Status s = loop_.step(batch);
        if (batch.count == 0) return s;
        if (lis3mdl_) lis3mdl_->add_to(batch.samples[batch.count - 1]);
        if (ak09916_) ak09916_->add_to(batch.samples[batch.count - 1]);
        return s;
    }
    const SamplerCounts& counts() const noexcept override { return loop_.counts(); }
    bool running() const noexcept override { return loop_.running(); }
    std::int64_t period_ns() const noexcept override { return imu_.period_ns(); }

  private:
    Driver imu_;
    typename Driver::Config config_{};
    Sampler<Driver, Edges, Clock> loop_;
    std::optional<MagBeside<Lis3mdl<Bus>, Clock>> lis3mdl_;
    std::optional<MagBeside<Ak09916<Bus>, Clock>> ak09916_;
};

/// Null for a sensor that is not among imu_names. Bus and edges must outlive the loop.
template <class Bus, class Edges, class Clock>
std::unique_ptr<ImuLoop> make_imu_loop(const ImuSetup& setup, Bus& bus, Edges& edges, Clock clock) {
    if (setup.sensor == "icm42688")
        return std::make_unique<ImuLoopOf<Icm426xx<Bus>, Bus, Edges, Clock>>(setup, bus, edges,
                                                                             clock);
    if (setup.sensor == "lsm6dso")
        return std::make_unique<ImuLoopOf<Lsm6dso<Bus>, Bus, Edges, Clock>>(setup, bus, edges,
                                                                            clock);
    if (setup.sensor == "lsm6dsv")
        return std::make_unique<ImuLoopOf<Lsm6dsv<Bus>, Bus, Edges, Clock>>(setup, bus, edges,
                                                                            clock);
    if (setup.sensor == "mpu6050")
        return std::make_unique<ImuLoopOf<Mpu6xxx<Bus>, Bus, Edges, Clock>>(setup, bus, edges,
                                                                            clock);
    return nullptr;
}

}  // namespace fairlead::port
