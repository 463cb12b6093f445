// Which columns are the axes of a sensor, a position or a quaternion.
#include "host_sim/recording/settle.hpp"

#include <algorithm>

namespace fairlead::sim {
namespace {

std::size_t count_role(const std::vector<Column>& columns, Role role) {
    return static_cast<std::size_t>(std::count_if(columns.begin(), columns.end(),
                                                  [&](const Column& c) { return c.role == role; }));
}

void leave_out(std::vector<Column>& columns, Role role) {
    for (Column& c : columns)
        if (c.role == role) set_unused(c);
}

/// Sensors that the units alone tell give way to those that are named.
void settle_by_unit(std::vector<Column>& columns, std::vector<std::string>& notes) {
    for (const Role role : {Role::gyro, Role::accel, Role::mag}) {
        const auto of_role = [&](bool by_unit) {
            return std::count_if(columns.begin(), columns.end(), [&](const Column& c) {
                return c.role == role && c.by_unit == by_unit;
            });
        };
        const auto told = of_role(true);
        const bool use = told == 3 && of_role(false) == 0;
        std::string name;
        for (Column& c : columns) {
            if (c.role != role || !c.by_unit) continue;
            if (name.empty()) name = c.name;
            if (!use) c.role = Role::unknown;
        }
        if (use)
            notes.push_back("column '" + name + "' and its neighbours are taken as the " +
                            to_string(role) + " by their unit; --columns settles it");
    }
}

/// Three numbers of a turn are angles. Beside sensors they would be the reference alone.
void settle_angles(std::vector<Column>& columns, std::vector<std::string>& notes) {
    bool axes[4] = {};
    for (const Column& c : columns)
        if (c.role == Role::quaternion && c.axis >= 0 && c.axis < 4)
            axes[static_cast<std::size_t>(c.axis)] = true;
    if (axes[0] || !axes[1] || !axes[2] || !axes[3]) return;
    if (!has_sensor(columns))
        throw BadData(
            "the rotation has the columns x, y and z and no w: angles are not read. Write "
            "quaternions, or leave the angles out: --columns t_s,px,py,pz,-,-,-");
    leave_out(columns, Role::quaternion);
    notes.emplace_back("the rotation is not used: it has x, y, z and no w, so it is no quaternion");
}

/// An acceleration without gravity is no accelerometer: beside poses alone it is not used.
void settle_free_acceleration(std::vector<Column>& columns, std::vector<std::string>& notes) {
    const bool measured = std::any_of(columns.begin(), columns.end(), [](const Column& c) {
        return c.role == Role::gyro || c.role == Role::mag ||
               (c.role == Role::accel && !c.secondary);
    });
    if (measured || !has(columns, Role::accel) || !has(columns, Role::quaternion)) return;
    leave_out(columns, Role::accel);
    notes.emplace_back("the acceleration is not used: gravity has been taken out of it");
}

/// x, y, z alone: of the sensor that is hinted at, or the position beside a quaternion.
void settle_bare(std::vector<Column>& columns, Role hint) {
    if (!has(columns, Role::bare)) return;
    const bool w = std::any_of(columns.begin(), columns.end(),
                               [](const Column& c) { return c.role == Role::bare && c.axis == 3; });
    Role role = Role::bare;
    if (!w && has(columns, Role::quaternion) && !has(columns, Role::position))
        role = Role::position;
    const bool sensors = has(columns, Role::gyro) || has(columns, Role::accel);
    if (!w && role == Role::bare && !sensors) role = hint;
    if (role == Role::bare)
        throw BadData(
            "the columns x, y, z do not say what they measure; say it: --columns "
            "t_ns,gx,gy,gz (gyroscope), t_ns,ax,ay,az (accelerometer), t_ns,mx,my,mz "
            "(magnetometer), t_ns,px,py,pz (position) or t_ns,...,qx,qy,qz,qw (quaternion)");
    for (Column& c : columns)
        if (c.role == Role::bare) c.role = role;
}

/// acc_0, acc_1, acc_2 or acc_1, acc_2, acc_3 are x, y, z; of quaternions nobody can know.
void settle_numbered(std::vector<Column>& columns, std::vector<std::string>& notes) {
    for (const Role role : {Role::gyro, Role::accel, Role::mag, Role::position, Role::quaternion}) {
        int low = 9;
        for (const Column& c : columns)
            if (c.role == role && c.numbered) low = std::min(low, c.axis);
        if (low == 9) continue;
        if (role == Role::quaternion && has_sensor(columns)) {
            leave_out(columns, role);
            notes.emplace_back(
                "the quaternion is not used: its columns are numbered, and the scalar may be the "
                "first or the last; --columns settles it");
        } else if (role == Role::quaternion) {
            throw BadData(
                "the quaternion's columns are numbered: is the scalar the first or the last? Say "
                "it: --columns t_ns,px,py,pz,qw,qx,qy,qz or ...,qx,qy,qz,qw");
        }
        for (Column& c : columns)
            if (c.role == role && c.numbered) c.axis -= low;
    }
}

/// Two columns of one axis: the better sensor's, or a refusal with the names.
void settle_doubles(std::vector<Column>& columns) {
    for (std::size_t i = 0; i < columns.size(); ++i)
        for (std::size_t j = 0; j < columns.size() && columns[i].axis >= 0; ++j) {
            Column &a = columns[i], &b = columns[j];
            if (i == j || a.role != b.role || a.axis != b.axis || !(a.secondary && !b.secondary))
                continue;
            if (quantity_of(a.role) || a.role == Role::quaternion) set_unused(a);
        }
    for (std::size_t i = 0; i < columns.size(); ++i)
        for (std::size_t j = i + 1; j < columns.size(); ++j) {
            const Column &a = columns[i], &b = columns[j];
            if (a.role != b.role || a.axis != b.axis || a.axis < 0 || a.role == Role::ignored ||
                a.role == Role::unknown)
                continue;
            throw BadData("two columns are named for the " + std::string(to_string(a.role)) +
                          ", '" + a.name + "' and '" + b.name +
                          "'; say which one is meant, with - for the other: --columns t_ns,...");
        }
}

void settle_whole_vectors(const std::vector<Column>& columns) {
    for (const Role role : {Role::gyro, Role::accel, Role::mag, Role::position, Role::quaternion}) {
        const std::size_t n = count_role(columns, role), all = role == Role::quaternion ? 4 : 3;
        bool axes[4] = {};
        for (const Column& c : columns)
            if (c.role == role && c.axis >= 0 && c.axis < 4)
                axes[static_cast<std::size_t>(c.axis)] = true;
        const bool complete = n == all && axes[0] && axes[1] && axes[2] && (all == 3 || axes[3]);
        if (n > 0 && !complete)
            throw BadData("the header names " + std::to_string(n) + " of the " +
                          std::to_string(all) + " columns of the " + to_string(role) +
                          "; name them all, or - for those that are not to be used: --columns");
    }
}

}  // namespace

bool has(const std::vector<Column>& columns, Role role) { return count_role(columns, role) > 0; }

bool has_sensor(const std::vector<Column>& columns) {
    return has(columns, Role::gyro) || has(columns, Role::accel) || has(columns, Role::mag);
}

void settle_vectors(std::vector<Column>& columns, Role hint, std::vector<std::string>& notes) {
    settle_by_unit(columns, notes);
    settle_bare(columns, hint);
    settle_angles(columns, notes);
    settle_numbered(columns, notes);
    settle_doubles(columns);
    settle_free_acceleration(columns, notes);
    settle_whole_vectors(columns);
}

}  // namespace fairlead::sim
