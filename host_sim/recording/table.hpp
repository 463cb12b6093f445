#pragma once
// A first look at a text file: how its lines are split, what stands before the numbers, and the
// numbers of the first records as evidence.
#include <string_view>
#include <vector>

#include "host_sim/recording/layout.hpp"
#include "host_sim/recording/lines.hpp"

namespace fairlead::sim {

struct Table {
    Style style;
    std::vector<Line> before;    // comments and lines of words before the first record
    std::vector<Line> records;   // the first records, at most evidence_rows
    std::size_t columns{};       // of the first record; 0: the file holds none
    std::size_t first_number{};  // its line
    bool preamble{};             // lines with numbers stand in `before`
};

inline constexpr std::size_t evidence_rows = 4096, columns_most = 4096;

/// `columns`: of the records, where the user says it; else 0. Lines before the header that hold
/// numbers too, or have another number of fields, are a preamble, as many loggers write one.
Table table_of(std::string_view text, std::size_t columns = 0);
Evidence evidence_of(const Table& table);

/// "sep=;", by which spreadsheets name the separator.
bool is_separator_line(std::string_view line);

}  // namespace fairlead::sim
