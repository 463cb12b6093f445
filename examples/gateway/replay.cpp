// A recording as a source: its poses through the pipeline, in real time or faster, then through the
// decoder into the unit's feed, as if a board had sent them.
#include <algorithm>
#include <memory>

#include "examples/gateway/follower.hpp"
#include "examples/gateway/source.hpp"
#include "fairlead/pipeline.hpp"
#include "host_sim/stream.hpp"
#include "port/linux/clock.hpp"

namespace fairlead::gateway {
namespace {

namespace status_bit = port::registers::status_bit;

struct ReplayPipeline : PipelineConfig {
    static constexpr std::size_t window = 120;
};

/// The grid of knots: no coarser than the closest two records.
std::uint32_t tick_of(const std::vector<Pose>& poses) {
    std::int64_t closest = 4 * port::ms;
    for (std::size_t i = 1; i < poses.size(); ++i) {
        const std::int64_t step = poses[i].t_ns - poses[i - 1].t_ns;
        if (step > 0) closest = std::min(closest, step);
    }
    return static_cast<std::uint32_t>(std::max(closest, 100 * port::us));
}

class Replay : public Source {
  public:
    explicit Replay(const UnitConfig& unit)
        : unit_{unit}, recording_{sim::read_recording(unit.file)} {
        if (sim::poses_of(recording_).empty()) throw sim::BadData{unit.file + ": holds no poses"};
        params_.encoder.tol_position_m.fill(static_cast<float>(unit.tolerance_m));
        params_.encoder.tol_orientation_rad =
            static_cast<float>(unit.tolerance_deg * 0.017453292519943295);
        params_.encoder.tick_ns = tick_of(recording_.poses);
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
    using Chain = Pipeline<ReplayPipeline>;

    /// @return false when stopped before the end.
    bool play(CurveFollower& follower, UnitFeed& feed, UnitState& state) {
        const auto chain = std::make_unique<Chain>(params_);
        const std::vector<Pose>& poses = recording_.poses;
        const std::int64_t began_ns = port::now_ns();
        before_ = {};
        for (const Pose& pose : poses) {
            const auto since = static_cast<double>(pose.t_ns - poses.front().t_ns) / unit_.speed;
            const std::int64_t due_ns = began_ns + static_cast<std::int64_t>(since);
            if (!sleep_until(due_ns)) return false;
            state.arrival_ns = std::max(due_ns, state.arrival_ns);
            const Bytes bytes = chain->push(pose);
            follower.take(bytes.data, bytes.size);
            state.samples += 1;
            state.sample_faults = static_cast<std::uint32_t>(chain->intake().faults().total());
            if (!chain->filtered()) continue;
            show(*chain->filtered(), state);
            publish(feed, state);
        }
        for (Bytes bytes = chain->flush(); !bytes.empty(); bytes = chain->flush()) {
            follower.take(bytes.data, bytes.size);
        }
        return true;
    }

    /// The live pose is the newest filtered record itself, ahead of the curve by the reducer's
    /// delay; its rates are differences to the record before.
    void show(const Pose& pose, UnitState& state) {
        const bool position = (pose.flags & flag::position_valid) != 0;
        const bool orientation = (pose.flags & flag::orientation_valid) != 0;
        constexpr unsigned validity = status_bit::valid_orientation | status_bit::valid_position;
        state.status = static_cast<std::uint16_t>(state.status & ~validity);
        if (position) state.status |= status_bit::valid_position;
        if (orientation) state.status |= status_bit::valid_orientation;
        const float per_second = 1e9f / static_cast<float>(pose.t_ns - before_.t_ns);
        if (position) {
            state.p_w_m = pose.p_w_m;
            state.v_w_m_s = per_second * (pose.p_w_m - before_.p_w_m);
        }
        if (orientation) {
            state.q_wb = pose.q_wb;
            state.rate_rad_s = per_second * rotation_vector(conj(before_.q_wb) * pose.q_wb);
        }
        if ((before_.flags & pose.flags & flag::position_valid) == 0) state.v_w_m_s = {};
        if ((before_.flags & pose.flags & flag::orientation_valid) == 0) state.rate_rad_s = {};
        before_ = pose;
        state.source_ns = pose.t_ns;
        state.t_ns = state.arrival_ns;
        if (unit_.speed == 1) state.clock_error_ns = static_cast<std::uint32_t>(port::us);
    }

    UnitConfig unit_;
    sim::Recording recording_;
    Chain::Params params_{};
    Pose before_{};
};

}  // namespace

std::unique_ptr<Source> make_replay(const UnitConfig& unit) {
    return std::make_unique<Replay>(unit);
}

}  // namespace fairlead::gateway
