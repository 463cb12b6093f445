#include "examples/live/page.hpp"

#include "host_sim/report/assets.hpp"
#include "host_sim/report/embed.hpp"
#include "host_sim/report/page.hpp"

FAIRLEAD_EMBED(fairlead::live, live_script, "examples/live/page/live.js")

namespace fairlead::live {

std::string page(const std::string& title) {
    namespace assets = sim::assets;
    std::string out = sim::page_head(title, "connect-src 'self'; ");
    out += "<p class=\"lead\">Live, from <b>" + sim::escaped(title) + "</b>.</p>\n";
    out += "<div id=\"live\"></div>\n" + std::string(assets::licences()) + "<style>\n" +
           std::string(assets::dygraphs_style()) + std::string(assets::page_style()) + "</style>\n";
    for (const std::string_view script :
         {assets::dygraphs_script(), assets::three_script(), assets::orbit_script(),
          assets::chart_script(), assets::body_script(), live_script()})
        out += "<script>\n" + std::string(script) + "\n</script>\n";
    return out + sim::page_foot("fairlead-live");
}

}  // namespace fairlead::live
