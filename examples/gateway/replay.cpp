// A recording as a source: its poses or IMU samples through the pipeline, in real time or faster,
// then through the decoder into the unit's feed, as if a board had sent them.
#include <algorithm>
#include <memory>

#include "examples/gateway/calibration_watch.hpp"
#include "examples/gateway/chain.hpp"
#include "examples/gateway/follower.hpp"
#include "examples/gateway/live.hpp"
#include "examples/gateway/source.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/recording.hpp"
#include "port/linux/clock.hpp"

namespace fairlead::gateway {
namespace {

namespace status_bit = port::registers::status_bit;

bool has_magnetometer(const std::vector<Sample>& samples) {
    return std::any_of(samples.begin(), samples.end(),
                       [](const Sample& s) { return (s.flags & flag::mag_valid) != 0; });
}

/// A long file is read with a line of progress, where a terminal is.
sim::ReadOptions shown() {
    sim::ReadOptions how;
    how.progress = sim::progress_steps("read", "bytes");
    return how;
}

class Replay : public Source {
  public:
    explicit Replay(const UnitConfig& unit)
        : unit_{unit}, recording_{sim::read_recording(unit.file, shown())} {
        if (recording_.size() == 0) throw sim::BadData{unit.file + ": holds no records"};
    }
    ~Replay() override { stop(); }

  protected:
    void run(UnitFeed& feed, UnitState& state) override {
        state.period_us = static_cast<std::uint32_t>(recording_.period_s * 1e6 / unit_.speed);
        state.opened = 1;
        bool again = false;
        do {
            const auto follower =
                std::make_unique<CurveFollower>(feed, state, CurveFollower::WhenFull::wait);
            if (again) follower->restart();
            if (!play(*follower, feed, state)) return;
            again = true;
        } while (unit_.loop);
        state.status |= status_bit::finished;
        feed.state.write(state);
        while (sleep_until(port::now_ns() + port::second)) {
        }
    }

  private:
    /// @return false when stopped before the end.
    bool play(CurveFollower& follower, UnitFeed& feed, UnitState& state) {
        const auto period_ns = static_cast<std::int64_t>(recording_.period_s * 1e9);
        if (recording_.samples.empty()) {
            const auto chain = make_pose_chain(unit_, period_ns);
            return play(recording_.poses, *chain, follower, feed, state);
        }
        const auto chain =
            make_sample_chain(unit_, period_ns, has_magnetometer(recording_.samples));
        return play(recording_.samples, *chain, follower, feed, state);
    }

    template <class Record>
    bool play(const std::vector<Record>& records, Chain<Record>& chain, CurveFollower& follower,
              UnitFeed& feed, UnitState& state) {
        const std::int64_t began_ns = port::now_ns();
        live_.reset();
        for (const Record& record : records) {
            const auto since =
                static_cast<double>(record.t_ns - records.front().t_ns) / unit_.speed;
            const std::int64_t due_ns = began_ns + static_cast<std::int64_t>(since);
            if (!sleep_until(due_ns)) return false;
            state.arrival_ns = std::max(due_ns, state.arrival_ns);
            if constexpr (std::is_same_v<Record, Sample>) {
                calibration_.push(record);
                state.calibration = calibration_.state();
            }
            const Bytes bytes = chain.push(record);
            follower.take(bytes.data, bytes.size);
            state.samples += 1;
            state.sample_faults = chain.faults();
            const auto pose = chain.pose();
            if (!pose) continue;
            live_.show(*pose, state);
            state.t_ns = state.arrival_ns;
            if (unit_.speed == 1) state.clock_error_ns = static_cast<std::uint32_t>(port::us);
            publish(feed, state);
        }
        for (Bytes bytes; bytes.status != Status::end;) {
            bytes = chain.flush();
            follower.take(bytes.data, bytes.size);
        }
        follower.finish();
        return true;
    }

    UnitConfig unit_;
    sim::Recording recording_;
    LivePose live_;
    CalibrationWatch calibration_;
};

}  // namespace

std::unique_ptr<Source> make_replay(const UnitConfig& unit) {
    return std::make_unique<Replay>(unit);
}

}  // namespace fairlead::gateway
