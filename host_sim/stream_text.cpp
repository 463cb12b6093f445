#include "host_sim/stream_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace fairlead::sim {
namespace {

struct LineError {
    std::string why;
};

std::string_view trimmed(std::string_view s) {
    const auto first = s.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line, bool commas) {
    std::vector<std::string_view> fields;
    if (commas) {
        for (;;) {
            const auto comma = line.find(',');
            fields.push_back(trimmed(line.substr(0, comma)));
            if (comma == std::string_view::npos) return fields;
            line.remove_prefix(comma + 1);
        }
    }
    for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
        const auto end = line.find_first_of(" \t");
        fields.push_back(line.substr(0, end));
        line.remove_prefix(end == std::string_view::npos ? line.size() : end);
    }
    return fields;
}

template <class T>
std::optional<T> parse_number(std::string_view text) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    T value{};
    const auto end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    // out of range is rounded like any decimal: to zero, or to infinity, which Intake rejects
    if (result.ec == std::errc::result_out_of_range && std::is_floating_point_v<T>)
        return static_cast<T>(std::strtod(std::string(text).c_str(), nullptr));
    if (result.ec != std::errc{} || result.ptr != end) return {};
    return value;
}

float real_field(std::string_view text) {
    const auto value = parse_number<float>(text);
    if (!value) throw LineError{"'" + std::string(text) + "' is not a number"};
    return *value;
}

std::int64_t nanoseconds_field(std::string_view text) {
    const auto value = parse_number<std::int64_t>(text);
    if (!value) throw LineError{"'" + std::string(text) + "' is not a time in nanoseconds"};
    return *value;
}

/// Seconds as a decimal number, exact: a double keeps only microseconds of a time since 1970.
std::int64_t seconds_field(std::string_view text) {
    const LineError error{"'" + std::string(text) + "' is not a time in seconds"};
    const bool negative = !text.empty() && text.front() == '-';
    std::string_view digits = text.substr(negative ? 1 : 0);
    if (digits.find_first_of("eE") != std::string_view::npos) {
        const auto value = parse_number<double>(text);
        if (!value || !(std::fabs(*value) < 9e9)) throw error;
        return std::llround(*value * 1e9);
    }
    const auto dot = digits.find('.');
    std::string_view fraction = dot == std::string_view::npos ? "" : digits.substr(dot + 1);
    const bool round_up = fraction.size() > 9 && fraction[9] >= '5';
    std::string joined(digits.substr(0, dot));
    if (fraction.find_first_not_of("0123456789") != std::string_view::npos) throw error;
    for (std::size_t i = 0; i < 9; ++i) joined += i < fraction.size() ? fraction[i] : '0';
    const auto value = parse_number<std::int64_t>(joined);
    if (!value || joined.front() == '-' || joined.front() == '+' || *value == INT64_MAX)
        throw error;
    const std::int64_t t_ns = *value + (round_up ? 1 : 0);
    return negative ? -t_ns : t_ns;
}

Vec3 vec3_at(const std::vector<std::string_view>& f, std::size_t i) {
    return {real_field(f[i]), real_field(f[i + 1]), real_field(f[i + 2])};
}

bool all_empty(const std::vector<std::string_view>& f, std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i)
        if (!f[i].empty()) return false;
    return true;
}

void parse_euroc_imu(const std::vector<std::string_view>& f, Recording& recording) {
    Sample sample;
    sample.t_ns = nanoseconds_field(f[0]);
    sample.gyro_rad_s = vec3_at(f, 1);
    sample.accel_m_s2 = vec3_at(f, 4);
    sample.flags = flag::gyro_valid | flag::accel_valid;
    recording.samples.push_back(sample);
}

/// t_ns,px,py,pz,qw,qx,qy,qz[,...]: empty fields mean that the channel has no measurement.
void parse_poses_csv(const std::vector<std::string_view>& f, Recording& recording) {
    Pose pose;
    pose.t_ns = nanoseconds_field(f[0]);
    if (!all_empty(f, 1, 3)) {
        pose.p_w_m = vec3_at(f, 1);
        pose.flags |= flag::position_valid;
    }
    if (!all_empty(f, 4, 4)) {
        const Vec3 v = vec3_at(f, 5);
        pose.q_wb = {real_field(f[4]), v.x, v.y, v.z};
        pose.flags |= flag::orientation_valid;
    }
    recording.poses.push_back(pose);
}

void parse_tum(const std::vector<std::string_view>& f, Recording& recording) {
    const Vec3 v = vec3_at(f, 4);
    Pose pose;
    pose.t_ns = seconds_field(f[0]);
    pose.p_w_m = vec3_at(f, 1);
    pose.q_wb = {real_field(f[7]), v.x, v.y, v.z};
    pose.flags = flag::position_valid | flag::orientation_valid;
    recording.poses.push_back(pose);
}

Format detect(bool commas, std::size_t columns) {
    if (commas && columns == 7) return Format::euroc_imu;
    if (commas && columns >= 8) return Format::poses_csv;
    if (!commas && columns == 8) return Format::tum;
    throw LineError{"no known layout has " + std::to_string(columns) + " columns"};
}

}  // namespace

void parse_text(std::string_view text, Recording& recording) {
    std::size_t columns = 0, line_number = 0;
    bool commas = false;
    for (std::size_t start = 0; start < text.size();) {
        const auto end = text.find('\n', start);
        const std::string_view line = trimmed(text.substr(start, end - start));
        start = end == std::string_view::npos ? text.size() : end + 1;
        ++line_number;
        if (line.empty() || line.front() == '#') continue;
        if (columns == 0 && line.substr(0, 5) == "t_ns,") continue;  // our own header
        try {
            if (columns == 0) commas = line.find(',') != std::string_view::npos;
            const auto fields = fields_of(line, commas);
            if (columns == 0) {
                recording.format = detect(commas, fields.size());
                columns = fields.size();
            }
            if (fields.size() != columns)
                throw LineError{std::to_string(fields.size()) + " columns, expected " +
                                std::to_string(columns)};
            if (recording.format == Format::euroc_imu)
                parse_euroc_imu(fields, recording);
            else if (recording.format == Format::tum)
                parse_tum(fields, recording);
            else
                parse_poses_csv(fields, recording);
        } catch (const LineError& error) {
            throw BadData("line " + std::to_string(line_number) + ": " + error.why);
        }
        if (end == std::string_view::npos)
            recording.note = "line " + std::to_string(line_number) +
                             " has no end of line: it is used, but may be cut";
    }
}

}  // namespace fairlead::sim
