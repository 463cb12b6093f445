#include "host_sim/report/report.hpp"

#include <algorithm>
#include <cstdio>

#include "fairlead/math/approx.hpp"

#include "host_sim/report/explorer.hpp"
#include "host_sim/report/figures.hpp"
#include "host_sim/report/page.hpp"
#include "host_sim/report/summary.hpp"

namespace fairlead::sim {
namespace {

constexpr double deg = 180 / pi_v<double>;

template <class... Arguments>
std::string format(const char* pattern, Arguments... arguments) {
    char line[256];
    std::snprintf(line, sizeof line, pattern, arguments...);
    return line;
}

void card(std::string& page, const std::string& name, const std::string& value,
          const std::string& note) {
    page += "<div class=\"card\"><div class=\"name\">" + name + "</div><div class=\"value\">" +
            value + "</div><div class=\"note\">" + note + "</div></div>\n";
}

void attitude_card(std::string& page, const AttitudeTrace& trace) {
    const Score& s = trace.estimate;
    if (s.count == 0 || trace.mode == AttitudeMode::gyro) return;
    const bool whole = trace.mode == AttitudeMode::imu_mag;
    card(page, "Estimate against reference",
         format("%.2f°", whole ? s.total_deg : s.inclination_deg),
         whole ? format("rms; heading %.2f°, inclination %.2f°", s.heading_deg, s.inclination_deg)
               : "rms of the inclination");
}

void cards(std::string& page, const Replay& replay) {
    const auto& p = replay.position;
    const auto& r = replay.orientation;
    page += "<section class=\"cards\">\n";
    const double per_byte = replay.stream.empty() ? 0
                                                  : static_cast<double>(replay.bytes_in) /
                                                        static_cast<double>(replay.stream.size());
    card(page, "Bytes", format("%.1f : 1", per_byte),
         grouped(replay.bytes_in) + " in, " + grouped(replay.stream.size()) + " out");
    if (p.samples > 0)
        card(page, "Position", format("%.3f mm", p.max_error * 1e3),
             "largest error; tolerance " + format("%.4g mm", replay.options.tol_pos_m * 1e3));
    if (r.samples > 0)
        card(page, "Orientation", format("%.3f°", r.max_error * deg),
             "largest error; tolerance " + format("%.4g°", replay.options.tol_rot_rad * deg));
    if (replay.attitude) attitude_card(page, *replay.attitude);
    card(page, "Largest delay", format("%u records", std::max(p.max_delay, r.max_delay)),
         format("%.0f ms", std::max(p.max_delay_ms, r.max_delay_ms)) +
             format("; allowed %u records", replay.options.delay_max));
    page += "</section>\n";
}

void lead(std::string& page, const Replay& replay) {
    const std::size_t outside = replay.position.violations + replay.orientation.violations;
    page += "<p class=\"lead\">" + grouped(replay.records_in) + " records, " +
            format("%.1f s. ", replay.seconds);
    if (replay.attitude)
        page += std::string("Orientation from ") + to_string(replay.attitude->mode) + ". ";
    if (!replay.options.filter.empty())
        page += "Filtered by <b>" + escaped(replay.options.filter) + "</b>. ";
    page += outside == 0 ? "<b class=\"good\">Every sample lies within tolerance</b> of the curve "
                           "decoded from the stream, checked in double precision."
                         : "<b class=\"bad\">" + grouped(outside) +
                               " samples lie outside the tolerance.</b>";
    page += "</p>\n";
}

void table(std::string& page, const Replay& replay) {
    page +=
        "<section "
        "class=\"table\"><table>\n<tr><th></th><th>position</th><th>orientation</th></tr>\n";
    for (const Row& row : summary_rows(replay)) {
        page += "<tr><td>" + escaped(row.name) + "</td>";
        if (row.whole)
            page += "<td colspan=\"2\">" + escaped(row.position) + "</td></tr>\n";
        else
            page += "<td>" + escaped(row.position) + "</td><td>" + escaped(row.orientation) +
                    "</td></tr>\n";
    }
    page += "</table></section>\n";
}

}  // namespace

std::string report_page(const Replay& replay) {
    std::string page = page_head(replay.name);
    lead(page, replay);
    cards(page, replay);
    page +=
        "<div id=\"explorer\"><noscript>The charts need a browser with scripts.</noscript></div>\n";
    table(page, replay);
    page += explorer_data(replay, figures_of(replay)) + explorer_scripts();
    return page + page_foot("fairlead-sim replay");
}

}  // namespace fairlead::sim
