#include "host_sim/report/assets.hpp"

#include <cstddef>

// The assembler reads the files, so that no copy of them stands in the tree. Paths of our own files
// are those from the top of the tree, where the compiler runs.
#define FAIRLEAD_EMBED(name, path)                                                  \
    __asm__(                                                                        \
        ".section .rodata\n"                                                        \
        ".global fairlead_" #name                                                   \
        "\n"                                                                        \
        "fairlead_" #name ":\n.incbin \"" path                                      \
        "\"\n"                                                                      \
        ".global fairlead_" #name                                                   \
        "_end\n"                                                                    \
        "fairlead_" #name "_end:\n.byte 0\n.previous\n");                           \
    extern "C" const char fairlead_##name[];                                        \
    extern "C" const char fairlead_##name##_end[];                                  \
    std::string_view fairlead::sim::assets::name() {                                \
        return {fairlead_##name,                                                    \
                static_cast<std::size_t>(fairlead_##name##_end - fairlead_##name)}; \
    }

FAIRLEAD_EMBED(dygraphs_script, "/usr/share/javascript/dygraphs/dygraph.min.js")
FAIRLEAD_EMBED(dygraphs_style, "/usr/share/javascript/dygraphs/dygraph.min.css")
FAIRLEAD_EMBED(three_script, "/usr/share/javascript/three/three.min.js")
FAIRLEAD_EMBED(orbit_script, "/usr/share/javascript/three/examples/js/controls/OrbitControls.js")
FAIRLEAD_EMBED(page_style, "host_sim/report/page/page.css")
FAIRLEAD_EMBED(body_script, "host_sim/report/page/body.js")
FAIRLEAD_EMBED(chart_script, "host_sim/report/page/charts.js")
FAIRLEAD_EMBED(report_script, "host_sim/report/page/report.js")
FAIRLEAD_EMBED(licences, "host_sim/report/page/licences.html")
