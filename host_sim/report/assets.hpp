#pragma once
// What the pages are made of, embedded when the program is built: their own style and script, and
// the libraries dygraphs (charts) and three.js (the body), as Debian has them, under the MIT
// licence.
#include <string_view>

namespace fairlead::sim::assets {

std::string_view dygraphs_script();
std::string_view dygraphs_style();
std::string_view three_script();
std::string_view orbit_script();   // of three.js: turns the camera
std::string_view licences();       // page/licences.html: the notices of the libraries
std::string_view page_style();     // page/page.css
std::string_view body_script();    // page/body.js: the body in 3D
std::string_view chart_script();   // page/charts.js: charts that move together
std::string_view report_script();  // page/report.js

}  // namespace fairlead::sim::assets
