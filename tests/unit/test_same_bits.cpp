// Attitude, calibration and filters give the same bits on every machine (same_bits.hpp).
#include "fairlead/sense/attitude_gyro.hpp"
#include "fairlead/sense/attitude_lag.hpp"
#include "fairlead/sense/calibrate_accel.hpp"
#include "fairlead/sense/calibrate_gyro.hpp"
#include "fairlead/sense/calibrate_mag.hpp"
#include "fairlead/sense/intake.hpp"
#include "fairlead/smooth/adaptive.hpp"
#include "fairlead/smooth/cascade.hpp"
#include "fairlead/smooth/fairing_window.hpp"
#include "fairlead/smooth/filter.hpp"
#include "fairlead/smooth/predict.hpp"
#include "fairlead/smooth/strain.hpp"
#include "tests/unit/same_bits.hpp"

namespace fairlead::test {
namespace {

template <class Real, AttitudeMode mode>
void attitude(const Records& records, Digest& digest) {
    Intake<Sample> intake;
    BasicAttitude<Real, mode> filter;
    for (const Record& record : records) {
        const auto sample = intake.push(record.sample);
        if (!sample) continue;
        if (const auto pose = filter.push(*sample)) mix(digest, *pose);
        mix(digest, filter.rate_rad_s());
        mix(digest, filter.bias_rad_s());
        if constexpr (mode != AttitudeMode::gyro) mix(digest, filter.inclination_sigma());
        if constexpr (mode == AttitudeMode::imu_mag) mix(digest, filter.heading_sigma());
    }
}

void lagged(const Records& records, Digest& digest) {
    Intake<Sample> intake;
    LaggedAttitude<60> filter;
    for (const Record& record : records) {
        const auto sample = intake.push(record.sample);
        if (!sample) continue;
        if (const auto pose = filter.push(*sample)) mix(digest, *pose);
    }
}

TEST(SameBits, Attitude) {
    // beside the streams that hurt: rests of a hand's noise, long enough to be found
    const std::string long_rests =
        "long-rests 31 100 noise:900:1:3:1 walk:600:40:3000:8 noise:1500:1:3:1 line:300:20:3000:1 "
        "noise:600:1:3:1 walk:900:30:2500:5 noise:2500:1:3:1";
    Bits bits{"attitude"};
    for (const NamedStream& s : streams({long_rests})) {
        const auto add = [&](const char* stage, void (*run)(const Records&, Digest&)) {
            bits.add(stage, s.name, [&](Digest& digest) { run(s.all, digest); });
        };
        add("gyro", attitude<float, AttitudeMode::gyro>);
        add("imu", attitude<float, AttitudeMode::imu>);
        add("imu_mag", attitude<float, AttitudeMode::imu_mag>);
        add("imu_mag_double", attitude<double, AttitudeMode::imu_mag>);
        add("lagged", lagged);
    }
}

/// What a stage of poses gives, and what is left at the end.
template <class Stage>
void run(Stage stage, const Records& records, Digest& digest) {
    const auto note = [&digest](const auto& pose) {
        if (pose) mix(digest, *pose);
        return pose.has_value();
    };
    for (const Record& record : records) note(stage.push(record.pose));
    for (int i = 0; i < 1000 && note(stage.flush()); ++i) continue;
}

void predict(const Records& records, Digest& digest) {
    AdaptivePoseFilter filter;
    Pose before{};
    for (const Record& record : records) {
        static_cast<void>(filter.push(record.pose));
        const std::int64_t then_ns = record.pose.t_ns + 20'000'000;
        mix(digest, predicted(before, record.pose, then_ns));
        mix(digest, filter.predict(then_ns));
        before = record.pose;
    }
}

TEST(SameBits, Filters) {
    FairingParams bounded;
    bounded.bound_m = 0.002f;
    bounded.bound_rad = 0.0087266f;
    const auto smoothing = *StrainParams::from_cutoff(24, 1.0f / 120, 1);
    Bits bits{"filters"};
    for (const NamedStream& s : streams()) {
        const auto add = [&](const char* stage, const auto& filter) {
            bits.add(stage, s.name, [&](Digest& digest) { run(filter, s.clean, digest); });
        };
        add("binomial", PoseFilter<9, 4>{binomial_mask<9>()});
        add("causal", PoseFilter<9, 8>{causal_savitzky_golay_mask<9, 1>()});
        add("cascade", Cascade<PoseFilter<5>, 4>{PoseFilter<5>{smoothing_mask(1)}});
        add("adaptive", AdaptivePoseFilter{});
        add("fairing_2", FairingWindow<2, 4>{bounded});
        add("fairing_3", FairingWindow<3, 4>{});
        add("strain", StrainSmoother<16>{smoothing});
        bits.add("predict", s.name, [&](Digest& digest) { predict(s.clean, digest); });
    }
}

void mix(Digest& digest, const Affine& affine) {
    mix(digest, affine.offset);
    mix(digest, affine(Vec3{1, -2, 3}));
}

void fits(const Records& records, Digest& digest) {
    GyroBiasFit bias;
    GyroTemperatureFit drift;
    AccelFit accel;
    MagFit mag;
    float temperature = 20;
    for (const Record& record : records) {
        bias.push(record.sample.gyro_rad_s, 1.0f / 120);
        drift.push(record.sample.gyro_rad_s, temperature += 0.1f);
        static_cast<void>(accel.push(record.sample.accel_m_s2));
        mag.push(record.sample.mag_uT);
    }
    const auto b = bias.result();
    const auto d = drift.result();
    const auto a = accel.result();
    const auto m = mag.result();
    for (const Status s : {b.status(), d.status(), a.status(), m.status()})
        mix(digest, static_cast<std::uint32_t>(s));
    if (b) mix(digest, b->bias_rad_s), mix(digest, b->random_walk);
    if (d) mix(digest, d->per_K), mix(digest, d->bias_rad_s), mix(digest, d->residual_rad_s);
    if (a) mix(digest, a->correction), mix(digest, a->residual_m_s2);
    if (m) mix(digest, m->correction), mix(digest, m->residual);
}

TEST(SameBits, Fits) {
    Bits bits{"fits"};
    for (const NamedStream& s : streams())
        bits.add("fits", s.name, [&](Digest& digest) { fits(s.clean, digest); });
}

}  // namespace
}  // namespace fairlead::test
