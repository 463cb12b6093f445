#include "examples/gateway/chain.hpp"

#include "fairlead/imu_pipeline.hpp"
#include "fairlead/pipeline.hpp"

namespace fairlead::gateway {
namespace {

struct ChainConfig : PipelineConfig {
    static constexpr std::size_t window = 120;
};

EncoderParams encoder_params(const UnitConfig& unit, std::uint32_t tick_ns) {
    EncoderParams params;
    params.tol_position_m.fill(static_cast<float>(unit.tolerance_m));
    params.tol_orientation_rad = static_cast<float>(unit.tolerance_deg * 0.017453292519943295);
    params.tick_ns = tick_ns;
    return params;
}

template <class Record, class Inner>
class ChainOf final : public Chain<Record> {
  public:
    explicit ChainOf(const typename Inner::Params& params) : inner_{params} {}
    Bytes push(const Record& record) noexcept override { return inner_.push(record); }
    Bytes idle() noexcept override { return inner_.idle(); }
    Bytes flush() noexcept override { return inner_.flush(); }
    bool push_event(const Event& event) noexcept override { return inner_.push_event(event); }
    std::optional<Pose> pose() const noexcept override {
        if constexpr (std::is_same_v<Record, Pose>)
            return inner_.filtered();
        else
            return inner_.pose();
    }
    std::uint32_t faults() const noexcept override {
        return static_cast<std::uint32_t>(inner_.intake().faults().total());
    }

  private:
    Inner inner_;
};

template <AttitudeMode mode>
std::unique_ptr<Chain<Sample>> sample_chain(const UnitConfig& unit, std::uint32_t tick_ns) {
    using Inner = ImuPipeline<ChainConfig, mode>;
    typename Inner::Params params;
    params.calibration = unit.calibration;
    params.attitude.bias_max_rad_s = static_cast<float>(unit.bias_max_rad_s);
    params.motion.encoder = encoder_params(unit, tick_ns);
    return std::make_unique<ChainOf<Sample, Inner>>(params);
}

}  // namespace

std::unique_ptr<Chain<Pose>> make_pose_chain(const UnitConfig& unit, std::uint32_t tick_ns) {
    using Inner = Pipeline<ChainConfig>;
    Inner::Params params;
    params.encoder = encoder_params(unit, tick_ns);
    return std::make_unique<ChainOf<Pose, Inner>>(params);
}

std::unique_ptr<Chain<Sample>> make_sample_chain(const UnitConfig& unit, std::uint32_t tick_ns,
                                                 bool magnetometer) {
    return magnetometer ? sample_chain<AttitudeMode::imu_mag>(unit, tick_ns)
                        : sample_chain<AttitudeMode::imu>(unit, tick_ns);
}

}  // namespace fairlead::gateway
