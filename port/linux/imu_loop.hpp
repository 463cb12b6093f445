#pragma once
// Any supported inertial sensor, chosen by name when the program runs, with a magnetometer beside
// it where there is one: the sampling loop of sampler.hpp behind one interface, for programs that
// learn from a user or a file which chip is on the bus. Names: port/sensors/chips.hpp.
//
// Allocates in make_imu_loop() alone. A magnetometer that falls silent for half a second is
// started anew; meanwhile samples lack flag::mag_valid. One that stands behind its IMU's bypass is
// connected by the IMU's driver.
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "port/linux/clock.hpp"
#include "port/linux/sampler.hpp"
#include "port/sensors/chips.hpp"

namespace fairlead::port {

/// What is on the bus.
struct ImuSetup {
    std::string sensor{"lsm6dso"};
    std::string mag;        // none
    int address{-1};        // the part's own
    int mag_address{-1};    // the magnetometer's own
    unsigned watermark{8};  // samples per interrupt, at most 32; 0: each one, no FIFO
    bool accept_unknown{};
    std::string blob;  // bytes of the configuration file that a BMI270 needs
};

class ImuLoop {
  public:
    ImuLoop() = default;
    virtual ~ImuLoop() = default;
    ImuLoop(const ImuLoop&) = delete;
    ImuLoop& operator=(const ImuLoop&) = delete;

    virtual Probe probe() noexcept = 0;
    /// not_found where no magnetometer was asked for.
    virtual Probe probe_mag() noexcept = 0;
    /// The IMU, then the magnetometer. Where it fails, step() goes on trying.
    virtual Status start() noexcept = 0;
    /// As Sampler::step(); the newest sample carries the magnetometer's newest value, if any.
    virtual Status step(Batch& batch) noexcept = 0;
    virtual const SamplerCounts& counts() const noexcept = 0;
    virtual bool running() const noexcept = 0;
    virtual std::int64_t period_ns() const noexcept = 0;
};

/// A magnetometer that is asked beside an IMU.
class MagBeside {
  public:
    MagBeside() = default;
    virtual ~MagBeside() = default;
    MagBeside(const MagBeside&) = delete;
    MagBeside& operator=(const MagBeside&) = delete;
    virtual Probe probe() noexcept = 0;
    virtual Status start() noexcept = 0;
    virtual void add_to(Sample& sample) noexcept = 0;
};

template <class Driver, class Clock>
class MagBesideOf final : public MagBeside {
  public:
    template <class Bus>
    MagBesideOf(Bus& bus, const ImuSetup& setup, Clock clock) noexcept
        : driver_{bus,
                  static_cast<std::uint8_t>(setup.mag_address < 0 ? Driver::default_address
                                                                  : setup.mag_address),
                  setup.accept_unknown ? UnknownId::accept : UnknownId::refuse},
          clock_{clock} {}

    Probe probe() noexcept override { return driver_.probe(); }
    Status start() noexcept override {
        heard_ns_ = clock_.now();
        return driver_.start({});
    }
    void add_to(Sample& sample) noexcept override {
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

namespace detail {

template <class Config, class = void>
struct HasBypass : std::false_type {};
template <class Config>
struct HasBypass<Config, std::void_t<decltype(std::declval<Config>().bypass)>> : std::true_type {};
template <class Config, class = void>
struct HasBlob : std::false_type {};
template <class Config>
struct HasBlob<Config, std::void_t<decltype(std::declval<Config>().blob)>> : std::true_type {};

}  // namespace detail

template <class Driver, class Bus, class Edges, class Clock>
class ImuLoopOf final : public ImuLoop {
  public:
    using Config = typename Driver::Config;

    ImuLoopOf(const ImuSetup& setup, Bus& bus, Edges& edges, Clock clock,
              std::unique_ptr<MagBeside> mag, bool mag_behind_bypass)
        : imu_{bus,
               static_cast<std::uint8_t>(setup.address < 0 ? Driver::default_address
                                                           : setup.address),
               setup.accept_unknown ? UnknownId::accept : UnknownId::refuse},
          loop_{imu_, edges, clock},
          mag_{std::move(mag)},
          blob_{setup.blob} {
        config_.watermark = static_cast<std::uint8_t>(setup.watermark);
        if constexpr (detail::HasBypass<Config>::value) config_.bypass = mag_behind_bypass;
        if constexpr (detail::HasBlob<Config>::value) {
            config_.blob = reinterpret_cast<const std::uint8_t*>(blob_.data());
            config_.blob_size = blob_.size();
        }
    }
    Probe probe() noexcept override { return imu_.probe(); }
    Probe probe_mag() noexcept override { return mag_ ? mag_->probe() : Probe{}; }
    Status start() noexcept override {
        const Status s = loop_.start(config_);
        return s != Status::ok || !mag_ ? s : mag_->start();
    }
    Status step(Batch& batch) noexcept override {
        const Status s = loop_.step(batch);
        if (batch.count > 0 && mag_) mag_->add_to(batch.samples[batch.count - 1]);
        return s;
    }
    const SamplerCounts& counts() const noexcept override { return loop_.counts(); }
    bool running() const noexcept override { return loop_.running(); }
    std::int64_t period_ns() const noexcept override { return imu_.period_ns(); }

  private:
    Driver imu_;
    Config config_{};
    Sampler<Driver, Edges, Clock> loop_;
    std::unique_ptr<MagBeside> mag_;
    std::string blob_;
};

/// Null for a sensor or a magnetometer that no table knows. Buses and edges must outlive the loop.
template <class Bus, class MagBus, class Edges, class Clock>
std::unique_ptr<ImuLoop> make_imu_loop(const ImuSetup& setup, Bus& bus, MagBus& mag_bus,
                                       Edges& edges, Clock clock) {
    std::unique_ptr<MagBeside> mag;
    bool behind_bypass = false;
    const bool known = setup.mag.empty() || MagChips::visit(setup.mag, [&](auto chip) {
                           using Chip = decltype(chip);
                           using Driver = typename Chip::template Driver<MagBus>;
                           mag =
                               std::make_unique<MagBesideOf<Driver, Clock>>(mag_bus, setup, clock);
                           behind_bypass = Chip::info.behind_bypass;
                       });
    if (!known) return nullptr;
    std::unique_ptr<ImuLoop> loop;
    ImuChips::visit(setup.sensor, [&](auto chip) {
        using Driver = typename decltype(chip)::template Driver<Bus>;
        loop = std::make_unique<ImuLoopOf<Driver, Bus, Edges, Clock>>(
            setup, bus, edges, clock, std::move(mag), behind_bypass);
    });
    return loop;
}

/// Both on one bus.
template <class Bus, class Edges, class Clock>
std::unique_ptr<ImuLoop> make_imu_loop(const ImuSetup& setup, Bus& bus, Edges& edges, Clock clock) {
    return make_imu_loop(setup, bus, bus, edges, clock);
}

}  // namespace fairlead::port
