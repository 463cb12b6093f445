#include "host_sim/recording/spec.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace fairlead::sim {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t start = 0;;) {
        const std::size_t end = text.find(separator, start);
        parts.push_back(text.substr(start, end - start));
        if (end == std::string::npos) return parts;
        start = end + 1;
    }
}

double parse_real(const std::string& text) {
    double value{};
    const char* end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    if (result.ec != std::errc{} || result.ptr != end || !std::isfinite(value))
        throw BadSpec("'" + text + "' is not a number");
    return value;
}

std::vector<SpecItem> parse_spec(const std::string& spec) {
    std::vector<SpecItem> items;
    for (const std::string& text : split(spec, '+')) {
        SpecItem item;
        item.text = text;
        item.arguments = split(text, ':');
        item.name = item.arguments.front();
        item.arguments.erase(item.arguments.begin());
        if (item.name.empty()) throw BadSpec("'" + spec + "' has an empty item");
        items.push_back(item);
    }
    return items;
}

void SpecItem::refuse(const std::string& why) const { throw BadSpec("'" + text + "': " + why); }

void SpecItem::expect_arguments(std::size_t least, std::size_t most) const {
    if (arguments.size() >= least && arguments.size() <= most) return;
    const std::string count = least == most ? std::to_string(least)
                                            : std::to_string(least) + " to " + std::to_string(most);
    refuse("takes " + count + " argument" + (most == 1 ? "" : "s"));
}

double SpecItem::number(std::size_t i, double low, double high) const {
    double value{};
    try {
        value = parse_real(arguments.at(i));
    } catch (const BadSpec& error) {
        refuse(error.what());
    }
    if (!(value >= low && value <= high)) {
        char range[64];
        std::snprintf(range, sizeof range, "between %g and %g", low, high);
        refuse("'" + arguments[i] + "' must be " + range);
    }
    return value;
}

double SpecItem::number(std::size_t i, double low, double high, double fallback) const {
    return i < arguments.size() ? number(i, low, high) : fallback;
}

long SpecItem::whole(std::size_t i, long low, long high) const {
    const double value = number(i, static_cast<double>(low), static_cast<double>(high));
    const long n = static_cast<long>(value);
    if (static_cast<double>(n) != value) refuse("'" + arguments[i] + "' must be a whole number");
    return n;
}

}  // namespace fairlead::sim
