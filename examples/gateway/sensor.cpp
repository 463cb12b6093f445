#include "examples/gateway/sensor.hpp"

#include <algorithm>

#include "examples/gateway/calibration_watch.hpp"
#include "examples/gateway/chain.hpp"
#include "examples/gateway/clock_map.hpp"
#include "examples/gateway/follower.hpp"
#include "examples/gateway/live.hpp"
#include "port/linux/clock.hpp"

namespace fairlead::gateway {
namespace {

namespace status_bit = port::registers::status_bit;

constexpr std::int64_t reopen_ns = 500 * port::ms;
constexpr std::int64_t silence_ns = 5 * port::second;  // then the bus is opened anew

class Sensor : public Source {
  public:
    Sensor(const UnitConfig& unit, std::unique_ptr<SensorHardware> hardware)
        : unit_{unit}, hardware_{std::move(hardware)} {}
    ~Sensor() override { stop(); }

  protected:
    void run(UnitFeed& feed, UnitState& state) override {
        const auto follower =
            std::make_unique<CurveFollower>(feed, state, CurveFollower::WhenFull::drop);
        bool told = false;
        while (!stopping()) {
            const auto opened = hardware_->open(unit_);
            if (opened.status == Status::ok) {
                told = false;
                ++state.opened;
                tell(Level::info, "sensor opened", unit_.imu.sensor.c_str(), "");
                sample(*follower, feed, state);
                hardware_->close();
                if (stopping()) return;
                ++state.lost;
                tell(Level::warning, "sensor lost", unit_.imu.sensor.c_str(), "");
            } else if (!told) {
                told = true;
                tell(Level::warning, "sensor not there", opened.what, to_string(opened.status),
                     opened.remedy);
            }
            set_lost(feed, state, true);
            sleep_until(port::now_ns() + reopen_ns);
        }
    }

  private:
    void tell(Level level, const char* event, const char* device, const char* why,
              const char* remedy = "") const {
        LogLine line{level, event};
        line.add("unit", unit_.id).add("device", device);
        if (*why != 0) line.add("why", why);
        if (*remedy != 0) line.add("remedy", remedy);
    }

    static void set_lost(UnitFeed& feed, UnitState& state, bool lost) noexcept {
        const unsigned others = state.status & ~unsigned{status_bit::source_lost};
        state.status = static_cast<std::uint16_t>(lost ? others | status_bit::source_lost : others);
        feed.state.write(state);
    }

    /// Until it is time to stop, or the sensor has been silent for too long.
    void sample(CurveFollower& follower, UnitFeed& feed, UnitState& state) noexcept {
        port::ImuLoop& loop = hardware_->loop();
        static_cast<void>(loop.start());  // where it fails, the loop goes on trying
        std::int64_t heard_ns = port::now_ns();
        while (!stopping()) {
            static_cast<void>(loop.step(batch_));  // what went wrong is in the counts
            state.arrival_ns = port::now_ns();
            if (!chain_ && loop.running()) begin(loop, state);
            if (!chain_) {
                if (state.arrival_ns - heard_ns > silence_ns) return;
                continue;
            }
            take_events();
            for (std::size_t i = 0; i < batch_.count; ++i) {
                calibration_.push(batch_.samples[i]);
                const Bytes bytes = chain_->push(batch_.samples[i]);
                follower.take(bytes.data, bytes.size);
                if (const auto pose = chain_->pose()) live_.show(*pose, state);
            }
            state.samples += static_cast<std::uint32_t>(batch_.count);
            state.calibration = calibration_.state();
            count(loop.counts(), state);
            if (batch_.count > 0) {
                heard_ns = state.arrival_ns;
                state.t_ns = state.source_ns;  // edges carry the gateway's own clock
                publish(feed, state);
            } else {
                const Bytes bytes = chain_->idle();
                follower.take(bytes.data, bytes.size);
                if (state.arrival_ns - heard_ns > silence_ns) return;
                set_lost(feed, state, !loop.running());
            }
        }
    }

    /// The sensor has said for the first time what its true rate is.
    void begin(const port::ImuLoop& loop, UnitState& state) noexcept {
        const std::int64_t period_ns = loop.period_ns();
        state.period_us = static_cast<std::uint32_t>(period_ns / port::us);
        state.clock_error_ns = static_cast<std::uint32_t>(ClockMap::wakeup_ns);
        chain_ = make_sample_chain(unit_, period_ns, !unit_.imu.mag.empty());
    }

    void take_events() noexcept {
        std::array<Event, SensorHardware::events_max> events{};
        const std::size_t n = hardware_->events(port::now_ns(), events);
        for (std::size_t i = 0; i < n; ++i)
            static_cast<void>(chain_->push_event(events[i]));  // a refusal shows in its numbers
    }

    void count(const port::SamplerCounts& c, UnitState& state) const noexcept {
        const auto narrow = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
        state.sample_faults = narrow(c.refused) + chain_->faults();
        state.sensor = {narrow(c.lost),     narrow(c.missed_edges), narrow(c.transfer_errors),
                        narrow(c.overruns), narrow(c.resets),       narrow(c.clock_jumps)};
    }

    UnitConfig unit_;
    std::unique_ptr<SensorHardware> hardware_;
    std::unique_ptr<Chain<Sample>> chain_;
    port::Batch batch_{};
    LivePose live_;
    CalibrationWatch calibration_;
};

}  // namespace

std::unique_ptr<Source> make_sensor(const UnitConfig& unit,
                                    std::unique_ptr<SensorHardware> hardware) {
    return std::make_unique<Sensor>(unit, std::move(hardware));
}

std::unique_ptr<Source> make_sensor(const UnitConfig& unit) {
    return make_sensor(unit, make_linux_hardware());
}

}  // namespace fairlead::gateway
