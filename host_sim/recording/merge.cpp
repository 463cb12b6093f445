#include "host_sim/recording/merge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace fairlead::sim {
namespace {

struct Sensor {
    const char* name;
    std::uint32_t valid;
    Vec3 Sample::*values;
};
constexpr std::array<Sensor, 3> sensors{{{"gyroscope", flag::gyro_valid, &Sample::gyro_rad_s},
                                         {"accelerometer", flag::accel_valid, &Sample::accel_m_s2},
                                         {"magnetometer", flag::mag_valid, &Sample::mag_uT}}};

bool has(const Recording& part, const Sensor& sensor) {
    return std::any_of(part.samples.begin(), part.samples.end(),
                       [&](const Sample& s) { return (s.flags & sensor.valid) != 0; });
}

std::string seconds(std::int64_t t_ns) {
    char text[40];
    std::snprintf(text, sizeof text, "%.3f s", static_cast<double>(t_ns) * 1e-9);
    return text;
}

std::string span_of(const Recording& part) {
    return part.name + " from " + seconds(part.samples.front().t_ns) + " to " +
           seconds(part.samples.back().t_ns);
}

void sort_by_time(Recording& part) {
    const auto earlier = [](const Sample& a, const Sample& b) { return a.t_ns < b.t_ns; };
    if (std::is_sorted(part.samples.begin(), part.samples.end(), earlier)) return;
    std::stable_sort(part.samples.begin(), part.samples.end(), earlier);
    part.notes.push_back(part.name + ": the records were not in the order of time");
}

std::uint64_t apart_ns(std::int64_t a, std::int64_t b) {
    const auto wide = [](std::int64_t t) { return static_cast<std::uint64_t>(t); };
    return a > b ? wide(a) - wide(b) : wide(b) - wide(a);
}

/// Gives each reading of a sensor to the nearest record of the base.
void attach(const Recording& part, const Sensor& sensor, Recording& base) {
    // no further than one and a half steps of the base: a reading in a gap belongs to no record
    const auto reach = static_cast<std::uint64_t>(std::max(1.5e9 * base.period_s, 1.0));
    std::vector<std::uint64_t> shift(base.samples.size(),
                                     std::numeric_limits<std::uint64_t>::max());
    std::size_t lost = 0, total = 0;
    for (const Sample& reading : part.samples) {
        if ((reading.flags & sensor.valid) == 0) continue;
        ++total;
        const auto later =
            std::lower_bound(base.samples.begin(), base.samples.end(), reading.t_ns,
                             [](const Sample& s, std::int64_t t) { return s.t_ns < t; });
        auto nearest = later;
        if (later == base.samples.end() ||
            (later != base.samples.begin() &&
             apart_ns((later - 1)->t_ns, reading.t_ns) <= apart_ns(later->t_ns, reading.t_ns)))
            nearest = later - 1;
        const auto i = static_cast<std::size_t>(nearest - base.samples.begin());
        const std::uint64_t moved = apart_ns(nearest->t_ns, reading.t_ns);
        if (moved > reach || moved >= shift[i]) {
            ++lost;
            continue;
        }
        if ((nearest->flags & sensor.valid) != 0) ++lost;  // a farther reading gives way
        shift[i] = moved;
        (*nearest).*sensor.values = reading.*sensor.values;
        nearest->flags |= sensor.valid;
    }
    std::uint64_t most = 0;
    for (const std::uint64_t s : shift)
        if (s != std::numeric_limits<std::uint64_t>::max()) most = std::max(most, s);
    char text[160];
    std::snprintf(text, sizeof text,
                  "%s: %zu of %zu readings at the records of the gyroscope, moved by %.3f ms at "
                  "most; %zu are left out",
                  sensor.name, total - lost, total, static_cast<double>(most) * 1e-6, lost);
    base.notes.emplace_back(text);
}

void check_overlap(const Recording& base, const Recording& part) {
    if (part.samples.back().t_ns >= base.samples.front().t_ns &&
        part.samples.front().t_ns <= base.samples.back().t_ns)
        return;
    throw BadData("the files do not overlap in time: " + span_of(base) + ", " + span_of(part) +
                  "; were they recorded together, by one clock?");
}

}  // namespace

Recording merged(const std::vector<Recording>& input) {
    std::vector<Recording> parts = input;
    const Recording* base_part = nullptr;
    for (Recording& part : parts) {
        if (part.samples.empty())
            throw BadData(part.name + ": holds poses; only files of sensors are merged");
        sort_by_time(part);
        if (!has(part, sensors[0])) continue;
        if (base_part != nullptr)
            throw BadData("two files hold a gyroscope, " + base_part->name + " and " + part.name);
        base_part = &part;
    }
    if (base_part == nullptr)
        throw BadData("no file holds a gyroscope, whose records the others are merged to");
    Recording base = *base_part;
    base.notes.clear();
    for (const Recording& part : parts)  // what was taken in each file
        for (const std::string& note : part.notes) base.notes.push_back(part.name + ": " + note);
    for (const Recording& part : parts) {
        if (&part == base_part) continue;
        check_overlap(base, part);
        for (const Sensor& sensor : sensors) {
            if (!has(part, sensor)) continue;
            if (has(base, sensor))
                throw BadData("two files hold a " + std::string(sensor.name) + "; the second is " +
                              part.name);
            attach(part, sensor, base);
        }
        if (base.damage.empty()) base.damage = part.damage;
    }
    base.columns.clear();
    return base;
}

}  // namespace fairlead::sim
