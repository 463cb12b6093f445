#include "host_sim/report/explorer.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/recording/progress.hpp"
#include "host_sim/report/assets.hpp"
#include "host_sim/report/chart.hpp"
#include "host_sim/report/packed.hpp"

namespace fairlead::sim {
namespace {

constexpr std::size_t points_max = 120000;  // of a series in the page; beyond, extremes are kept

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') out += '\\';
        if (code < 0x20 || c == '<') {  // no end of the script element within a text
            char escape[8];
            std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(code));
            out += escape;
        } else {
            out += c;
        }
    }
    return out + "\"";
}

std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", std::isfinite(value) ? value : 0.0);
    return text;
}

/// Items joined by commas, in brackets of a kind.
template <class Items, class Text>
std::string joined(const Items& items, const char* brackets, Text text) {
    std::string out(1, brackets[0]);
    for (const auto& item : items) {
        const std::string one = text(item);
        if (!one.empty()) out += (out.size() > 1 ? "," : "") + one;
    }
    return out + brackets[1];
}

std::string series_json(const Figure& figure, const Series& full, Packed& packed) {
    if (full.style == Series::Style::rug) return {};  // marks stand by themselves
    const Series s = full.x.size() > points_max
                         ? thinned(full, figure.x_min, figure.x_max, points_max / 2)
                         : full;
    const char* style = s.style == Series::Style::dashed ? "dashed"
                        : s.style == Series::Style::dots ? "dots"
                                                         : "line";
    return "{\"name\":" + quoted(s.legend) + ",\"color\":" + quoted(s.colour) + ",\"style\":\"" +
           style + "\",\"width\":" + number(s.width) + ",\"x\":" + packed.add_times(s.x) +
           ",\"y\":" + packed.add_values(s.y) + "}";
}

std::string figure_json(const Figure& figure, Packed& packed) {
    return "{\"id\":" + quoted(figure.id) + ",\"title\":" + quoted(figure.title) +
           ",\"unit\":" + quoted(figure.y_label) + ",\"caption\":" + quoted(figure.caption) +
           ",\"log\":" + (figure.log_y ? "true" : "false") + ",\"min\":" + number(figure.y_min) +
           ",\"max\":" + number(figure.y_max) + ",\"series\":" +
           joined(figure.series, "[]",
                  [&](const Series& s) { return series_json(figure, s, packed); }) +
           "}";
}

std::string marks_json(const char* name, const char* colour, const std::vector<double>& times,
                       Packed& packed) {
    if (times.empty()) return {};
    return std::string("{\"name\":\"") + name + "\",\"color\":\"" + colour +
           "\",\"times\":" + packed.add_times(times) + "}";
}

/// Times at which bytes left the encoder.
std::vector<double> frame_times(const Replay& replay, const TimeAxis& axis) {
    std::vector<double> out;
    std::size_t before = 0;
    for (std::size_t i = 0; i < replay.bytes_after_input.size() && i < replay.input.size(); ++i) {
        if (replay.bytes_after_input[i] > before) out.push_back(axis.s(replay.input[i].t_ns));
        before = replay.bytes_after_input[i];
    }
    return out;
}

std::vector<double> knot_times(const ChannelResult& channel, const TimeAxis& axis) {
    std::vector<double> out;
    for (const std::int64_t t_ns : channel.knot_ns) out.push_back(axis.s(t_ns));
    return out;
}

struct Stretch {
    double from, to;
};

/// Stretches in which a flag is set.
template <class Records>
std::vector<Stretch> stretches(const Records& records, const TimeAxis& axis, std::uint32_t mask) {
    std::vector<Stretch> out;
    for (const auto& r : records) {
        if ((r.flags & mask) == 0) continue;
        const double t = axis.s(r.t_ns);
        if (!out.empty() && t - out.back().to <= 2.5 * axis.period_s)
            out.back().to = t;
        else
            out.push_back({t, t});
    }
    return out;
}

/// The time without records before a record that is flagged.
std::vector<Stretch> gaps(const std::vector<Pose>& poses, const TimeAxis& axis) {
    constexpr std::uint32_t any = flag::gap_before | flag::position_gap | flag::orientation_gap;
    std::vector<Stretch> out;
    for (std::size_t i = 1; i < poses.size(); ++i)
        if ((poses[i].flags & any) != 0)
            out.push_back({axis.s(poses[i - 1].t_ns), axis.s(poses[i].t_ns)});
    return out;
}

std::string band_json(const char* name, const char* colour, const std::vector<Stretch>& all,
                      Packed& packed) {
    if (all.empty()) return {};
    std::vector<double> from, to;
    for (const Stretch& s : all) from.push_back(s.from), to.push_back(s.to);
    return std::string("{\"name\":\"") + name + "\",\"color\":\"" + colour +
           "\",\"from\":" + packed.add_times(from) + ",\"to\":" + packed.add_times(to) + "}";
}

