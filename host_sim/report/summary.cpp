#include "host_sim/report/summary.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "fairlead/math/approx.hpp"

namespace fairlead::sim {
namespace {

constexpr double deg = 180 / pi_v<double>;

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
    char line[256];
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    return line;
}

std::string per_channel(const ChannelResult& channel, const std::string& value) {
    return channel.samples == 0 ? "-" : value;
}

double per_second(const Replay& replay) {
    return replay.seconds > 0 ? static_cast<double>(replay.stream.size()) / replay.seconds : 0;
}

template <class Format>
Row row(const Replay& replay, const char* name, Format format) {
    return {name, per_channel(replay.position, format(replay.position)),
            per_channel(replay.orientation, format(replay.orientation)), false};
}

/// What of a score the mode can know: heading and the whole only with a magnetometer.
std::string score_text(const Score& score, AttitudeMode mode) {
    if (mode == AttitudeMode::imu) return text("inclination %.2f deg", score.inclination_deg);
    return text("%.2f deg; heading %.2f, inclination %.2f", score.total_deg, score.heading_deg,
                score.inclination_deg);
}

void add_attitude_rows(std::vector<Row>& rows, const AttitudeTrace& trace) {
    rows.push_back({"orientation from", to_string(trace.mode), "", true});
    if (trace.mode == AttitudeMode::gyro || trace.estimate.count == 0) return;
    rows.push_back({"rms error of estimate", score_text(trace.estimate, trace.mode), "", true});
    rows.push_back({"rms error of curve", score_text(trace.curve, trace.mode), "", true});
}

}  // namespace

const char* to_string(AttitudeMode mode) {
    switch (mode) {
        case AttitudeMode::gyro: return "gyro";
        case AttitudeMode::imu: return "gyro, accelerometer";
        case AttitudeMode::imu_mag: break;
    }
    return "gyro, accelerometer, magnetometer";
}

std::string grouped(std::size_t n) {
    std::string digits = std::to_string(n);
    for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
    return digits;
}

