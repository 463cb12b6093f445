#include "host_sim/writers.hpp"

#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "host_sim/spec.hpp"

namespace fairlead::sim {
namespace {

[[gnu::format(printf, 2, 3)]] void append(std::string& out, const char* format, ...) {
    char line[256];
    std::va_list arguments;
    va_start(arguments, format);
    const int n = std::vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (n > 0) out.append(line, std::min(static_cast<std::size_t>(n), sizeof line - 1));
}

double d(float x) { return static_cast<double>(x); }

void append_seconds(std::string& out, std::int64_t t_ns) {  // 9 decimals, exact
    const auto magnitude = static_cast<unsigned long long>(t_ns < 0 ? -t_ns : t_ns);
    append(out, "%s%llu.%09llu", t_ns < 0 ? "-" : "", magnitude / 1000000000u,
           magnitude % 1000000000u);
}

template <class T>
void store(std::string& out, const T& value) {  // the host is little endian, like the file
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof bytes);
}

void store(std::string& out, const Vec3& v) {
    for (const float x : {v.x, v.y, v.z}) store(out, x);
}

void store(std::string& out, const Quat& q) {
    for (const float x : {q.w, q.x, q.y, q.z}) store(out, x);
}

void store_header(std::string& out, const char* magic, std::size_t count,
                  std::uint32_t record_size) {
    out.append(magic, 4);
    store(out, std::uint32_t{1});
    store(out, static_cast<std::uint32_t>(count));
    store(out, record_size);
}

void store_name(std::string& out, std::string name) {
    name.resize(40);
    name.back() = '\0';
    out += name;
}

bool valid(const Pose& pose, std::uint32_t channel) { return (pose.flags & channel) != 0; }

std::uint32_t microseconds(std::int64_t t_ns) {
    if (t_ns % 1000 != 0) throw BadData("a time that is not a whole microsecond");
    return static_cast<std::uint32_t>(t_ns / 1000);  // wraps, as the chips' counters do
}

}  // namespace

std::string to_poses_csv(const std::vector<Pose>& poses) {
    std::string out = "t_ns,px,py,pz,qw,qx,qy,qz\n";
    for (const Pose& pose : poses) {
        append(out, "%lld", static_cast<long long>(pose.t_ns));
        const Vec3& p = pose.p_w_m;
        const Quat& q = pose.q_wb;
        if (valid(pose, flag::position_valid))
            append(out, ",%.9g,%.9g,%.9g", d(p.x), d(p.y), d(p.z));
        else
            out += ",,,";
        if (valid(pose, flag::orientation_valid))
            append(out, ",%.9g,%.9g,%.9g,%.9g\n", d(q.w), d(q.x), d(q.y), d(q.z));
        else
            out += ",,,,\n";
    }
    return out;
}

std::string to_tum(const std::vector<Pose>& poses) {
    std::uint32_t present = 0;
    for (const Pose& pose : poses)
        present |= pose.flags & (flag::position_valid | flag::orientation_valid);
    std::string out = "# t tx ty tz qx qy qz qw\n";
    for (const Pose& pose : poses) {
        if ((pose.flags & present) != present || present == 0) continue;
        const Vec3 p = valid(pose, flag::position_valid) ? pose.p_w_m : Vec3{};
        const Quat q = valid(pose, flag::orientation_valid) ? pose.q_wb : Quat{};
        append_seconds(out, pose.t_ns);
        append(out, " %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n", d(p.x), d(p.y), d(p.z), d(q.x), d(q.y),
               d(q.z), d(q.w));
    }
    return out;
}

std::string to_euroc_imu(const std::vector<Sample>& samples) {
    std::string out =
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
        "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
    for (const Sample& s : samples) {
        const Vec3 &w = s.gyro_rad_s, &a = s.accel_m_s2;
        append(out, "%lld,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", static_cast<long long>(s.t_ns), d(w.x),
               d(w.y), d(w.z), d(a.x), d(a.y), d(a.z));
    }
    return out;
}

std::string to_imu(const Recording& recording) {
    std::string out;
    store_header(out, "IMR1", recording.samples.size(), 72);
    store(out, static_cast<std::uint32_t>(recording.period_s * 1e6 + 0.5));
    store(out, std::uint32_t{0});
    store_name(out, recording.name);
    for (std::size_t i = 0; i < recording.samples.size(); ++i) {
        const Sample& s = recording.samples[i];
        const Pose truth = i < recording.truth.size() ? recording.truth[i] : Pose{};
        const bool has_q = valid(truth, flag::orientation_valid);
        const bool has_p = valid(truth, flag::position_valid);
        const bool moving = i < recording.moving.size() && recording.moving[i] != 0;
        store(out, microseconds(s.t_ns));
        store(out, (moving ? 1u : 0u) | (has_q ? 2u : 0u) | (has_p ? 4u : 0u));
        store(out, s.gyro_rad_s);
        store(out, s.accel_m_s2);
        store(out, s.mag_uT);
        store(out, has_q ? truth.q_wb : Quat{0, 0, 0, 0});
        store(out, has_p ? truth.p_w_m : Vec3{});
    }
    return out;
}

std::string to_trk(const Recording& recording) {
    std::string out;
    store_header(out, "TRK1", recording.poses.size(), 36);
    store(out, recording.period_s);
    store_name(out, recording.name);
    for (const Pose& pose : recording.poses) {
        const bool has_q = valid(pose, flag::orientation_valid);
        const bool has_p = valid(pose, flag::position_valid);
        store(out, microseconds(pose.t_ns));
        store(out, (has_q ? 1u : 0u) | (has_p ? 2u : 0u));
        store(out, has_p ? pose.p_w_m : Vec3{});
        store(out, has_q ? pose.q_wb : Quat{0, 0, 0, 0});
    }
    return out;
}

std::string to_file(const Recording& recording, const std::string& path) {
    const std::size_t dot = path.find_last_of('.');
    const std::string extension = dot == std::string::npos ? "" : path.substr(dot);
    const bool imu = !recording.samples.empty();
    if (extension == ".imu" && imu) return to_imu(recording);
    if (extension == ".trk" && !imu) return to_trk(recording);
    if (extension == ".tum" && !imu) return to_tum(recording.poses);
    if (extension == ".csv")
        return imu ? to_euroc_imu(recording.samples) : to_poses_csv(recording.poses);
    throw BadSpec(path + ": " + (imu ? "IMU samples are" : "poses are") + " written as " +
                  (imu ? ".imu or .csv" : ".trk, .tum or .csv"));
}

}  // namespace fairlead::sim
