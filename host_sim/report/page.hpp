#pragma once
// A self-contained page: its frame and style, and figures with their legends.
#include <string>
#include <vector>

#include "host_sim/report/plot.hpp"

namespace fairlead::sim {

std::string escaped(const std::string& text);  // fit to stand in HTML
/// `policy`: what the page may ask for, beside what it holds, as a content security policy.
std::string page_head(const std::string& title, const std::string& policy = {});
std::string page_foot(const std::string& program);

/// False where gnuplot cannot be run; then the page says so.
bool append_figures(std::string& page, const std::vector<Figure>& figures);

}  // namespace fairlead::sim
