#include "host_sim/stream_binary.hpp"

#include <array>
#include <cmath>
#include <cstring>

namespace fairlead::sim {
namespace {

constexpr std::size_t header_size = 64;
constexpr std::size_t name_offset = 24, name_size = 40;

template <class T>
T load(std::string_view bytes, std::size_t offset) {  // the host is little endian, like the file
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

Vec3 load_vec3(std::string_view bytes, std::size_t offset) {
    const auto v = load<std::array<float, 3>>(bytes, offset);
    return {v[0], v[1], v[2]};
}

Quat load_quat(std::string_view bytes, std::size_t offset) {
    const auto q = load<std::array<float, 4>>(bytes, offset);
    return {q[0], q[1], q[2], q[3]};
}

[[noreturn]] void refuse(std::size_t offset, const std::string& why) {
    throw BadData("byte " + std::to_string(offset) + ": " + why);
}

struct Header {
    std::uint32_t record_count{};
    std::size_t record_size{};
};

Header parse_header(std::string_view bytes, Recording& recording) {
    const bool imu = bytes.substr(0, 4) == "IMR1";
    if (!imu && bytes.substr(0, 4) != "TRK1") refuse(0, "neither the magic IMR1 nor TRK1");
    if (bytes.size() < header_size) refuse(bytes.size(), "the header of 64 bytes is cut");
    if (const auto version = load<std::uint32_t>(bytes, 4); version != 1)
        refuse(4, "version " + std::to_string(version) + ", only version 1 is known");
    const Header header{load<std::uint32_t>(bytes, 8), imu ? 72u : 36u};
    if (load<std::uint32_t>(bytes, 12) != header.record_size)
        refuse(12, "records of " + std::to_string(load<std::uint32_t>(bytes, 12)) +
                       " bytes, expected " + std::to_string(header.record_size));
    const double period_s = imu ? 1e-6 * load<std::uint32_t>(bytes, 16) : load<double>(bytes, 16);
    if (!std::isfinite(period_s) || period_s < 0) refuse(16, "the period is not a time");
    recording.format = imu ? Format::imu : Format::trk;
    recording.period_s = period_s;
    const std::string_view name = bytes.substr(name_offset, name_size);
    if (const auto end = name.find('\0'); end != 0) recording.name = name.substr(0, end);
    return header;
}

/// Microseconds of 32 bits wrap after 71.6 minutes: the shorter way round from the last one.
class Clock {
  public:
    std::int64_t unwrap_ns(std::uint32_t t_us) {
        if (first_)
            t_us_ = t_us;
        else
            t_us_ += static_cast<std::int32_t>(t_us - static_cast<std::uint32_t>(t_us_));
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

}  // namespace

bool looks_binary(std::string_view bytes) {
    return bytes.substr(0, 4) == "IMR1" || bytes.substr(0, 4) == "TRK1" ||
           bytes.substr(0, header_size).find('\0') != std::string_view::npos;
}

void parse_binary(std::string_view bytes, Recording& recording) {
    const Header header = parse_header(bytes, recording);
    Clock clock;
    std::size_t offset = header_size;
    for (std::uint32_t i = 0; i < header.record_count; ++i, offset += header.record_size) {
        if (bytes.size() - offset < header.record_size)
            refuse(offset, "record " + std::to_string(i) + " of " +
                               std::to_string(header.record_count) + " is cut or missing");
        const std::string_view record = bytes.substr(offset, header.record_size);
        const std::int64_t t_ns = clock.unwrap_ns(load<std::uint32_t>(record, 0));
        if (recording.format == Format::imu)
            parse_imu_record(record, t_ns, recording);
        else
            parse_trk_record(record, t_ns, recording);
    }
    if (bytes.size() != offset) refuse(offset, "bytes after the last record");
}

}  // namespace fairlead::sim
