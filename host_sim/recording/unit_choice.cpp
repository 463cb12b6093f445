#include "host_sim/recording/unit_choice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/recording/decimal.hpp"
#include "host_sim/recording/evidence.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

using Given = std::array<std::optional<Unit>, quantities>;

constexpr std::array<Quantity, quantities> all_quantities{
    Quantity::time, Quantity::gyro,     Quantity::accel,
    Quantity::mag,  Quantity::position, Quantity::temperature};

/// --units t=us,gyro=deg/s
Given given_units(const std::string& text) {
    Given out;
    if (text.empty()) return out;
    for (const std::string& item : split(text, ',')) {
        const auto equals = item.find('=');
        const std::string name = item.substr(0, equals);
        const auto quantity = std::find_if(all_quantities.begin(), all_quantities.end(),
                                           [&](Quantity q) { return name == to_string(q); });
        if (equals == std::string::npos || quantity == all_quantities.end())
            throw BadSpec("--units: '" + item +
                          "' is not NAME=UNIT; names are t, gyro, accel, mag, position, "
                          "temperature");
        const auto unit = unit_of(*quantity, item.substr(equals + 1));
        if (!unit)
            throw BadSpec("--units: '" + item.substr(equals + 1) + "' is no unit of " + name +
                          "; known are " + known_units(*quantity));
        out[static_cast<std::size_t>(*quantity)] = unit;
    }
    return out;
}

std::string text(const char* format, double value) {
    char line[128];
    std::snprintf(line, sizeof line, format, value);
    return line;
}

class Chooser {
  public:
    Chooser(Layout& layout, const Evidence& evidence, const ReadOptions& options)
        : layout_{layout}, evidence_{evidence}, given_{given_units(options.units)} {}

    void settle() {
        take_given();
        refuse_unknown();
        settle_time();
        settle_accel();
        settle_gyro();
        settle_simple(Role::mag, Quantity::mag, "the field's size");
        settle_simple(Role::position, Quantity::position, "");
        settle_simple(Role::temperature, Quantity::temperature, "");
    }

  private:
    /// Index of the column of a role and axis; the number of columns: there is none.
    std::size_t at(Role role, int axis) const {
        for (std::size_t i = 0; i < layout_.columns.size(); ++i)
            if (layout_.columns[i].role == role && (axis < 0 || layout_.columns[i].axis == axis))
                return i;
        return layout_.columns.size();
    }
    bool has(Role role) const { return at(role, -1) < layout_.columns.size(); }

    /// The quantity is there, and no column of it says its unit.
    bool open(Role role) const {
        const std::size_t first = at(role, -1);
        return first < layout_.columns.size() &&
               std::none_of(layout_.columns.begin(), layout_.columns.end(),
                            [&](const Column& c) { return c.role == role && c.unit; });
    }

    void set(Role role, const Unit& unit) {
        for (Column& c : layout_.columns)
            if (c.role == role) c.unit = unit;
    }

    /// One axis with a unit speaks for all three: "gx [deg/s],gy,gz".
    void spread(Role role) {
        std::optional<Unit> unit;
        for (const Column& c : layout_.columns)
            if (c.role == role && c.unit) {
                if (unit && unit->name != c.unit->name)
                    throw BadData("the columns of the " + std::string(to_string(role)) +
                                  " name two units, " + unit->name + " and " + c.unit->name +
                                  "; settle it by --units");
                unit = c.unit;
            }
        if (unit) set(role, *unit);
    }

    void take_given() {
        for (const Role role : {Role::gyro, Role::accel, Role::mag, Role::position}) spread(role);
        for (const Role role :
             {Role::time, Role::gyro, Role::accel, Role::mag, Role::position, Role::temperature}) {
            const auto& unit = given_[static_cast<std::size_t>(*quantity_of(role))];
            if (!unit) continue;
            if (has(role)) set(role, *unit);
            for (Column& c : layout_.columns)
                if (c.role == role) c.unknown_unit.clear();
        }
    }

    void refuse_unknown() const {
        for (const Column& c : layout_.columns) {
            const auto quantity = quantity_of(c.role);
            if (c.unknown_unit.empty() || !quantity || c.unit) continue;
            throw BadData("column '" + c.name + "': '" + c.unknown_unit + "' is no known unit of " +
                          to_string(*quantity) + "; say it: --units " + to_string(*quantity) +
                          "=UNIT, one of " + known_units(*quantity));
        }
    }

    void settle_time() {
        if (layout_.no_times || !open(Role::time)) return;
        const std::size_t column = at(Role::time, -1);
        const Numbers& times = evidence_.columns[column];
        const bool imu = has(Role::gyro) || has(Role::accel) || has(Role::mag);
        const auto stamps =
            std::count_if(times.begin(), times.end(), [](double t) { return std::isfinite(t); });
        if (stamps < 2) return set(Role::time, default_time(column));
        std::string rates;
        const auto unit = time_unit(times, imu ? imu_rates : pose_rates, rates);
        const std::string where = layout_.columns[column].name.empty()
                                      ? "column 1"
                                      : "column '" + layout_.columns[column].name + "'";
        if (!unit && typical_step(times) == 0) refuse_standing(column, where);
        if (!unit)
            throw BadData("the unit of the times in " + where + " is not named, and " +
                          "the rate does not tell it (" + rates + "); say it: --units t=ns, " +
                          "t=us, t=ms, t=s or a power of ten of a second, as t=1e-4");
        set(Role::time, *unit);
        layout_.notes.push_back("times in " + where + " are taken as " + unit->name +
                                text(", %.4g Hz", rate_hz(times, *unit)) +
                                "; --units t=UNIT settles it");
    }

