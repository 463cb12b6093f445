#include "host_sim/recording/writers.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "host_sim/recording/binary.hpp"
#include "host_sim/recording/bytes.hpp"
#include "host_sim/recording/imu2.hpp"
#include "host_sim/recording/spec.hpp"

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
    const auto bits = static_cast<unsigned long long>(t_ns);
    const unsigned long long magnitude = t_ns < 0 ? 0 - bits : bits;
    append(out, "%s%llu.%09llu", t_ns < 0 ? "-" : "", magnitude / 1000000000u,
           magnitude % 1000000000u);
}

void store_header(std::string& out, const char* magic, std::size_t count,
                  std::uint32_t record_size) {
    out.append(magic, 4);
    store(out, std::uint32_t{1});
    store(out, static_cast<std::uint32_t>(count));
    store(out, record_size);
}

bool valid(const Pose& pose, std::uint32_t channel) { return (pose.flags & channel) != 0; }

std::uint32_t microseconds(std::int64_t t_ns) {
    if (t_ns % 1000 != 0) throw BadData("a time that is not a whole microsecond");
    return static_cast<std::uint32_t>(t_ns / 1000);  // wraps, as the chips' counters do
}

}  // namespace

std::string to_poses_csv(const std::vector<Pose>& poses, const Steps& progress) {
    std::string out = "t_ns,px,py,pz,qw,qx,qy,qz\n";
    for (const Pose& pose : poses) {
        if (progress) progress(static_cast<std::size_t>(&pose - poses.data()), poses.size());
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

std::string to_tum(const std::vector<Pose>& poses, const Steps& progress) {
    std::uint32_t present = 0;
    for (const Pose& pose : poses)
        present |= pose.flags & (flag::position_valid | flag::orientation_valid);
    std::string out = "# t tx ty tz qx qy qz qw\n";
    for (const Pose& pose : poses) {
        if (progress) progress(static_cast<std::size_t>(&pose - poses.data()), poses.size());
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

std::string imu_csv_header(std::uint32_t fields, bool moving) {
    std::string out = "t_ns";
    const auto add = [&](std::uint32_t field, const char* names) {
        if ((fields & field) != 0) out += names;
    };
    add(imu_field::gyro, ",gx [rad/s],gy [rad/s],gz [rad/s]");
    add(imu_field::accel, ",ax [m/s^2],ay [m/s^2],az [m/s^2]");
    add(imu_field::mag, ",mx [uT],my [uT],mz [uT]");
    add(imu_field::temperature, ",temperature [degC]");
    out += ",clipped,gap";
    add(imu_field::reference_orientation, ",ref_qw,ref_qx,ref_qy,ref_qz");
    add(imu_field::reference_position, ",ref_px [m],ref_py [m],ref_pz [m]");
    return out + (moving ? ",moving\n" : "\n");
}

void append_imu_csv(std::string& out, std::uint32_t fields, const Sample& s, const Pose& reference,
                    const bool* moving) {
    append(out, "%lld", static_cast<long long>(s.t_ns));
    const auto vector = [&](std::uint32_t field, bool is_valid, const Vec3& v) {
        if ((fields & field) == 0) return;
        if (is_valid)
            append(out, ",%.9g,%.9g,%.9g", d(v.x), d(v.y), d(v.z));
        else
            out += ",,,";
    };
    const auto has = [&](std::uint32_t bits) { return (s.flags & bits) != 0; };
    vector(imu_field::gyro, has(flag::gyro_valid), s.gyro_rad_s);
    vector(imu_field::accel, has(flag::accel_valid), s.accel_m_s2);
    vector(imu_field::mag, has(flag::mag_valid), s.mag_uT);
    if ((fields & imu_field::temperature) != 0) {
        out += ',';
        if (has(flag::temperature_valid)) append(out, "%.9g", d(s.temperature_c));
    }
    out += ',';
    if (has(flag::gyro_clipped)) out += 'g';
    if (has(flag::accel_clipped)) out += 'a';
    if (has(flag::mag_clipped)) out += 'm';
    out += has(flag::gap_before) ? ",1" : ",0";
    if ((fields & imu_field::reference_orientation) != 0) {
        const Quat& q = reference.q_wb;
        if (valid(reference, flag::orientation_valid))
            append(out, ",%.9g,%.9g,%.9g,%.9g", d(q.w), d(q.x), d(q.y), d(q.z));
        else
            out += ",,,,";
    }
    vector(imu_field::reference_position, valid(reference, flag::position_valid), reference.p_w_m);
    if (moving != nullptr) out += *moving ? ",1" : ",0";
    out += '\n';
}

std::string to_imu_csv(const Recording& recording, const Steps& progress) {
    const std::uint32_t fields = imu_fields(recording);
    const bool has_moving = std::any_of(recording.moving.begin(), recording.moving.end(),
                                        [](std::uint8_t m) { return m != 0; });
    std::string out = imu_csv_header(fields, has_moving);
    for (std::size_t i = 0; i < recording.samples.size(); ++i) {
        if (progress) progress(i, recording.samples.size());
        const bool moving = i < recording.moving.size() && recording.moving[i] != 0;
        append_imu_csv(out, fields, recording.samples[i],
                       i < recording.truth.size() ? recording.truth[i] : Pose{},
                       has_moving ? &moving : nullptr);
    }
    return out;
}

namespace {

/// Why version 1 of .imu cannot hold the recording; empty: it can.
std::string beyond_version1(const Recording& recording) {
    constexpr std::uint32_t sensors = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    if (!recording.events.empty()) return "events";
    if (recording.frame == ReferenceFrame::level) return "a reference without a north";
    for (std::size_t i = 0; i < recording.samples.size(); ++i) {
        const Sample& s = recording.samples[i];
        if ((s.flags & sensors) != sensors) return "records without one of the sensors";
        if ((s.flags & ~sensors) != 0) return "temperatures, gaps or clipped readings";
        if (s.t_ns % 1000 != 0) return "times finer than a microsecond";
        if (i == 0) continue;
        const std::int64_t step = s.t_ns - recording.samples[i - 1].t_ns;
        constexpr std::int64_t us = 1000, back = us * backward_most_us;
        if (step >= us * (std::int64_t{1} << 32) - back || step < -back) return "a long pause";
    }
    return {};
}

std::string to_imu1(const Recording& recording) {
    std::string out;
    store_header(out, "IMR1", recording.samples.size(), 72);
    store(out, static_cast<std::uint32_t>(recording.period_s * 1e6 + 0.5));
    store(out, std::uint32_t{0});
    store_name(out, recording.name, 40);
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

}  // namespace

std::string to_imu(const Recording& recording, int version) {
    const std::string beyond = beyond_version1(recording);
    if (version == 1 && !beyond.empty())
        throw BadData("version 1 of .imu cannot hold " + beyond + "; version 2 can");
    return version == 2 || !beyond.empty() ? to_imu2(recording) : to_imu1(recording);
}

std::string to_trk(const Recording& recording) {
    std::string out;
    store_header(out, "TRK1", recording.poses.size(), 36);
    store(out, recording.period_s);
    store_name(out, recording.name, 40);
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

std::string to_file(const Recording& recording, const std::string& path, const Steps& progress) {
    const std::size_t dot = path.find_last_of('.');
    const std::string extension = dot == std::string::npos ? "" : path.substr(dot);
    const bool imu = !recording.samples.empty();
    if (extension == ".imu" && imu) return to_imu(recording);
    if (extension == ".trk" && !imu) return to_trk(recording);
    if (extension == ".tum" && !imu) return to_tum(recording.poses, progress);
    if (extension == ".csv")
        return imu ? to_imu_csv(recording, progress) : to_poses_csv(recording.poses, progress);
    throw BadSpec(path + ": " + (imu ? "IMU samples are" : "poses are") + " written as " +
                  (imu ? ".imu or .csv" : ".trk, .tum or .csv"));
}

std::string left_out(const Recording& recording, const std::string& path) {
    const auto ends = [&](const char* end) {
        const std::string e = end;
        return path.size() >= e.size() && path.compare(path.size() - e.size(), e.size(), e) == 0;
    };
    std::string out;
    const auto add = [&](std::size_t n, const char* what) {
        if (n > 0) out += (out.empty() ? "" : ", ") + std::to_string(n) + " " + what;
    };
    if (!ends(".imu")) add(recording.events.size(), "events (write them by --events FILE)");
    if (ends(".tum")) {
        std::uint32_t present = 0;
        for (const Pose& p : recording.poses) present |= p.flags & 3u;
        std::size_t missing = 0;
        for (const Pose& p : recording.poses) missing += (p.flags & present) != present ? 1 : 0;
        add(missing, "records in which a channel has no measurement");
    }
    return out;
}

}  // namespace fairlead::sim
