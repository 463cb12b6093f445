// The attitude filter behind its intake, in each mode, float and double, with any samples. Held:
// orientations are finite and unit, rates and sigmas are finite, no variance is negative.
#include "fairlead/sense/attitude.hpp"

#include "fairlead/sense/attitude_gyro.hpp"
#include "fairlead/sense/intake.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace fairlead;
using fuzz::Input;

template <class Real>
bool finite(const BasicVec3<Real>& v) {
    return approx::is_finite(v.x) && approx::is_finite(v.y) && approx::is_finite(v.z);
}

template <class Real, AttitudeMode mode>
void run(Input& in) {
    using Filter = BasicAttitude<Real, mode>;
    Intake<Sample> intake;
    Filter attitude;
    std::int64_t t = 0;
    const std::int64_t period = std::int64_t{1'000'000} << in.below(8);
    // mostly short, so that there are many; now and then long enough for all that takes time
    std::size_t left = in.byte() % 32 == 0 ? 6000 : 400;
    while (!in.empty() && left > 0) {
        Sample next = fuzz::sample(in);
        // a sample once drawn may stay for a while: estimators need time to go wrong
        std::size_t repeat = in.flag() ? 1 + in.below(64) : 1;
        for (; repeat > 0 && left > 0; --repeat, --left) {
            next.t_ns = t;
            t = in.time_after(t, period);
            const auto accepted = intake.push(next);
            if (!accepted) continue;
            const auto pose = attitude.push(*accepted);
            const auto q = attitude.state().q_wb;
            const Real n = dot(q, q);
            FUZZ_EXPECT(n > Real(0.999) && n < Real(1.001));
            FUZZ_EXPECT(finite(attitude.rate_rad_s()));
            FUZZ_EXPECT(finite(attitude.bias_rad_s()));
            if (pose) {
                const float m = dot(pose->q_wb, pose->q_wb);
                FUZZ_EXPECT(m > 0.999f && m < 1.001f);
                FUZZ_EXPECT(pose->t_ns == accepted->t_ns);
            }
            if constexpr (mode != AttitudeMode::gyro) {
                const auto& s = attitude.state();
                for (std::size_t i = 0; i < s.size; ++i) {
                    FUZZ_EXPECT(approx::is_finite(s.covariance(i, i)));
                    FUZZ_EXPECT(s.covariance(i, i) >= 0);
                }
                FUZZ_EXPECT(approx::is_finite(attitude.inclination_sigma()));
                if constexpr (mode == AttitudeMode::imu_mag)
                    FUZZ_EXPECT(approx::is_finite(attitude.heading_sigma()));
            }
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size > 2000) return 0;
    Input in{data, size};
    switch (in.byte() % 4) {
        case 0: run<float, AttitudeMode::gyro>(in); break;
        case 1: run<float, AttitudeMode::imu>(in); break;
        case 2: run<double, AttitudeMode::imu_mag>(in); break;
        default: run<float, AttitudeMode::imu_mag>(in); break;
    }
    return 0;
}
