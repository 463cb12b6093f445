#include "host_sim/recording/layout.hpp"

#include <algorithm>

#include "host_sim/recording/bare_layout.hpp"
#include "host_sim/recording/settle.hpp"
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
    settle_vectors(layout.columns, hint, layout.notes);
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