std::string faults_text(const Replay& replay) {
    std::string out;
    for (const auto& [kind, count] : replay.faults)
        if (count > 0) out += (out.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
    return out.empty() ? "none" : out;
}

std::vector<Row> summary_rows(const Replay& replay) {
    const auto& o = replay.options;
    std::vector<Row> rows;
    const auto whole = [&](const std::string& name, const std::string& value) {
        rows.push_back({name, value, "", true});
    };
    const auto both = [&](const char* name, const std::string& p, const std::string& r) {
        rows.push_back(
            {name, per_channel(replay.position, p), per_channel(replay.orientation, r), false});
    };
    const ChannelResult &p = replay.position, &r = replay.orientation;
    whole("records in", grouped(replay.records_in) + text(" in %.1f s", replay.seconds));
    whole("faults", faults_text(replay));
    if (replay.attitude) add_attitude_rows(rows, *replay.attitude);
    const bool c2 = o.continuity == 2 || o.objective == Objective::knots;
    whole("search", std::string{o.objective == Objective::knots ? "earlier search, few knots, "
                                                                : "few bytes, "} +
                        to_string(o.beam) + text(", delay at most %u records", o.delay_max));
    if (!o.filter.empty())
        whole("filter", o.filter + text(", %zu records of latency", replay.filter_delay));
    both("continuous", c2 ? "acceleration" : "velocity",
         o.objective == Objective::knots ? "acceleration" : "velocity");
    rows.push_back(row(replay, "samples", [](const auto& c) { return grouped(c.samples); }));
    rows.push_back(
        row(replay, "control points", [](const auto& c) { return grouped(c.control_points); }));
    rows.push_back(row(replay, "curves, knots",
                       [](const auto& c) { return grouped(c.curves) + ", " + grouped(c.knots); }));
    rows.push_back(row(replay, "breaks", [](const auto& c) { return grouped(c.breaks); }));
    both("tolerance", text("%.4g mm", o.tol_pos_m * 1e3), text("%.4g deg", o.tol_rot_rad * deg));
    both("largest error", text("%.4f mm", p.max_error * 1e3), text("%.4f deg", r.max_error * deg));
    rows.push_back(
        row(replay, "samples outside", [](const auto& c) { return grouped(c.violations); }));
    both("largest distance to raw", text("%.4f mm", p.max_raw * 1e3),
         text("%.4f deg", r.max_raw * deg));
    both("rms distance to raw", text("%.4f mm", p.rms_raw * 1e3),
         text("%.4f deg", r.rms_raw * deg));
    rows.push_back(row(replay, "largest delay", [](const auto& c) {
        return text("%u records, %.0f ms", c.max_delay, c.max_delay_ms);
    }));
    rows.push_back(row(replay, "mean delay",
                       [](const auto& c) { return text("%.1f records", c.mean_delay); }));
    rows.push_back(row(replay, "bytes out", [](const auto& c) { return grouped(c.bytes); }));
    const EventResult& e = replay.events;
    if (e.offered > 0)
        whole("discrete events", grouped(e.offered) + ", " + grouped(e.refused) + " refused, " +
                                     grouped(e.bytes) + " bytes");
    const double ratio = replay.stream.empty() ? 0
                                               : static_cast<double>(replay.bytes_in) /
                                                     static_cast<double>(replay.stream.size());
    whole(text("bytes in, %zu a record", replay.bytes_per_record), grouped(replay.bytes_in));
    whole("bytes out, in all", grouped(replay.stream.size()) + text(", %.1f times fewer", ratio) +
                                   text(", %.1f a second", per_second(replay)));
    whole("frames", grouped(replay.frames) + ", " +
                        (o.restart_s > 0 ? grouped(replay.restarts) + " of them restart frames"
                                         : std::string{"each decodes alone"}));
    if (replay.runs > 1) whole("runs", grouped(replay.runs) + " of the clock");
    if (replay.overflows > 0) whole("faults of the encoder", grouped(replay.overflows));
    return rows;
}

std::string summary_json(const Replay& replay) {
    const ReplayOptions& o = replay.options;
    const auto channel = [](const char* name, const char* error, double tolerance,
                            const ChannelResult& c, bool c2) {
        return text(", \"%s\": {\"control_points\": %zu, \"knots\": %zu, \"bytes\": %zu, ", name,
                    c.control_points, c.knots, c.bytes) +
               text("\"%s\": %.9g, \"max_delay_samples\": %u, \"mean_delay_samples\": %.9g, ",
                    error, c.max_error, c.max_delay, c.mean_delay) +
               text(
                   "\"samples\": %zu, \"samples_outside\": %zu, \"pieces\": %zu, \"curves\": %zu, ",
                   c.samples, c.violations, c.pieces, c.curves) +
               text("\"breaks\": %zu, \"error_over_tolerance\": %.9g, \"kind\": \"%s\"}", c.breaks,
                    c.max_error / tolerance, c2 ? "C2 cubic" : "C1 quadratic");
    };
    std::string json =
        text("{\"samples\": %zu, \"bytes\": %zu", replay.input.size(), replay.stream.size());
    const bool knots = o.objective == Objective::knots;
    if (o.position)
        json += channel("position", "max_error_m", o.tol_pos_m, replay.position,
                        knots || o.continuity == 2);
    if (o.orientation)
        json += channel("orientation", "max_error_rad", o.tol_rot_rad, replay.orientation, knots);
    const EventResult& e = replay.events;
    if (e.offered > 0)
        json += text(", \"events\": {\"count\": %zu, \"refused\": %zu, \"bytes\": %zu}", e.offered,
                     e.refused, e.bytes);
    json += text(", \"objective\": \"%s\", \"kind\": \"%s\", \"beam\": \"%s\", \"delay\": %u",
                 to_string(o.objective),
                 knots || (o.continuity == 2 && o.position) ? "C2 cubic" : "C1 quadratic",
                 to_string(o.beam), o.delay_max);
    json += text(", \"stream_id\": %u, \"restart_s\": %.9g, \"frames\": %zu, \"restarts\": %zu",
                 o.stream_id, o.restart_s, replay.frames, replay.restarts);
    json += text(", \"runs\": %zu, \"header_bytes\": %zu, \"bytes_per_s\": %.9g", replay.runs,
                 replay.header_bytes, per_second(replay));
    json += text(", \"records\": %zu, \"refused\": %zu, \"faults\": {", replay.records_in,
                 replay.refused);
    bool first = true;
    for (const auto& [kind, count] : replay.faults) {
        if (count == 0) continue;
        json += text("%s\"%s\": %zu", first ? "" : ", ", kind.c_str(), count);
        first = false;
    }
    return json + "}}\n";
}

std::string summary_table(const Replay& replay) {
    std::string out = text("%-24s %20s %20s\n", "", "position", "orientation");
    for (const Row& r : summary_rows(replay))
        out += r.whole ? text("%-24s %s\n", r.name.c_str(), r.position.c_str())
                       : text("%-24s %20s %20s\n", r.name.c_str(), r.position.c_str(),
                              r.orientation.c_str());
    return out;
}

}  // namespace fairlead::sim
