#pragma once
// The one sampling loop: waits for data-ready edges, reads the sensor, passes every sample through
// Intake, and mends what breaks. Whatever happens is counted; every hole in the stream is flagged.
//
//   missed edge      the wait ends at 1.5 edge periods; the sensor is asked without an edge
//   failed transfer  asked again at once, with the same edge; three in a row restart the sensor
//   silence          no data where data must be: the settings are compared, then restart
//   reset, brown-out settings differ: restart
//   failed restart   again after 5 ms, doubling to 40 ms
//   clock jump       an edge that lies in the future or over a second back is not believed; the
//                    sample's time then comes from the chip's clock, or from now
//
// Time: a step lasts at most 1.5 edge periods (plus 100 ms after a start), plus the transfers of
// one read or one start. Imu: any driver of port/sensors with a FIFO interface; Edges:
// wait(deadline) -> Result<int64 ns>; Clock: now() -> int64 ns. No heap.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "fairlead/sense/intake.hpp"
#include "port/sensors/fifo.hpp"

namespace fairlead::port {

struct SamplerCounts {
    std::uint64_t samples{};          // that passed
    std::uint64_t lost{};             // that are missing; the first one after a hole has gap_before
    std::uint64_t refused{};          // by Intake
    std::uint64_t edges{};            // that arrived
    std::uint64_t missed_edges{};     // that were waited for in vain
    std::uint64_t transfer_errors{};  // on the bus
    std::uint64_t overruns{};         // of the chip's FIFO
    std::uint64_t resyncs{};          // of the place in the FIFO or in time
    std::uint64_t resets{};           // of the chip, that we did not order
    std::uint64_t restarts{};         // that we ordered and that worked
    std::uint64_t failed_restarts{};
    std::uint64_t clock_jumps{};
};

template <class Imu, class Edges, class Clock>
class Sampler {
  public:
    using Config = typename Imu::Config;

    Sampler(Imu& imu, Edges& edges, Clock clock, const IntakeParams& intake = {}) noexcept
        : imu_{&imu}, edges_{&edges}, clock_{clock}, intake_{intake} {}

    Status start(const Config& config) noexcept {
        config_ = config;
        return restart();
    }

    /// One turn: at most one batch, possibly empty. The status says what went wrong in this turn;
    /// going on with the next turn is always right.
    Status step(Batch& batch) noexcept {
        batch.clear();
        if (!running_) return mend();
        std::int64_t edge = held_edge_;
        if (!more_ && !again_) edge = wait();
        if (!running_) return Status::ok;
        const Status s = config_.watermark > 0 ? read_fifo(edge, batch) : read_one(edge, batch);
        more_ = s == Status::ok && batch.more;
        note(s, edge, batch);
        pass(batch);
        return s;
    }

    const SamplerCounts& counts() const noexcept { return counts_; }
    const Intake<Sample>& intake() const noexcept { return intake_; }
    bool running() const noexcept { return running_; }

  private:
    static constexpr std::int64_t ms = 1000000;
    static constexpr std::int64_t start_ns = 100 * ms;  // what a sensor may take to its first edge
    static constexpr std::int64_t backoff_min_ns = 5 * ms, backoff_max_ns = 40 * ms;
    static constexpr std::int64_t past_max_ns = 1000 * ms, future_max_ns = 1 * ms;
    static constexpr int errors_max = 3;
    static constexpr int silence_max = 2;

    std::size_t edges_needed() const noexcept {
        return std::max<std::size_t>(1, imu_->watermark() / imu_->samples_per_edge());
    }

    /// The newest edge, or no_edge at the deadline.
    std::int64_t wait() noexcept {
        const auto edge_period =
            static_cast<std::int64_t>(imu_->samples_per_edge()) * imu_->period_ns();
        const auto needed = static_cast<std::int64_t>(edges_needed());
        const std::int64_t patience = edge_period * needed + edge_period / 2;
        const std::int64_t deadline = clock_.now() + patience + (fresh_ ? start_ns : 0);
        std::int64_t newest = no_edge;
        // as many edges as the data need, and then those that have come already
        for (std::size_t seen = 0; seen < edges_needed() + Batch::capacity;) {
            const auto edge = edges_->wait(seen < edges_needed() ? deadline : 0);
            if (!edge) break;
            ++seen;
            ++counts_.edges;
            newest = *edge;
        }
        if (newest == no_edge) ++counts_.missed_edges;
        return believed(newest);
    }

    std::int64_t believed(std::int64_t edge) noexcept {
        if (edge == no_edge) return edge;
        const std::int64_t age = clock_.now() - edge;
        if (age >= -future_max_ns && age <= past_max_ns) return edge;
        ++counts_.clock_jumps;
        return no_edge;
    }

