#pragma once
// Stages whose whole error is rounding: the same in double.
#include <cmath>

#include "fairlead/math/bspline.hpp"
#include "fairlead/math/orientation_spline.hpp"
#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/calibrate.hpp"
#include "tests/target/errors/streams.hpp"

namespace approx_stage {
#include "tests/target/subjects/approx.hpp"
}
namespace bspline_stage {
#include "tests/target/subjects/bspline.hpp"
}
namespace bspline_orientation_stage {
#include "tests/target/subjects/bspline_orientation.hpp"
}
namespace calibrator_stage {
#include "tests/target/subjects/calibrator.hpp"
}

namespace fairlead::target {

inline BasicVec3<double> widened(const Vec3& v) { return {double{v.x}, double{v.y}, double{v.z}}; }
inline BasicQuat<double> widened(const Quat& q) {
    return {double{q.w}, double{q.x}, double{q.y}, double{q.z}};
}
inline ref::V of(const BasicVec3<double>& v) { return {v.x, v.y, v.z}; }
inline ref::Q of(const BasicQuat<double>& q) { return ref::unit({q.w, q.x, q.y, q.z}); }
/// Of the size where that is more than 1.
inline double relative(double value, double truth) {
    return std::fabs(value - truth) / std::fmax(1, std::fabs(truth));
}

/// Against the C library, relative above 1; exp(9) is as far as a float's argument is exact enough.
inline Largest approx_error(const std::vector<Records>& streams) {
    Largest error;
    for (const Records& records : streams)
        for (const Record& record : records) {
            const double x = double{record.pose.p_w_m.x}, y = double{record.pose.p_w_m.y};
            const auto out = *approx_stage::Subject{}.push(record);
            const auto see = [&](std::size_t i, double truth) {
                if (std::isfinite(truth)) error.number(relative(double{out[i]}, truth));
            };
            see(0, std::sin(x));
            see(1, std::cos(x));
            see(2, std::atan2(y, x));
            see(3, std::asin(x));
            see(4, std::acos(y));
            if (x < 9) see(5, std::exp(x));
            see(6, std::log(y));
            see(7, std::sqrt(std::fabs(x)));
        }
    return error;
}

inline Largest quat_error(const std::vector<Records>& streams) {
    Largest error;
    for (const Records& records : streams)
        for (std::size_t i = 1; i < records.size(); ++i) {
            const Quat a = records[i - 1].pose.q_wb, b = records[i].pose.q_wb;
            const Vec3 v = log(conj(a) * b), turned = rotate(b, Vec3{1, 2, 2});
            const auto a2 = widened(a), b2 = widened(b);
            const auto v2 = log(conj(a2) * b2), turned2 = rotate(b2, {1, 2, 2});
            error.number(norm(ref::of(v) - of(v2)));
            error.number(norm(ref::of(turned) - of(turned2)) / 3);
            error.orientation(exp(v), of(exp(widened(v))));
            error.orientation(slerp(a, b, 0.25f), of(slerp(a2, b2, 0.25)));
        }
    return error;
}

inline Largest bspline_error(const std::vector<Records>& streams) {
    Largest error;
    for (const Records& records : streams) {
        bspline_stage::Curve<float> curve;
        bspline_stage::Curve<double> exact;
        for (const Record& record : records) {
            const auto p = curve.push(record.pose)[0];
            const auto truth = exact.push(record.pose)[0];
            error.position({p[0], p[1], p[2]}, {truth[0], truth[1], truth[2]});
        }
    }
    return error;
}

inline Largest bspline_orientation_error(const std::vector<Records>& streams) {
    Largest error;
    for (const Records& records : streams) {
        bspline_orientation_stage::Curve<float> curve;
        bspline_orientation_stage::Curve<double> exact;
        for (const Record& record : records)
            error.orientation(curve.push(record.pose).q, of(exact.push(record.pose).q));
    }
    return error;
}

inline Largest calibrator_error(const std::vector<Records>& streams) {
    Largest error;
    const Calibration c = calibrator_stage::Subject::example();
    const auto corrected = [&c](const Affine& affine, const BasicVec3<double>& reading) {
        const auto& m = affine.matrix;
        const BasicMat3<double> exact{widened(m.x), widened(m.y), widened(m.z)};
        return of(rotate(widened(c.q_bs), exact * (reading - widened(affine.offset))));
    };
    for (const Records& records : streams)
        for (const Record& record : records) {
            const Sample& s = record.sample;
            const Sample out = *calibrator_stage::Subject{}.push(record);
            const auto see = [&error](const Vec3& v, const ref::V& truth) {
                error.number(norm(ref::of(v) - truth) / std::fmax(1, norm(truth)));
            };
            const auto drift = 6.5 * widened(c.gyro_offset_per_K);
            see(out.gyro_rad_s, corrected(c.gyro, widened(s.gyro_rad_s) - drift));
            see(out.accel_m_s2, corrected(c.accel, widened(s.accel_m_s2)));
            see(out.mag_uT, corrected(c.mag, widened(s.mag_uT)));
        }
    return error;
}

template <AttitudeMode mode>
Largest attitude_error(const std::vector<Records>& streams) {
    Largest error;
    for (const Records& records : streams) {
        BasicAttitude<float, mode> attitude;
        BasicAttitude<double, mode> exact;
        for (const Record& record : records) {
            const auto out = attitude.push(record.sample), truth = exact.push(record.sample);
            if (out && truth) error.orientation(out->q_wb, ref::unit(ref::of(truth->q_wb)));
        }
    }
    return error;
}

}  // namespace fairlead::target
