#include "host_sim/replay/attitude_settings.hpp"

#include <array>
#include <cstdio>

#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {

std::vector<std::string> attitude_setting_names() {
    std::vector<std::string> out;
    const AttitudeParams defaults;
    AttitudeParams::each(defaults,
                         [&](const char* name, float, float, float) { out.emplace_back(name); });
    return out;
}

void apply_settings(AttitudeParams& params, const std::vector<std::string>& items) {
    for (const std::string& item : items) {
        const auto parts = split(item, '=');
        if (parts.size() != 2)
            throw BadSpec("'" + item + "' is not NAME=VALUE with the name of a parameter");
        const auto asked = static_cast<float>(parse_real(parts[1]));
        bool found = false, good = false;
        std::array<char, 80> range{};
        AttitudeParams::each(params, [&](const char* name, float& value, float least, float most) {
            if (parts[0] != name) return;
            found = true;
            good = asked >= least && asked <= most;
            if (good) value = asked;
            std::snprintf(range.data(), range.size(), "%g to %g", static_cast<double>(least),
                          static_cast<double>(most));
        });
        if (!found) throw BadSpec("'" + parts[0] + "' is not the name of a parameter");
        if (!good) throw BadSpec("'" + item + "' is out of its range, " + range.data());
    }
}

}  // namespace fairlead::sim
