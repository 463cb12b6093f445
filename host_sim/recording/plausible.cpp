#include "host_sim/recording/plausible.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/recording/evidence.hpp"

namespace fairlead::sim {
namespace {

using Doubts = std::vector<std::string>;

template <class... Arguments>
std::string text(const char* format, Arguments... arguments) {
    char line[320];
    std::snprintf(line, sizeof line, format, arguments...);
    return line;
}

double wide(float v) { return static_cast<double>(v); }

/// A sensor's readings, axis by axis.
std::array<Numbers, 3> readings(const Recording& r, Vec3 Sample::*values, std::uint32_t valid) {
    std::array<Numbers, 3> out;
    for (const Sample& s : r.samples) {
        if ((s.flags & valid) == 0) continue;
        const Vec3& v = s.*values;
        out[0].push_back(wide(v.x));
        out[1].push_back(wide(v.y));
        out[2].push_back(wide(v.z));
    }
    return out;
}

void doubt_rate(const Recording& r, Doubts& out) {
    Numbers times;
    for (std::size_t i = 0; i < r.size(); ++i) times.push_back(static_cast<double>(r.t_ns(i)));
    const double step_s = typical_step(times) * 1e-9;
    if (r.size() > 1 && step_s <= 0)
        out.emplace_back("the times do not go forward; --rate HZ makes times");
    const double rate = step_s > 0 ? 1 / step_s : 0;
    if (rate > 20000)
        out.push_back(
            text("the rate of %.4g Hz is above 20 kHz: are the times in another unit? "
                 "--units t=us or t=ms",
                 rate));
    if (rate > 0 && rate < 0.1)
        out.push_back(
            text("the rate of %.4g Hz is below 0.1 Hz: are the times in another unit? "
                 "--units t=us or t=ms",
                 rate));
}

/// A sensor whose readings are all the same says nothing.
bool doubt_dead(const char* name, const std::array<Numbers, 3>& v, Doubts& out) {
    const auto same = [](const Numbers& n, double value) {
        return std::all_of(n.begin(), n.end(), [&](double x) { return x == value; });
    };
    if (v[0].size() < 10) return false;
    const bool zero = same(v[0], 0) && same(v[1], 0) && same(v[2], 0);
    const bool constant = same(v[0], v[0][0]) && same(v[1], v[1][0]) && same(v[2], v[2][0]);
    if (zero)
        out.push_back(
            text("the %s reads zero in all %zu records: is it there? Leave it out by "
                 "--columns with -, or of .imu by --sensors",
                 name, v[0].size()));
    else if (constant)
        out.push_back(text("the %s reads the same in all %zu records", name, v[0].size()));
    return constant;
}

void doubt_accel(const Recording& r, Doubts& out) {
    const auto v = readings(r, &Sample::accel_m_s2, flag::accel_valid);
    if (v[0].empty() || doubt_dead("accelerometer", v, out)) return;
    const double length = median_length(v[0], v[1], v[2]);
    const auto unit = gravity_unit(length);
    if (unit && unit->name != "m/s2")
        out.push_back(
            text("the accelerometer's median length is %.4g m/s2, which is gravity in "
                 "%s: --units accel=%s",
                 length, unit->name.c_str(), unit->name.c_str()));
    else if (length < 3)
        out.push_back(
            text("the accelerometer's median length is %.4g m/s2: gravity has been taken "
                 "out; take the column or file with gravity",
                 length));
    else if (!unit && (length > 20 || length < 7))
        out.push_back(
            text("the accelerometer's median length is %.4g m/s2, which is not gravity "
                 "in m/s2, g or mg: --units accel=UNIT, or a factor",
                 length));
}

void doubt_gyro(const Recording& r, Doubts& out) {
    const auto v = readings(r, &Sample::gyro_rad_s, flag::gyro_valid);
    if (v[0].empty() || doubt_dead("gyroscope", v, out)) return;
    Numbers lengths;
    for (std::size_t i = 0; i < v[0].size(); ++i)
        lengths.push_back(std::hypot(v[0][i], v[1][i], v[2][i]));
    std::sort(lengths.begin(), lengths.end());
    const double high = lengths[lengths.size() - 1 - lengths.size() / 100];
    if (high > 100)
        out.push_back(
            text("the gyroscope reaches %.4g rad/s: is it in deg/s? --units gyro=deg/s", high));
    const auto a = readings(r, &Sample::accel_m_s2, flag::accel_valid);
    if (!a[0].empty() && !gravity_unit(median_length(a[0], a[1], a[2])) &&
        gravity_unit(median(lengths)))
        out.push_back(
            text("the gyroscope's median length of %.4g has the size of gravity: are "
                 "gyroscope and accelerometer exchanged? --columns settles it",
                 median(lengths)));
}

/// The rate must turn gravity as it is seen to turn.
void doubt_turning(const Recording& r, Doubts& out) {
    std::vector<double> t_s;
    std::vector<Numbers> gyro(3), accel(3);
    for (const Sample& s : r.samples) {
        if ((s.flags & flag::gyro_valid) == 0 || (s.flags & flag::accel_valid) == 0) continue;
        t_s.push_back(static_cast<double>(s.t_ns) * 1e-9);
        const Vec3 &g = s.gyro_rad_s, &a = s.accel_m_s2;
        gyro[0].push_back(wide(g.x)), gyro[1].push_back(wide(g.y)), gyro[2].push_back(wide(g.z));
        accel[0].push_back(wide(a.x)), accel[1].push_back(wide(a.y));
        accel[2].push_back(wide(a.z));
    }
    const auto factor = turning_factor(t_s, gyro, accel);
    if (!factor || (*factor > 0.5 && *factor < 2)) return;
    const bool deg = *factor > 0.0087 && *factor < 0.035;
    out.push_back(text("gravity turns %.3g times as fast as the gyroscope says: %s", *factor,
                       deg ? "it is in deg/s; --units gyro=deg/s"
                           : "is its unit right? --units gyro=UNIT, or a factor"));
}

void doubt_mag(const Recording& r, Doubts& out) {
    const auto v = readings(r, &Sample::mag_uT, flag::mag_valid);
    if (v[0].empty() || doubt_dead("magnetometer", v, out)) return;
    const double length = median_length(v[0], v[1], v[2]);
    const auto unit = field_unit(length);
    if (unit && unit->name != "uT")
        out.push_back(
            text("the magnetometer's median length is %.4g uT, which is the earth's "
                 "field in %s: --units mag=%s",
                 length, unit->name.c_str(), unit->name.c_str()));
}

void doubt_quaternions(const Recording& r, Doubts& out) {
    const std::vector<Pose>& poses = r.samples.empty() ? r.poses : r.truth;
    Numbers w, x, y, z;
    for (const Pose& p : poses) {
        if ((p.flags & flag::orientation_valid) == 0) continue;
        w.push_back(std::fabs(wide(p.q_wb.w)));
        x.push_back(wide(p.q_wb.x)), y.push_back(wide(p.q_wb.y));
        z.push_back(std::fabs(wide(p.q_wb.z)));
    }
    if (w.empty()) return;
    if (!unit_quaternions(w, x, y, z))
        out.emplace_back(
            "the quaternions are not of unit length: are the columns others? "
            "--columns settles it");
    else if (w.size() > 9 && median(w) < 0.2 && median(z) > 0.8)
        out.emplace_back(
            "the quaternions turn by about 180 deg about z throughout: is the scalar the last "
            "column where it is read as the first, or the other way round? --columns ...,qx,qy,"
            "qz,qw or ...,qw,qx,qy,qz");
}

}  // namespace

std::vector<std::string> doubts(const Recording& recording, const Steps& progress) {
    constexpr std::array checks{doubt_rate,    doubt_accel, doubt_gyro,
                                doubt_turning, doubt_mag,   doubt_quaternions};
    Doubts out;
    for (std::size_t i = 0; i < checks.size(); ++i) {
        if (progress) progress(i, checks.size());
        checks[i](recording, out);
    }
    return out;
}

}  // namespace fairlead::sim
