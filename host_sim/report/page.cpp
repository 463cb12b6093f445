#include "host_sim/report/page.hpp"

namespace fairlead::sim {
namespace {

const char* const style = R"(
:root { color-scheme: light dark; --page: #fbfbfa; --card: #ffffff; --ink: #1f2329; --soft: #667080;
  --line: #e6e7ea; --good: #2f8f5b; --bad: #c8423d; }
@media (prefers-color-scheme: dark) { :root { --page: #15171b; --card: #1c1f24; --ink: #e6e8eb;
  --soft: #98a1ad; --line: #2c3037; --good: #5fc48d; --bad: #ef7b75; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 15px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
main { max-width: 1080px; margin: 0 auto; padding: 48px 24px 72px; }
h1 { font-size: 28px; line-height: 1.2; font-weight: 650; letter-spacing: -0.02em; margin: 0 0 6px; }
h2 { font-size: 16px; font-weight: 620; margin: 0; }
.lead { color: var(--soft); margin: 0 0 28px; max-width: 46em; }
.lead b { color: var(--ink); font-weight: 600; }
.good { color: var(--good); } .bad { color: var(--bad); }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(220px, 1fr)); gap: 14px;
  margin: 0 0 28px; }
.card, figure, .table { background: var(--card); border: 1px solid var(--line); border-radius: 10px; }
.card { padding: 16px 18px; }
.card .value { font-size: 24px; font-weight: 620; letter-spacing: -0.01em; white-space: nowrap; }
.card .name { color: var(--soft); font-size: 13px; }
.card .note { color: var(--soft); font-size: 13px; margin-top: 2px; }
.table { padding: 8px 18px; margin: 0 0 28px; overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: 7px 0 7px 18px; border-top: 1px solid var(--line);
  font-weight: 400; }
th:first-child, td:first-child { text-align: left; padding-left: 0; color: var(--soft); }
tr:first-child th { border-top: 0; color: var(--soft); font-size: 13px; }
figure { margin: 0 0 18px; padding: 16px 18px 10px; }
figure header { display: flex; flex-wrap: wrap; gap: 4px 18px; align-items: baseline; }
figcaption { color: var(--soft); font-size: 13px; margin: 2px 0 8px; }
svg { display: block; width: 100%; height: auto; }
.gridline { stroke: var(--line); }
.legend { margin-left: auto; color: var(--soft); font-size: 13px; display: flex; gap: 14px; }
.legend i { display: inline-block; width: 14px; height: 3px; border-radius: 2px; margin-right: 6px;
  vertical-align: middle; }
.legend i.dots { width: 6px; height: 6px; border-radius: 3px; }
.legend i.rug { width: 2px; height: 10px; }
footer { color: var(--soft); font-size: 13px; margin-top: 28px; }
)";

void legend(std::string& page, const Figure& figure) {
    page += "<div class=\"legend\">";
    for (const Series& s : figure.series) {
        if (s.legend.empty() || s.x.empty()) continue;
        const char* shape = s.style == Series::Style::dots  ? " class=\"dots\""
                            : s.style == Series::Style::rug ? " class=\"rug\""
                                                            : "";
        page += std::string("<span><i") + shape + " style=\"background:" + s.colour + "\"></i>" +
                escaped(s.legend) + "</span>";
    }
    page += "</div>";
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '&')
            out += "&amp;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

std::string page_head(const std::string& title, const std::string& policy) {
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
           // no network: a page holds all that it shows
           "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; " +
           policy +
           "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: "
           "blob:\">\n<title>" +
           escaped(title) + " - fairlead</title>\n<style>" + style +
           "</style>\n</head>\n<body>\n<main>\n<h1>" + escaped(title) + "</h1>\n";
}

std::string page_foot(const std::string& program) {
    return "<footer>Made by " + escaped(program) + ".</footer>\n</main>\n</body>\n</html>\n";
}

bool append_figures(std::string& page, const std::vector<Figure>& figures) {
    const auto svgs = draw(figures);
    bool drawn = true;
    for (std::size_t i = 0; i < figures.size(); ++i) {
        if (svgs[i].empty()) {
            drawn = false;
            continue;
        }
        page += "<figure id=\"figure-" + figures[i].id + "\">\n<header><h2>" +
                escaped(figures[i].title) + "</h2>";
        legend(page, figures[i]);
        page += "</header>\n<figcaption>" + escaped(figures[i].caption) + "</figcaption>\n" +
                svgs[i] + "</figure>\n";
    }
    if (!drawn) page += "<p class=\"lead\">The figures need gnuplot, which is not installed.</p>\n";
    return drawn;
}

}  // namespace fairlead::sim