    [[noreturn]] void refuse_standing(std::size_t column, const std::string& where) const {
        const auto place = last_place(evidence_.first[column]);
        throw BadData(
            "the times in " + where + " stand still: the first is '" +
            std::string(evidence_.first[column]) + "'" +
            (place && *place > 0 ? text(", written in steps of %g", std::pow(10.0, *place)) : "") +
            "; write them with all digits, or give the rate: --rate HZ");
    }

    /// Of one record alone: what the form of the number says.
    Unit default_time(std::size_t column) const {
        return *unit_of(Quantity::time,
                        evidence_.whole[column] && layout_.style.separator != ' ' ? "ns" : "s");
    }

    static double rate_hz(const Numbers& times, const Unit& unit) {
        const double step = typical_step(times) * std::pow(10.0, unit.time_shift - 9);
        return step > 0 ? 1 / step : 0;
    }

    double length(Role role) const {
        return median_length(evidence_.columns[at(role, 0)], evidence_.columns[at(role, 1)],
                             evidence_.columns[at(role, 2)]);
    }

    void settle_accel() {
        accel_open_ = open(Role::accel);
        if (!accel_open_) return;
        const double g = length(Role::accel);
        const auto unit = gravity_unit(g);
        set(Role::accel, unit ? *unit : own_unit(Quantity::accel));
        if (unit && unit->name == "m/s2") return;
        layout_.notes.push_back(text("the accelerometer's unit is not named; its median length is "
                                     "%.4g, ",
                                     g) +
                                (unit ? "taken as gravity in " + unit->name
                                      : std::string("taken as m/s2, though it is not gravity")) +
                                "; --units accel=UNIT settles it");
    }

    /// The angular rate as the turning of gravity tells it; empty: not to be told.
    std::optional<double> factor_by_turning() const {
        if (!has(Role::accel) || !has(Role::time) || layout_.no_times) return {};
        const Unit &time = *layout_.columns[at(Role::time, -1)].unit,
                   &accel = *layout_.columns[at(Role::accel, 0)].unit;
        const Numbers& stamps = evidence_.columns[at(Role::time, -1)];
        std::vector<double> t_s;
        for (const double t : stamps)
            t_s.push_back((t - stamps.front()) * std::pow(10.0, time.time_shift - 9));
        std::vector<Numbers> gyro, force;
        for (int axis = 0; axis < 3; ++axis) {
            gyro.push_back(evidence_.columns[at(Role::gyro, axis)]);
            force.push_back(evidence_.columns[at(Role::accel, axis)]);
            for (double& a : force.back()) a *= accel.factor;
        }
        return turning_factor(t_s, gyro, force);
    }

    void settle_gyro() {
        if (!open(Role::gyro)) return;
        const auto factor = factor_by_turning();
        const double deg = unit_of(Quantity::gyro, "deg/s")->factor;
        const auto near = [&](double unit) {
            return factor && *factor > 0.6 * unit && *factor < 1.6 * unit;
        };
        if (near(1)) return set(Role::gyro, own_unit(Quantity::gyro));
        const std::string option = "; --units gyro=rad/s or gyro=deg/s settles it";
        if (near(deg)) {
            set(Role::gyro, *unit_of(Quantity::gyro, "deg/s"));
            layout_.notes.push_back(
                "the gyroscope's unit is not named; gravity turns as it does for deg/s" + option);
            return;
        }
        const double typical = length(Role::gyro);
        const bool si = !has(Role::accel) || layout_.columns[at(Role::accel, 0)].unit->factor == 1;
        if (!si || typical > 10)
            throw BadData("the gyroscope's unit is not named" +
                          text(", its median length is %.4g", typical) +
                          (si ? "" : ", and the accelerometer is not in m/s2") +
                          "; say it: --units gyro=rad/s or --units gyro=deg/s");
        set(Role::gyro, own_unit(Quantity::gyro));
        layout_.notes.push_back("the gyroscope's unit is not named; taken as rad/s" + option);
    }

    void settle_simple(Role role, Quantity quantity, const std::string& evidence) {
        if (!open(role)) return;
        Unit unit = own_unit(quantity);
        const bool field = role == Role::mag;
        if (const auto fitting = field ? field_unit(length(role)) : std::nullopt) unit = *fitting;
        if (role == Role::temperature) {
            const double t = median(evidence_.columns[at(role, -1)]);
            if (t > 240 && t < 360) unit = *unit_of(Quantity::temperature, "K");
        }
        set(role, unit);
        if (role == Role::position || (field && unit.factor == 1)) return;
        layout_.notes.push_back("the unit of the " + std::string(to_string(role)) +
                                " is not named; taken as " + unit.name +
                                (evidence.empty() ? "" : " by " + evidence) + "; --units " +
                                to_string(quantity) + "=UNIT settles it");
    }

    Layout& layout_;
    const Evidence& evidence_;
    Given given_;
    bool accel_open_{};
};

}  // namespace

void settle_units(Layout& layout, const Evidence& evidence, const ReadOptions& options) {
    Chooser{layout, evidence, options}.settle();
}

}  // namespace fairlead::sim
