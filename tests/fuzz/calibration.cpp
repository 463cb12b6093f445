// The fits that find a calibration on the board, with any readings. Held: a fit that answers gives
// finite numbers within its own bounds, and the calibration made of them gives finite samples.
#include "fairlead/sense/calibrate.hpp"

#include "fairlead/sense/calibrate_accel.hpp"
#include "fairlead/sense/calibrate_gyro.hpp"
#include "fairlead/sense/calibrate_mag.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace fairlead;
using fuzz::Input;

bool finite(const Vec3& v) { return is_finite(v); }
bool finite(const Mat3& m) { return finite(m.x) && finite(m.y) && finite(m.z); }

/// Calls body as often as the input says, on readings near one another.
template <class Body>
void readings(Input& in, float usual, Body body) {
    while (!in.empty()) {
        Vec3 v = in.vector(usual);
        const float step = in.number(0.01f);
        for (std::size_t n = 1 + in.below(64); n > 0; --n) {
            body(v);
            v.x += step;
        }
    }
}

void accel(Input& in) {
    AccelFit fit{in.flag() ? 9.80665f : in.number(20)};
    readings(in, 12, [&fit](const Vec3& v) { static_cast<void>(fit.push(v)); });
    const auto result = fit.result();
    if (result) FUZZ_EXPECT(finite(result->correction.offset) && finite(result->correction.matrix));
}

void bias(Input& in) {
    GyroBiasFit fit;
    const float dt = in.number(0.1f);
    readings(in, 0.1f, [&](const Vec3& v) { fit.push(v, dt); });
    const auto result = fit.result();
    if (result) FUZZ_EXPECT(finite(result->bias_rad_s));
}

void drift(Input& in) {
    GyroTemperatureFit fit;
    while (!in.empty()) fit.push(in.vector(0.1f), in.number(100));
    const auto result = fit.result();
    if (result)
        FUZZ_EXPECT(finite(result->per_K) && finite(result->bias_rad_s) &&
                    approx::is_finite(result->temperature_C) &&
                    approx::is_finite(result->residual_rad_s));
}

void turn(Input& in) {
    GyroTurnFit fit;
    const float dt = in.number(0.1f), angle = in.number(7);
    const std::size_t axis = in.below(4);
    readings(in, 3, [&](const Vec3& v) { fit.push(v, dt); });
    if (axis > 2) return;
    const auto result = fit.result(axis, angle);
    if (result) FUZZ_EXPECT(approx::is_finite(result->factor));
}

void mag(Input& in) {
    MagFit fit;
    readings(in, 60, [&fit](const Vec3& v) { fit.push(v); });
    const auto result = fit.result();
    if (!result) return;
    FUZZ_EXPECT(finite(result->correction.offset) && finite(result->correction.matrix));
    FUZZ_EXPECT(result->radius_uT > 0 && approx::is_finite(result->radius_uT));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input in{data, size};
    switch (in.byte() % 5) {
        case 0: accel(in); break;
        case 1: bias(in); break;
        case 2: drift(in); break;
        case 3: turn(in); break;
        default: mag(in); break;
    }
    return 0;
}
