#include "host_sim/recording/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host_sim/recording/bare_layout.hpp"
#include "host_sim/recording/decimal.hpp"
#include "host_sim/recording/evidence.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/table.hpp"
#include "host_sim/recording/unit_choice.hpp"

namespace fairlead::sim {
namespace {

[[noreturn]] void refuse(std::size_t line, const std::string& why) {
    throw BadData((line > 0 ? "line " + std::to_string(line) + ": " : "") + why);
}

std::size_t recognised(const std::vector<Column>& columns) {
    return static_cast<std::size_t>(std::count_if(
        columns.begin(), columns.end(),
        [](const Column& c) { return c.role != Role::unknown && c.role != Role::ignored; }));
}

std::vector<Column> columns_of(const Fields& fields) {
    std::vector<Column> out;
    for (const std::string_view f : fields) out.push_back(column_of(f));
    return out;
}

/// A header line that has as many names as the data has columns, split by whatever fits.
std::vector<Column> header_columns(std::string_view line, char separator, std::size_t count) {
    for (const char s : {separator, ',', ';', '\t', ' '}) {
        Fields fields;
        split_fields(line, s, fields);
        while (fields.size() > count && fields.back().empty()) fields.pop_back();
        if (fields.size() == count) return columns_of(fields);
    }
    return {};
}

bool says_nothing(std::string_view unit) {
    const std::string plain = plain_unit(unit);
    return plain.empty() || plain == "-" || plain == "1" || plain == "au" || plain == "nounits";
}

/// Units in a line of their own below the header: a line in which a unit fits its column.
void take_unit_line(std::vector<Column>& columns, const Table& table, const Line& header) {
    for (const Line& line : table.before) {
        if (line.number <= header.number) continue;
        Fields fields;
        split_fields(line.text, table.style.separator, fields);
        while (fields.size() > columns.size() && fields.back().empty()) fields.pop_back();
        if (fields.size() != columns.size()) continue;
        const auto unit_at = [&](std::size_t i) {
            const auto quantity = quantity_of(columns[i].role);
            return quantity ? unit_of(*quantity, fields[i]) : std::nullopt;
        };
        bool units = false;
        for (std::size_t i = 0; i < fields.size(); ++i) units = units || unit_at(i);
        for (std::size_t i = 0; units && i < fields.size(); ++i) {
            if (!quantity_of(columns[i].role) || columns[i].unit) continue;
            columns[i].unit = unit_at(i);
            if (!columns[i].unit && !says_nothing(fields[i])) columns[i].unknown_unit = fields[i];
        }
    }
}

/// Names in two lines, as of motion capture: "Rotation, Position" above "X, Y".
void take_line_above(std::vector<Column>& columns, const Table& table, const Line& header) {
    for (std::size_t k = table.before.size(); k-- > 0;) {
        const Line& line = table.before[k];
        if (line.number >= header.number) continue;
        Fields fields;
        split_fields(line.text, table.style.separator, fields);
        if (fields.size() != columns.size()) continue;
        for (std::size_t i = 0; i < fields.size(); ++i) {
            if (columns[i].role != Role::bare || fields[i].empty()) continue;
            const Column both = column_of(std::string(fields[i]) + " " + columns[i].name);
            if (both.axis >= 0 && (quantity_of(both.role) || both.role == Role::quaternion))
                columns[i] = both;
        }
    }
}

/// "Length Units,Millimeters" in a preamble.
void take_length_unit(std::vector<Column>& columns, const Table& table,
                      std::vector<std::string>& notes) {
    for (const Line& line : table.before) {
        Fields fields;
        split_fields(line.text, table.style.separator, fields);
        for (std::size_t i = 0; i + 1 < fields.size(); ++i) {
            if (fields[i] != "Length Units" && fields[i] != "length_units") continue;
            const auto unit = unit_of(Quantity::position, fields[i + 1]);
            for (Column& c : columns)
                if (c.role == Role::position && !c.unit) c.unit = unit;
            if (unit) notes.push_back("positions are in " + unit->name + ", as the preamble says");
        }
    }
}

struct Header {
    std::vector<Column> columns;
    Line line;
};

/// The line before the data that names most of the columns. Empty: there is none.
Header header_of(const Table& table) {
    Header best;
    for (const Line& line : table.before) {
        auto columns = header_columns(line.text, table.style.separator, table.columns);
        const std::size_t n = recognised(columns);
        if (n > recognised(best.columns) && n >= std::min<std::size_t>(2, table.columns))
            best = {std::move(columns), line};
    }
    if (!best.columns.empty()) {
        take_unit_line(best.columns, table, best.line);
        take_line_above(best.columns, table, best.line);
        return best;
    }
    for (const Line& line : table.before) {
        Fields fields;
        split_fields(line.text, style_of(line.text).separator, fields);
        const std::size_t n = recognised(columns_of(fields));
        if (n >= 4 || (!line.comment && n >= 2))
            refuse(line.number, "this header names " + std::to_string(fields.size()) +
                                    " columns, but line " + std::to_string(table.first_number) +
                                    " has " + std::to_string(table.columns) +
                                    "; mend the header, or say what the columns are: --columns " +
                                    "t_ns,gx,gy,gz,ax,ay,az");
        if (!line.comment && !table.preamble)
            refuse(line.number, "none of these names is known ('" + std::string(line.text) +
                                    "'); say what the columns are: --columns t_ns,gx,gy,gz,ax,...");
    }
    return best;
}

std::size_t count_role(const std::vector<Column>& columns, Role role) {
    return static_cast<std::size_t>(std::count_if(columns.begin(), columns.end(),
                                                  [&](const Column& c) { return c.role == role; }));
}

bool has(const std::vector<Column>& columns, Role role) { return count_role(columns, role) > 0; }

void set_unused(Column& column) { column.role = Role::ignored; }

bool has_sensor(const std::vector<Column>& columns) {
    return has(columns, Role::gyro) || has(columns, Role::accel) || has(columns, Role::mag);
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

/// Of several columns of time those that hold no clock: no numbers, or numbers that stand still.
void set_dead_times_aside(std::vector<Column>& columns, const Evidence& evidence,
                          std::vector<std::string>& notes) {
    const auto is_time = [](const Column& c) {
        return c.role == Role::time || c.role == Role::time_rest;
    };
    std::vector<std::size_t> dead;
    std::size_t live = 0;
    for (std::size_t i = 0; i < columns.size(); ++i)
        if (is_time(columns[i]))
            typical_step(evidence.columns[i]) > 0 ? void(++live) : dead.push_back(i);
    if (evidence.rows < 2 || live + dead.size() < 2) return;
    const bool seconds = std::any_of(columns.begin(), columns.end(),
                                     [](const Column& c) { return c.role == Role::time_rest; });
    for (const std::size_t i : dead) {
        // the seconds beside nanoseconds stand still in a short file
        if (seconds && std::isfinite(median(evidence.columns[i]))) continue;
        if (live == 0 && i == dead.front()) continue;  // it is told what is wrong with the first
        set_unused(columns[i]);
        notes.push_back("column '" + columns[i].name + "' is not used: it holds no clock");
    }
}

/// Whole seconds and the nanoseconds beside them, as one column of numbers.
Numbers joined_times(const Evidence& evidence, std::size_t seconds, std::size_t rest) {
    Numbers out = evidence.columns[seconds];
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += 1e-9 * evidence.columns[rest][i];
    return out;
}

/// One clock in two units: the steps are a power of a thousand apart.
bool one_clock(const Numbers& a, const Numbers& b) {
    const double ratio = std::log10(typical_step(a) / typical_step(b)) / 3;
    return std::fabs(ratio - std::round(ratio)) < 1e-3;
}

[[noreturn]] void refuse_two_clocks(const Column& a, const Column& b) {
    throw BadData("two columns are times, '" + a.name + "' and '" + b.name +
                  "', and they do not agree; say which one is meant, with - for the other: "
                  "--columns t_ns,-,...");
}

/// Several columns of time: seconds and nanoseconds, or columns that say the same.
void settle_times(std::vector<Column>& columns, const Evidence& evidence,
                  std::vector<std::string>& notes) {
    const auto at = [&](Role role) {
        std::vector<std::size_t> out;
        for (std::size_t i = 0; i < columns.size(); ++i)
            if (columns[i].role == role) out.push_back(i);
        return out;
    };
    set_dead_times_aside(columns, evidence, notes);
    const auto rest = at(Role::time_rest);
    auto times = at(Role::time);
    const auto pair = std::find_if(times.begin(), times.end(), [&](std::size_t i) {
        return columns[i].unit && columns[i].unit->name == "s" && evidence.whole[i];
    });
    if (rest.size() == 1 && pair != times.end()) {  // a complete stamp
        const Numbers stamp = joined_times(evidence, *pair, rest[0]);
        for (const std::size_t i : times) {
            if (i == *pair) continue;
            if (!one_clock(evidence.columns[i], stamp))
                refuse_two_clocks(columns[*pair], columns[i]);
            set_unused(columns[i]);
            notes.push_back("times are those of columns '" + columns[*pair].name + "' and '" +
                            columns[rest[0]].name + "'");
        }
        return;
    }
    for (const std::size_t i : rest) columns[i].role = Role::time;
    times = at(Role::time);
    if (times.size() < 2) return;
    for (std::size_t k = 1; k < times.size(); ++k)
        if (!one_clock(evidence.columns[times[0]], evidence.columns[times[k]]))
            refuse_two_clocks(columns[times[0]], columns[times[k]]);
    // the time of the measurement before that of its arrival; then the finer one
    const auto rank = [&](std::size_t i) {
        const std::string& name = columns[i].name;
        const bool measured = name.find("header") != name.npos || name.find("sample") != name.npos;
        const double step = evidence.whole[i] ? typical_step(evidence.columns[i]) : 0;
        return std::pair{measured, step};
    };
    const auto finer = std::max_element(times.begin(), times.end(),
                                        [&](auto a, auto b) { return rank(a) < rank(b); });
    for (const std::size_t i : times)
        if (i != *finer) set_unused(columns[i]);
    notes.push_back("times are those of column '" + columns[*finer].name + "'");
}

void note_unused(const std::vector<Column>& columns, std::vector<std::string>& notes) {
    std::string names;
    std::size_t count = 0;
    for (const Column& c : columns) {
        if (c.role != Role::unknown || c.name.empty() || c.name == "-") continue;
        if (++count <= 6) names += (names.empty() ? "" : ", ") + c.name;
    }
    if (count > 6) names += ", and " + std::to_string(count - 6) + " more";
    if (count > 0) notes.push_back("columns that are not used: " + names);
}

void settle(Layout& layout, const Evidence& evidence, const ReadOptions& options, Role hint) {
    settle_by_unit(layout.columns, layout.notes);
    settle_bare(layout.columns, hint);
    settle_angles(layout.columns, layout.notes);
    settle_numbered(layout.columns, layout.notes);
    settle_doubles(layout.columns);
    settle_free_acceleration(layout.columns, layout.notes);
    settle_whole_vectors(layout.columns);
    settle_times(layout.columns, evidence, layout.notes);
    note_unused(layout.columns, layout.notes);
    const auto any = [&](std::initializer_list<Role> roles) {
        return std::any_of(roles.begin(), roles.end(),
                           [&](Role r) { return has(layout.columns, r); });
    };
    const bool imu = any({Role::gyro, Role::accel, Role::mag});
    if (!imu && !layout.matrix && !any({Role::position, Role::quaternion}))
        throw BadData(
            "no column of a sensor or a pose is named; say what the columns are: "
            "--columns t_ns,gx,gy,gz,ax,ay,az or t_ns,px,py,pz,qw,qx,qy,qz");
    layout.no_times = !has(layout.columns, Role::time);
    const bool replaced = options.rate_hz > 0 || !options.times.empty();
    if (layout.no_times && !replaced)
        throw BadData(
            "the records have no times: no column is named as one; say which column it is, "
            "--columns t_s,..., or give times: --rate HZ, or --times FILE with one time a line");
    if (replaced) {
        for (Column& c : layout.columns)
            if (c.role == Role::time || c.role == Role::time_rest) set_unused(c);
        if (!layout.no_times) layout.notes.emplace_back("the times of the file are not used");
        layout.no_times = true;
    }
    if (!layout.matrix) {
        const bool blanks = layout.style.separator == ' ';
        layout.format = imu ? Format::imu_text : blanks ? Format::tum : Format::pose_text;
    }
}

/// The column whose dates were rewritten is a time in seconds, whatever its name.
void take_dates(std::vector<Column>& columns, std::size_t at) {
    Column& c = columns[at];
    const bool other = has(columns, Role::time) && c.role != Role::time;
    if (other || (c.role != Role::time && c.role != Role::unknown)) return;
    c.role = Role::time;
    c.unit = *unit_of(Quantity::time, "s");
    c.unknown_unit.clear();
}

Layout by_option(const Table& table, const ReadOptions& options) {
    Layout layout;
    layout.columns = parse_columns(options.columns);
    if (layout.columns.size() != table.columns)
        refuse(table.first_number,
               std::to_string(table.columns) + " columns, but --columns names " +
                   std::to_string(layout.columns.size()) + "; name each, - for one to leave out");
    return layout;
}

}  // namespace

Layout layout_of(std::string_view text, const ReadOptions& options, Role sensor_hint,
                 std::size_t date_column) {
    const std::size_t named = options.columns.empty() ? 0 : split(options.columns, ',').size();
    const Table table = table_of(text, named);
    if (table.columns == 0) {
        if (!table.before.empty() && !table.before.front().comment)
            refuse(table.before.front().number,
                   "no line of numbers follows; a recording is a table, one record a line: write a "
                   "line of names, and below it the numbers alone, separated by commas");
        return {};
    }
    const Evidence evidence = evidence_of(table);
    Layout layout;
    Header header;
    if (!options.columns.empty()) {
        layout = by_option(table, options);
    } else {
        header = header_of(table);
        if (header.columns.empty())
            layout = bare_layout(table, evidence, options);
        else
            layout.columns = header.columns;
    }
    layout.style = table.style;
    layout.first_line = table.first_number;
    if (!header.columns.empty() && !header.line.comment)
        layout.header = header.line.text;  // to pass over where it is repeated
    if (table.preamble) {
        take_length_unit(layout.columns, table, layout.notes);
        layout.notes.push_back("the lines before line " + std::to_string(table.first_number) +
                               " are taken as a preamble, not as records");
    }
    if (date_column < layout.columns.size()) take_dates(layout.columns, date_column);
    settle(layout, evidence, options, sensor_hint);
    settle_units(layout, evidence, options);
    return layout;
}

Role sensor_of_name(const std::string& path) {
    const Column column = column_of(stem_of(path) + "_x");
    const bool sensor =
        column.role == Role::gyro || column.role == Role::accel || column.role == Role::mag;
    return sensor && !column.secondary ? column.role : Role::bare;
}

}  // namespace fairlead::sim