std::string bands_json(const Replay& replay, const TimeAxis& axis, Packed& packed) {
    struct Named {
        const char *name, *colour;
        std::uint32_t mask;
    };
    static constexpr std::array<Named, 4> named{{{"settling", "#8a8f98", flag::settling},
                                                 {"rest", "#2fa57c", flag::rest},
                                                 {"field disturbed", "#b45fb0", flag::mag_rejected},
                                                 {"clipped", "#d9534f", flag::clipped}}};
    std::vector<std::string> all{band_json("gap", "#e0803a", gaps(replay.raw, axis), packed)};
    for (const Named& n : named)
        all.push_back(band_json(n.name, n.colour,
                                replay.attitude ? stretches(replay.attitude->points, axis, n.mask)
                                                : stretches(replay.raw, axis, n.mask),
                                packed));
    return joined(all, "[]", [](const std::string& s) { return s; });
}

/// Poses for the body: at most `points_max`, every n-th.
std::string motion_json(const std::vector<Pose>& poses, const TimeAxis& axis, bool position,
                        Packed& packed) {
    const std::size_t every = poses.size() / points_max + 1;
    std::vector<double> t;
    std::array<std::vector<double>, 7> v;
    for (std::size_t i = 0; i < poses.size(); i += every) {
        const Pose& pose = poses[i];
        const bool has_q = (pose.flags & flag::orientation_valid) != 0;
        const bool has_p = position && (pose.flags & flag::position_valid) != 0;
        const std::array<float, 7> c{pose.q_wb.w,  pose.q_wb.x,  pose.q_wb.y, pose.q_wb.z,
                                     pose.p_w_m.x, pose.p_w_m.y, pose.p_w_m.z};
        t.push_back(axis.s(pose.t_ns));
        for (std::size_t k = 0; k < 7; ++k)
            v[k].push_back((k < 4 ? has_q : has_p) ? static_cast<double>(c[k]) : double{NAN});
    }
    std::string out = "{\"t\":" + packed.add_times(t) + ",\"q\":[";
    for (std::size_t k = 0; k < 4; ++k) out += (k > 0 ? "," : "") + packed.add_values(v[k]);
    out += "],\"p\":[";
    for (std::size_t k = 4; position && k < 7; ++k)
        out += (k > 4 ? "," : "") + packed.add_values(v[k]);
    return out + "]}";
}

std::string script(std::string_view text) {
    return "<script>\n" + std::string(text) + "\n</script>\n";
}

}  // namespace

std::string explorer_data(const Replay& replay, const std::vector<Figure>& figures) {
    const TimeAxis axis{replay.input};
    const bool position = replay.position.samples > 0;
    Packed packed;
    Progress progress{"report", figures.size(), "charts"};
    std::string json = "{\"name\":" + quoted(replay.name) + ",\"end\":" + number(axis.end_s) +
                       ",\"start_ns\":\"" + std::to_string(axis.start_ns) + "\"";
    json += ",\"charts\":" + joined(figures, "[]", [&](const Figure& f) {
                progress.show(static_cast<std::size_t>(&f - figures.data()));
                return figure_json(f, packed);
            });
    const std::array<std::string, 3> marks{
        marks_json("knots of the position", "#7c6fd0", knot_times(replay.position, axis), packed),
        marks_json("knots of the orientation", "#b45fb0", knot_times(replay.orientation, axis),
                   packed),
        marks_json("frames", "#8a8f98", frame_times(replay, axis), packed)};
    json += ",\"marks\":" + joined(marks, "[]", [](const std::string& s) { return s; });
    json += ",\"bands\":" + bands_json(replay, axis, packed);
    json += ",\"before\":" + motion_json(replay.raw, axis, position, packed);
    json += ",\"after\":" + motion_json(replay.decoded, axis, position, packed);
    return "<script id=\"data\" type=\"application/json\">" + json +
           "}</script>\n<script id=\"numbers\" type=\"text/plain\">" +
           packed.text(progress_steps("report", "bytes")) + "</script>\n";
}

std::string explorer_scripts() {
    std::string out = std::string(assets::licences()) + "<style>\n" +
                      std::string(assets::dygraphs_style()) + std::string(assets::page_style()) +
                      "</style>\n";
    for (const std::string_view part :
         {assets::dygraphs_script(), assets::three_script(), assets::orbit_script(),
          assets::body_script(), assets::chart_script(), assets::report_script()})
        out += script(part);
    return out;
}

}  // namespace fairlead::sim
