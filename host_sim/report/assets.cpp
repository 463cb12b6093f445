#include "host_sim/report/assets.hpp"

#include "host_sim/report/embed.hpp"

FAIRLEAD_EMBED(fairlead::sim::assets, dygraphs_script,
               "/usr/share/javascript/dygraphs/dygraph.min.js")
FAIRLEAD_EMBED(fairlead::sim::assets, dygraphs_style,
               "/usr/share/javascript/dygraphs/dygraph.min.css")
FAIRLEAD_EMBED(fairlead::sim::assets, three_script, "/usr/share/javascript/three/three.min.js")
FAIRLEAD_EMBED(fairlead::sim::assets, orbit_script,
               "/usr/share/javascript/three/examples/js/controls/OrbitControls.js")
FAIRLEAD_EMBED(fairlead::sim::assets, page_style, "host_sim/report/page/page.css")
FAIRLEAD_EMBED(fairlead::sim::assets, body_script, "host_sim/report/page/body.js")
FAIRLEAD_EMBED(fairlead::sim::assets, chart_script, "host_sim/report/page/charts.js")
FAIRLEAD_EMBED(fairlead::sim::assets, report_script, "host_sim/report/page/report.js")
FAIRLEAD_EMBED(fairlead::sim::assets, licences, "host_sim/report/page/licences.html")
