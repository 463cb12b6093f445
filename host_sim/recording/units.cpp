#include "host_sim/recording/units.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "host_sim/recording/decimal.hpp"

namespace fairlead::sim {
namespace {

constexpr double gravity = 9.80665;  // m/s^2, by definition of the unit g
constexpr double deg = 0.017453292519943295;

struct Spelling {
    const char* text;  // as plain_unit gives it
    Unit unit;
};

using Spellings = std::vector<Spelling>;

Spellings all_with(const Unit& unit, std::initializer_list<const char*> texts) {
    Spellings out;
    for (const char* text : texts) out.push_back({text, unit});
    return out;
}

Spellings joined(std::initializer_list<Spellings> parts) {
    Spellings out;
    for (const Spellings& part : parts) out.insert(out.end(), part.begin(), part.end());
    return out;
}

const Spellings& spellings(Quantity quantity) {
    static const Spellings time = joined(
        {all_with({"ns", 1, 0, 0}, {"ns", "nsec", "nsecs", "nanosec", "nanosecs", "nanosecond",
                                    "nanoseconds", "nanos"}),
         all_with({"us", 1, 0, 3},
                  {"us", "usec", "usecs", "microsec", "microsecond", "microseconds", "micros"}),
         all_with({"ms", 1, 0, 6},
                  {"ms", "msec", "msecs", "millisec", "millisecond", "milliseconds", "millis"}),
         all_with({"s", 1, 0, 9}, {"s", "sec", "secs", "second", "seconds"})});
    static const Spellings gyro =
        joined({all_with({"rad/s"}, {"rad/s", "rads-1", "rads", "rad/sec", "radpers", "radpersec",
                                     "radians/s", "radianspersecond"}),
                all_with({"mrad/s", 1e-3}, {"mrad/s", "mrads", "mrads-1"}),
                all_with({"deg/s", deg},
                         {"deg/s", "degs-1", "degs", "deg/sec", "dps", "degpers", "degpersec",
                          "degps", "degrees/s", "degrees/sec", "degree/s", "degreespersecond"}),
                all_with({"mdeg/s", deg * 1e-3}, {"mdps", "mdeg/s", "mdegs"})});
    static const Spellings accel =
        joined({all_with({"m/s2"}, {"m/s2", "ms-2", "ms2", "m/s/s", "mps2", "m/sec2", "mpers2",
                                    "meterspersecondsquared"}),
                all_with({"cm/s2", 1e-2}, {"cm/s2", "cms-2", "gal"}),
                all_with({"g", gravity}, {"g", "gs", "gee", "gforce", "g0"}),
                all_with({"mg", gravity * 1e-3}, {"mg", "millig"}),
                all_with({"ug", gravity * 1e-6}, {"ug"})});
    static const Spellings mag = joined(
        {all_with({"uT"}, {"ut", "utesla", "microtesla", "microteslas"}),
         all_with({"mT", 1e3}, {"mt", "millitesla"}), all_with({"nT", 1e-3}, {"nt", "nanotesla"}),
         all_with({"T", 1e6}, {"t", "tesla"}), all_with({"gauss", 100}, {"g", "gs", "gauss", "ga"}),
         all_with({"mgauss", 0.1}, {"mg", "mgauss", "milligauss", "mga", "mgs"})});
    static const Spellings position =
        joined({all_with({"m"}, {"m", "meter", "meters", "metre", "metres"}),
                all_with({"mm", 1e-3}, {"mm", "millimeter", "millimeters", "millimetres"}),
                all_with({"cm", 1e-2}, {"cm", "centimeter", "centimeters", "centimetres"}),
                all_with({"km", 1e3}, {"km"}), all_with({"in", 0.0254}, {"in", "inch", "inches"}),
                all_with({"ft", 0.3048}, {"ft", "feet"})});
    static const Spellings temperature =
        joined({all_with({"degC"}, {"c", "degc", "celsius", "degreec", "degreecelsius"}),
                all_with({"K", 1, -273.15}, {"k", "kelvin", "degk"}),
                all_with({"degF", 5.0 / 9, -160.0 / 9}, {"f", "degf", "fahrenheit"})});
    switch (quantity) {
        case Quantity::time: return time;
        case Quantity::gyro: return gyro;
        case Quantity::accel: return accel;
        case Quantity::mag: return mag;
        case Quantity::position: return position;
        case Quantity::temperature: break;
    }
    return temperature;
}

/// A number as a unit: a factor; of times only a power of ten of a second.
std::optional<Unit> factor_unit(Quantity quantity, std::string_view text) {
    const auto factor = real64(text);
    if (!factor || !std::isfinite(*factor) || !(*factor > 0)) return {};
    Unit unit{std::string(text), *factor, 0, 0};
    if (quantity != Quantity::time) return unit;
    const double power = std::log10(*factor);
    if (std::fabs(power - std::round(power)) > 1e-9 || power < -12 || power > 6) return {};
    unit.time_shift = 9 + static_cast<int>(std::lround(power));
    return unit;
}

}  // namespace

const char* to_string(Quantity quantity) {
    switch (quantity) {
        case Quantity::time: return "t";
        case Quantity::gyro: return "gyro";
        case Quantity::accel: return "accel";
        case Quantity::mag: return "mag";
        case Quantity::position: return "position";
        case Quantity::temperature: break;
    }
    return "temperature";
}

std::string plain_unit(std::string_view text) {
    static const std::vector<std::pair<std::string_view, std::string_view>> signs{
        {"\u00b5", "u"}, {"\u03bc", "u"}, {"\u00b0", "deg"}, {"\u00ba", "deg"}, {"\u00b2", "2"},
        {"\u00b9", "1"}, {"\u207b", "-"}, {"\u2212", "-"},   {"\u00b7", ""},    {"\u22c5", ""}};
    std::string out;
    while (!text.empty()) {
        bool found = false;
        for (const auto& [sign, plain] : signs) {
            if (text.substr(0, sign.size()) != sign) continue;
            out += plain;
            text.remove_prefix(sign.size());
            found = true;
            break;
        }
        if (found) continue;
        const char c = text.front();
        text.remove_prefix(1);
        if (std::string_view(" \t_^*.()'\"").find(c) != std::string_view::npos) continue;
        out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return out;
}

std::optional<Unit> unit_of(Quantity quantity, std::string_view text) {
    const std::string plain = plain_unit(text);
    for (const Spelling& s : spellings(quantity))
        if (plain == s.text) return s.unit;
    return factor_unit(quantity, text);
}

Unit own_unit(Quantity quantity) { return spellings(quantity).front().unit; }

const char* known_units(Quantity quantity) {
    switch (quantity) {
        case Quantity::time: return "ns, us, ms, s, or a power of ten of a second such as 1e-4";
        case Quantity::gyro: return "rad/s, mrad/s, deg/s, mdeg/s, or a factor to rad/s";
        case Quantity::accel: return "m/s2, cm/s2, g, mg, ug, or a factor to m/s2";
        case Quantity::mag: return "uT, mT, nT, T, gauss, mgauss, or a factor to uT";
        case Quantity::position: return "m, mm, cm, km, in, ft, or a factor to m";
        case Quantity::temperature: break;
    }
    return "degC, K, degF";
}

}  // namespace fairlead::sim
