#include "host_sim/recording/binary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/recording/bytes.hpp"
#include "host_sim/recording/imu2.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

constexpr std::size_t header_size = 64;
constexpr std::size_t name_offset = 24, name_size = 40;

struct Header {
    std::uint32_t record_count{};
    std::size_t record_size{};
};

Header parse_header(std::string_view bytes, bool imu, Recording& recording) {
    if (bytes.size() < header_size) refuse_at(bytes.size(), "the header of 64 bytes is cut");
    const Header header{load<std::uint32_t>(bytes, 8), imu ? 72u : 36u};
    if (load<std::uint32_t>(bytes, 12) != header.record_size)
        refuse_at(12, "records of " + std::to_string(load<std::uint32_t>(bytes, 12)) +
                          " bytes, expected " + std::to_string(header.record_size));
    const double period_s = imu ? 1e-6 * load<std::uint32_t>(bytes, 16) : load<double>(bytes, 16);
    if (!std::isfinite(period_s) || period_s < 0) refuse_at(16, "the period is not a time");
    recording.format = imu ? Format::imu : Format::trk;
    recording.period_s = period_s;
    const std::string_view name = bytes.substr(name_offset, name_size);
    if (const auto end = name.find('\0'); end != 0) recording.name = name.substr(0, end);
    return header;
}

/// Microseconds of 32 bits wrap after 71.6 minutes.
class Clock {
  public:
    std::int64_t unwrap_ns(std::uint32_t t_us) {
        const std::uint32_t forward = t_us - static_cast<std::uint32_t>(t_us_);
        const std::uint32_t backward = 0u - forward;
        if (first_)
            t_us_ = t_us;
        else if (backward <= backward_most_us)
            t_us_ -= backward;
        else
            t_us_ += forward;
        first_ = false;
        return t_us_ * 1000;
    }

  private:
    std::int64_t t_us_{};
    bool first_{true};
};

void parse_imu_record(std::string_view record, std::int64_t t_ns, Recording& recording) {
    const auto flags = load<std::uint32_t>(record, 4);
    Sample sample;
    sample.t_ns = t_ns;
    sample.gyro_rad_s = load_vec3(record, 8);
    sample.accel_m_s2 = load_vec3(record, 20);
    sample.mag_uT = load_vec3(record, 32);
    sample.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    Pose truth;
    truth.t_ns = t_ns;
    if ((flags & 2u) != 0) {
        truth.q_wb = load_quat(record, 44);
        truth.flags |= flag::orientation_valid;
    }
    if ((flags & 4u) != 0) {
        truth.p_w_m = load_vec3(record, 60);
        truth.flags |= flag::position_valid;
    }
    recording.samples.push_back(sample);
    recording.truth.push_back(truth);
    recording.moving.push_back((flags & 1u) != 0 ? 1 : 0);
}

void parse_trk_record(std::string_view record, std::int64_t t_ns, Recording& recording) {
    const auto valid = load<std::uint32_t>(record, 4);
    Pose pose;
    pose.t_ns = t_ns;
    if ((valid & 1u) != 0) {
        pose.q_wb = load_quat(record, 20);
        pose.flags |= flag::orientation_valid;
    }
    if ((valid & 2u) != 0) {
        pose.p_w_m = load_vec3(record, 8);
        pose.flags |= flag::position_valid;
    }
    recording.poses.push_back(pose);
}

void parse_version1(std::string_view bytes, bool imu, const Steps& progress, Recording& recording) {
    const Header header = parse_header(bytes, imu, recording);
    Clock clock;
    std::size_t offset = header_size;
    for (std::uint32_t i = 0; i < header.record_count; ++i, offset += header.record_size) {
        if (bytes.size() - offset < header.record_size)
            refuse_at(offset, "record " + std::to_string(i) + " of " +
                                  std::to_string(header.record_count) + " is cut or missing");
        if (progress && i % 4096 == 0) progress(offset, bytes.size());
        const std::string_view record = bytes.substr(offset, header.record_size);
        const std::int64_t t_ns = clock.unwrap_ns(load<std::uint32_t>(record, 0));
        if (imu)
            parse_imu_record(record, t_ns, recording);
        else
            parse_trk_record(record, t_ns, recording);
    }
    if (bytes.size() != offset) refuse_at(offset, "bytes after the last record");
}

