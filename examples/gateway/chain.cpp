#include "examples/gateway/chain.hpp"

#include "fairlead/pipeline.hpp"

namespace fairlead::gateway {
namespace {

template <class AnyInput, class... Channel>
struct Board {
    using Input = AnyInput;
    using Channels = fairlead::Channels<Channel...>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::medium;
    static constexpr std::size_t events_max = 6;
};

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

template <class Params>
Params params_of(const UnitConfig& unit, std::int64_t period_ns) {
    Params params;
    const bool usable = period_ns >= sample_period_min_ns && period_ns <= sample_period_max_ns;
    params.sample_period_ns = usable ? period_ns : 0;
    params.tolerance.orientation_rad =
        static_cast<float>(unit.tolerance_deg * 0.017453292519943295);
    return params;
}

template <AttitudeMode mode>
std::unique_ptr<Chain<Sample>> sample_chain(const UnitConfig& unit, std::int64_t period_ns) {
    using Inner = Pipeline<Board<Imu<mode>, Orientation>>;
    auto params = params_of<typename Inner::Params>(unit, period_ns);
    params.calibration = unit.calibration;
    params.attitude.bias_max_rad_s = static_cast<float>(unit.bias_max_rad_s);
    return std::make_unique<ChainOf<Sample, Inner>>(params);
}

}  // namespace

std::unique_ptr<Chain<Pose>> make_pose_chain(const UnitConfig& unit, std::int64_t period_ns) {
    using Inner = Pipeline<Board<Pose, Position, Orientation>>;
    auto params = params_of<Inner::Params>(unit, period_ns);
    params.tolerance.position_m = static_cast<float>(unit.tolerance_m);
    return std::make_unique<ChainOf<Pose, Inner>>(params);
}

std::unique_ptr<Chain<Sample>> make_sample_chain(const UnitConfig& unit, std::int64_t period_ns,
                                                 bool magnetometer) {
    return magnetometer ? sample_chain<AttitudeMode::imu_mag>(unit, period_ns)
                        : sample_chain<AttitudeMode::imu>(unit, period_ns);
}

}  // namespace fairlead::gateway