    Status read_fifo(std::int64_t edge, Batch& batch) noexcept {
        return imu_->read_fifo(more_ ? no_edge : edge, clock_.now(), batch);
    }

    /// The newest sample. An edge that is older than a period is not this sample's: its time moves
    /// on by whole periods.
    Status read_one(std::int64_t edge, Batch& batch) noexcept {
        if (edge == no_edge) {
            const auto ready = imu_->data_ready();
            if (!ready || !*ready) return ready.status();
            edge = clock_.now();  // at best; once running, the newest sample's due time is known
            if (last_ns_ != no_edge && edge > last_ns_)
                edge -= (edge - last_ns_) % imu_->period_ns();
        }
        const std::int64_t late = (clock_.now() - edge) / imu_->period_ns();
        if (late > 0) counts_.missed_edges += static_cast<std::uint64_t>(late);
        const auto sample = imu_->read(edge + std::max<std::int64_t>(late, 0) * imu_->period_ns());
        if (!sample) return sample.status();
        batch.samples[0] = *sample;
        batch.count = 1;
        const std::int64_t passed = last_ns_ == no_edge ? 0 : sample->t_ns - last_ns_;
        if (passed > imu_->period_ns() * 3 / 2) {
            batch.lost = static_cast<std::uint32_t>(std::min<std::int64_t>(
                (passed + imu_->period_ns() / 2) / imu_->period_ns() - 1, UINT32_MAX));
            batch.samples[0].flags |= flag::gap_before;
        }
        last_ns_ = sample->t_ns;
        return Status::ok;
    }

    /// What this turn means for the next.
    void note(Status s, std::int64_t edge, const Batch& batch) noexcept {
        counts_.lost += batch.lost;
        if (batch.state == FifoState::overrun) ++counts_.overruns;
        if (batch.state == FifoState::resync) ++counts_.resyncs;
        again_ = s != Status::ok;
        held_edge_ = again_ ? edge : no_edge;
        if (again_) {
            ++counts_.transfer_errors;
            if (++errors_ >= errors_max) stop();
            return;
        }
        errors_ = 0;
        if (batch.count > 0) {
            fresh_ = false;
            silence_ = 0;
            return;
        }
        if (edge != no_edge || batch.state != FifoState::streaming) return;
        ++silence_;  // waited in vain, and there was nothing to read
        const Status settings = imu_->check();
        if (settings == Status::bad_data) ++counts_.resets;
        if (settings != Status::ok || silence_ >= silence_max) stop();
    }

    void stop() noexcept {
        running_ = false;
        more_ = again_ = false;
        errors_ = silence_ = 0;
        retry_ns_ = clock_.now();
        backoff_ns_ = backoff_min_ns;
    }

    Status mend() noexcept {
        while (clock_.now() < retry_ns_)
            if (!edges_->wait(retry_ns_)) break;  // edges of a sensor that is down mean nothing
        return restart();
    }

    Status restart() noexcept {
        const Status s = imu_->start(config_);
        running_ = s == Status::ok;
        if (running_) {
            ++counts_.restarts;
            fresh_ = true;
            return s;
        }
        ++counts_.failed_restarts;
        retry_ns_ = clock_.now() + backoff_ns_;
        backoff_ns_ = std::min(backoff_ns_ * 2, backoff_max_ns);
        return s;
    }

    /// Samples that Intake refuses leave the batch.
    void pass(Batch& batch) noexcept {
        std::size_t kept = 0;
        const float temperature_c = imu_->temperature_c();
        for (std::size_t i = 0; i < batch.count; ++i) {
            if (temperature_c == temperature_c) {  // it has been read
                batch.samples[i].temperature_c = temperature_c;
                batch.samples[i].flags |= flag::temperature_valid;
            }
            const auto sample = intake_.push(batch.samples[i]);
            if (sample) batch.samples[kept++] = *sample;
            if (intake_.refused()) ++counts_.refused;
        }
        batch.count = kept;
        counts_.samples += kept;
    }

    Imu* imu_;
    Edges* edges_;
    Clock clock_;
    Intake<Sample> intake_;
    Config config_{};
    SamplerCounts counts_{};
    bool running_{false};
    bool fresh_{true};   // started, and no data yet
    bool more_{false};   // the last batch did not empty the FIFO
    bool again_{false};  // the last transfer failed
    std::int64_t held_edge_{no_edge};
    int errors_{0};
    int silence_{0};
    std::int64_t retry_ns_{0};
    std::int64_t backoff_ns_{backoff_min_ns};
    std::int64_t last_ns_{no_edge};
};

}  // namespace fairlead::port
