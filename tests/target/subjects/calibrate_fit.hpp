#pragma once
// The three fits that run while a user calibrates a board: a reading into each per push, all
// results at the end.
#include "fairlead/sense/calibrate_accel.hpp"
#include "fairlead/sense/calibrate_gyro.hpp"
#include "fairlead/sense/calibrate_mag.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text =
        "GyroBiasFit, AccelFit, MagFit: a reading each; flush: results";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = true;
    static constexpr bool takes_anything = false;
    struct Output {
        fairlead::GyroBias gyro;
        fairlead::AccelCalibration accel;
        fairlead::MagCalibration mag;
        fairlead::Status status[3];
    };
    fairlead::GyroBiasFit gyro{};
    fairlead::AccelFit accel{};
    fairlead::MagFit mag{};
    bool finished{false};

    std::optional<Output> push(const fairlead::target::Record& in) {
        gyro.push(in.sample.gyro_rad_s, 1.0f / 120);
        accel.push(in.sample.accel_m_s2);
        mag.push(in.sample.mag_uT);
        return std::nullopt;
    }
    std::optional<Output> flush() {
        if (finished) return std::nullopt;
        finished = true;
        const auto g = gyro.result();
        const auto a = accel.result();
        const auto m = mag.result();
        Output out{{}, {}, {}, {g.status(), a.status(), m.status()}};
        if (g) out.gyro = *g;
        if (a) out.accel = *a;
        if (m) out.mag = *m;
        return out;
    }
};

inline void mix(fairlead::target::Digest& d, const fairlead::Affine& affine) {
    fairlead::target::mix(d, affine.offset);
    fairlead::target::mix(d, affine(fairlead::Vec3{1, -2, 3}));
}
inline void mix(fairlead::target::Digest& d, const Subject::Output& out) {
    using fairlead::target::mix;
    mix(d, out.gyro.bias_rad_s);
    mix(d, out.gyro.random_walk);
    mix(d, out.gyro.uncertainty);
    ::mix(d, out.accel.correction);
    mix(d, out.accel.residual_m_s2);
    ::mix(d, out.mag.correction);
    mix(d, out.mag.residual);
    for (const fairlead::Status s : out.status) mix(d, static_cast<std::uint32_t>(s));
}
