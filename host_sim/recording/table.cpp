#include "host_sim/recording/table.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/recording/decimal.hpp"

namespace fairlead::sim {
namespace {

/// A line with a number in it is a record; a line of words alone is a header.
bool is_record(const Line& line, const Style& style) {
    Fields fields;
    split_fields(line.text, style.separator, fields);
    return std::any_of(fields.begin(), fields.end(), [&](std::string_view f) {
        return is_number(f, style) && f.find_first_of("0123456789") != std::string_view::npos;
    });
}

std::size_t columns_in(const Line& line, const Style& style) {
    Fields fields;
    split_fields(line.text, style.separator, fields);
    return fields.size();
}

/// A line of words that names at least two columns.
bool names_columns(std::string_view text) {
    Fields fields;
    split_fields(text, style_of(text).separator, fields);
    return std::count_if(fields.begin(), fields.end(), [](std::string_view f) {
               const Role role = column_of(f).role;
               return role != Role::unknown && role != Role::ignored;
           }) >= 2;
}

/// As many fields as the user says, or one empty field more.
bool has_columns(const Line& line, const Style& style, std::size_t columns) {
    Fields fields;
    split_fields(line.text, style.separator, fields);
    return fields.size() == columns || (fields.size() == columns + 1 && fields.back().empty());
}

constexpr std::size_t preamble_most = 200;  // lines

/// A header below lines that looked like records: they were a preamble.
bool ends_preamble(const Table& table, const Line& line) {
    if (table.records.size() > preamble_most || is_record(line, style_of(line.text))) return false;
    const auto named = [](const Line& before) { return names_columns(before.text); };
    return names_columns(line.text) &&
           std::none_of(table.before.begin(), table.before.end(), named);
}

/// What looked like records goes to what stands before them.
void set_aside(Table& table) {
    table.before.insert(table.before.end(), table.records.begin(), table.records.end());
    table.preamble = true;
    table.records.clear();
    table.columns = 0;
}

}  // namespace

bool is_separator_line(std::string_view line) {
    return line.size() <= 6 && (line.substr(0, 4) == "sep=" || line.substr(0, 5) == "\"sep=");
}

Table table_of(std::string_view text, std::size_t columns) {
    Table table;
    LineReader reader{text};
    Line line;
    bool trailing = true;
    while (table.records.size() < evidence_rows && reader.next(line)) {
        if (line.comment) {
            if (table.columns == 0) table.before.push_back(line);
            continue;
        }
        if (is_separator_line(line.text)) continue;
        if (table.columns != 0 && ends_preamble(table, line)) set_aside(table);
        if (table.columns == 0) {
            const Style style = style_of(line.text);
            if (!is_record(line, style)) {
                table.before.push_back(line);
                continue;
            }
            if (columns > 0 && table.before.size() < preamble_most &&
                !has_columns(line, style, columns)) {
                table.before.push_back(line);
                table.preamble = true;
                continue;
            }
            table.style = style;
            table.columns = columns_in(line, style);
            table.first_number = line.number;
            if (table.columns > columns_most)
                throw BadData("line " + std::to_string(line.number) + ": " +
                              std::to_string(table.columns) + " columns, at most " +
                              std::to_string(columns_most) + " are read");
        }
        table.records.push_back(line);
        trailing = trailing && line.text.back() == table.style.separator;
    }
    if (columns > 0 && table.columns == 0) return table_of(text);  // no line has so many fields
    // a separator behind the last column of every record is no column
    if (table.columns > 1 && trailing && table.style.separator != ' ') {
        Fields names;
        for (const Line& before : table.before) {
            split_fields(before.text, table.style.separator, names);
            if (names.size() == table.columns && !names.back().empty()) return table;
        }
        --table.columns;
    }
    return table;
}

Evidence evidence_of(const Table& table) {
    Evidence out;
    out.columns.resize(table.columns);
    out.whole.assign(table.columns, true);
    Fields fields;
    std::string storage;
    for (const Line& line : table.records) {
        if (!line.ended && out.rows > 0) continue;  // may be cut
        split_fields(line.text, table.style.separator, fields);
        if (fields.size() < table.columns) continue;
        if (out.first.empty()) out.first = fields;
        ++out.rows;
        for (std::size_t i = 0; i < table.columns; ++i) {
            const std::string_view number = number_text(fields[i], table.style, storage);
            const auto value = real64(number);
            out.columns[i].push_back(value ? *value : double{NAN});
            const auto place = last_place(number);
            if (!number.empty() && (!place || *place < 0)) out.whole[i] = false;
        }
    }
    return out;
}

}  // namespace fairlead::sim