struct Sensor {
    const char* name;
    Vec3 Sample::*values;
    std::uint32_t valid;
};
constexpr std::array<Sensor, 3> sensors{{{"gyro", &Sample::gyro_rad_s, flag::gyro_valid},
                                         {"accel", &Sample::accel_m_s2, flag::accel_valid},
                                         {"mag", &Sample::mag_uT, flag::mag_valid}}};

bool zero(const Vec3& v) { return v.x == 0 && v.y == 0 && v.z == 0; }
bool finite(const Vec3& v) { return std::isfinite(v.x + v.y + v.z); }

void set_absent(Recording& recording, const Sensor& sensor) {
    for (Sample& s : recording.samples) {
        s.flags &= ~sensor.valid;
        s.*sensor.values = {};
    }
}

/// --sensors gyro,accel: what stands, whatever the values are.
void given_sensors(const std::string& text, Recording& recording) {
    const auto names = split(text, ',');
    for (const std::string& name : names)
        if (std::none_of(sensors.begin(), sensors.end(),
                         [&](const Sensor& s) { return name == s.name; }))
            throw BadSpec("--sensors: '" + name + "' is not one of gyro, accel, mag");
    for (const Sensor& sensor : sensors)
        if (std::find(names.begin(), names.end(), sensor.name) == names.end())
            set_absent(recording, sensor);
}

/// Version 1 cannot say that a sensor is absent: one that never reads anything is.
void inferred_sensors(Recording& recording) {
    std::string present, absent, why;
    for (const Sensor& sensor : sensors) {
        const bool any = std::any_of(
            recording.samples.begin(), recording.samples.end(),
            [&](const Sample& s) { return !zero(s.*sensor.values) && finite(s.*sensor.values); });
        std::string& list = any ? present : absent;
        list += (list.empty() ? "" : ", ") + std::string(sensor.name);
        if (!any) set_absent(recording, sensor);
    }
    if (absent.empty()) return;
    recording.notes.push_back(
        "version 1 of .imu does not say which sensors exist; taken as present: " +
        (present.empty() ? "none" : present) + "; absent: " + absent +
        " (zero or not finite in all " + std::to_string(recording.samples.size()) +
        " records); --sensors overrides this");
}

void settle_sensors(const ReadOptions& options, Recording& recording) {
    if (options.sensors.empty())
        inferred_sensors(recording);
    else
        given_sensors(options.sensors, recording);
    for (Sample& s : recording.samples)
        if (zero(s.mag_uT) || !finite(s.mag_uT)) {
            s.flags &= ~flag::mag_valid;
            s.mag_uT = {};
        }
}

}  // namespace

bool looks_binary(std::string_view bytes) {
    return bytes.substr(0, 4) == "IMR1" || bytes.substr(0, 4) == "TRK1" ||
           bytes.substr(0, header_size).find('\0') != std::string_view::npos;
}

void parse_binary(std::string_view bytes, const ReadOptions& options, Recording& recording) {
    const bool imu = bytes.substr(0, 4) == "IMR1";
    if (!imu && bytes.substr(0, 4) != "TRK1")
        refuse_at(0, "neither text nor a binary recording: these begin with IMR1 or TRK1");
    if (bytes.size() < 8) refuse_at(bytes.size(), "the header is cut");
    const auto version = load<std::uint32_t>(bytes, 4);
    if (imu && version == 2) return parse_imu2(bytes, recording, options.progress);
    if (version != 1)
        refuse_at(4, "version " + std::to_string(version) + " of " + (imu ? ".imu" : ".trk") +
                         " is not known; this program reads " + (imu ? "1 and 2" : "1"));
    const auto settle = [&] {
        if (imu) settle_sensors(options, recording);
    };
    try {
        parse_version1(bytes, imu, options.progress, recording);
    } catch (const BadData&) {
        settle();
        throw;
    }
    settle();
}

}  // namespace fairlead::sim
