#pragma once
// How the lines of a text file are to be read: by the option --columns, by the names in a header
// line, or, without both, by the one known layout that fits the numbers. What is ambiguous is
// refused with the choices. Nothing is guessed silently: `notes` says what was taken.
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/recording/columns.hpp"
#include "host_sim/recording/lines.hpp"
#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

struct Layout {
    Format format{};
    Style style;
    std::vector<Column> columns;     // one per field; units are settled
    std::string header;              // the text of the header line; empty: none
    std::size_t first_line{};        // number of the first record's line
    bool no_times{};                 // times come from --rate or --times
    bool matrix{};                   // columns 0..11 are the rows of a 3 x 4 matrix (KITTI)
    std::vector<std::string> notes;  // what was taken where the file does not say it
};

/// The numbers of the first complete data lines, column by column: what evidence is taken from.
struct Evidence {
    std::size_t rows{};
    std::vector<std::vector<double>> columns;  // NaN: empty or not a number
    std::vector<bool> whole;                   // all numbers of the column are integers
    Fields first;                              // the fields of the first data line
};

/// `sensor_hint`: the sensor of columns named x, y, z alone; Role::bare: not known.
/// Throws BadData with what is ambiguous or missing, and how to go on.
/// `date_column`: the field whose dates were rewritten as seconds; none: npos.
Layout layout_of(std::string_view text, const ReadOptions& options, Role sensor_hint,
                 std::size_t date_column = std::string_view::npos);

/// The sensor that a file's name tells: Gyroscope.csv, accel_1.csv, Magnetometer.csv.
Role sensor_of_name(const std::string& path);

}  // namespace fairlead::sim
