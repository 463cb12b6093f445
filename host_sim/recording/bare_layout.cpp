#include "host_sim/recording/bare_layout.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "host_sim/recording/evidence.hpp"

namespace fairlead::sim {
namespace {

struct Known {
    const char* name;
    const char* columns;  // as --columns takes them
    bool more;            // columns behind these are allowed
    std::function<bool()> fits;
};

/// The tests that a layout's columns must pass.
class Numbering {
  public:
    Numbering(const Table& table, const Evidence& evidence) : table_{table}, evidence_{evidence} {}

    bool gravity(std::size_t i) const {
        const auto& c = evidence_.columns;
        return gravity_unit(length(i)).has_value() && steady_length(c[i], c[i + 1], c[i + 2]);
    }
    bool field(std::size_t i) const { return field_unit(length(i)).has_value(); }
    /// An angular rate in any unit is not as steady as gravity, and seldom of its size.
    bool rate(std::size_t i) const { return length(i) < 1000 && !gravity(i); }
    bool quaternion(std::size_t i) const {
        const auto& c = evidence_.columns;
        return i + 3 < c.size() && unit_quaternions(c[i], c[i + 1], c[i + 2], c[i + 3]);
    }
    /// The column that would be the scalar is small throughout, and the other one large.
    bool scalar_is_elsewhere(std::size_t scalar, std::size_t other) const {
        return typical_size(scalar) < 0.1 && typical_size(other) > 0.9;
    }
    bool matrix(std::size_t first) const {
        if (evidence_.columns.size() < first + 12 || evidence_.rows == 0) return false;
        std::size_t bad = 0;
        for (std::size_t row = 0; row < evidence_.rows; ++row)
            if (!rotation(first, row)) ++bad;
        return 100 * bad <= evidence_.rows;
    }
    std::size_t columns() const { return table_.columns; }
    bool blanks() const { return table_.style.separator == ' '; }
    bool whole_times() const { return evidence_.whole[0]; }

  private:
    double length(std::size_t i) const {
        const auto& c = evidence_.columns;
        return i + 2 < c.size() ? median_length(c[i], c[i + 1], c[i + 2]) : 0;
    }
    double typical_size(std::size_t i) const {
        Numbers sizes = evidence_.columns[i];
        for (double& v : sizes) v = std::fabs(v);
        return median(sizes);
    }
    /// The left 3 x 3 of a 3 x 4 matrix, row by row, is a rotation.
    bool rotation(std::size_t first, std::size_t row) const {
        const auto r = [&](std::size_t i, std::size_t j) {
            return evidence_.columns[first + 4 * i + j][row];
        };
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const double product = r(i, 0) * r(k, 0) + r(i, 1) * r(k, 1) + r(i, 2) * r(k, 2);
                if (!(std::fabs(product - (i == k ? 1 : 0)) < 0.02)) return false;
            }
        return true;
    }

    const Table& table_;
    const Evidence& evidence_;
};

std::vector<Known> known_layouts(const Numbering& n) {
    return {
        {"gyroscope, accelerometer", "t,gx,gy,gz,ax,ay,az", false,
         [&] { return n.rate(1) && n.gravity(4); }},
        {"accelerometer, gyroscope", "t,ax,ay,az,gx,gy,gz", false,
         [&] { return n.gravity(1) && n.rate(4); }},
        {"gyroscope, accelerometer, magnetometer", "t,gx,gy,gz,ax,ay,az,mx,my,mz", false,
         [&] { return n.rate(1) && n.gravity(4) && n.field(7) && !n.gravity(7); }},
        {"accelerometer, gyroscope, magnetometer", "t,ax,ay,az,gx,gy,gz,mx,my,mz", false,
         [&] { return n.gravity(1) && n.rate(4) && n.field(7) && !n.gravity(7); }},
        {"reference, accelerometer, gyroscope, magnetometer (as RepoIMU has them)",
         "t,qw,qx,qy,qz,ax,ay,az,gx,gy,gz,mx,my,mz", false,
         [&] { return n.quaternion(1) && n.gravity(5) && n.rate(8) && n.field(11); }},
        {"TUM, scalar last", "t,px,py,pz,qx,qy,qz,qw", true,
         [&] { return n.blanks() && n.quaternion(4) && !n.scalar_is_elsewhere(7, 4); }},
        // eight columns of CSV may have the scalar first or last, whatever the numbers look like;
        // EuRoC's ground truth, with velocity and biases, is one fixed format of 17
        {"EuRoC ground truth, scalar first", "t,px,py,pz,qw,qx,qy,qz", true,
         [&] {
             return !n.blanks() && n.whole_times() && n.columns() == 17 && n.quaternion(4) &&
                    !n.scalar_is_elsewhere(4, 7);
         }},
    };
}

/// The refusal: what there is, what it might be, and the option that settles it.
[[noreturn]] void refuse(const Table& table, const std::vector<std::string>& fitting,
                         bool quaternion) {
    std::string why = "line " + std::to_string(table.first_number) + ": " +
                      std::to_string(table.columns) + " columns without a header; ";
    if (fitting.size() > 1) {
        why += "several layouts fit the numbers: ";
        for (const std::string& name : fitting) why += name + "; ";
    } else {
        why += quaternion ? "the last four are a quaternion, whose scalar may be first or last; "
                          : "no known layout fits the numbers; ";
    }
    why += "say what the columns are, with - for one that is not used: ";
    switch (table.columns) {
        case 4: why += "--columns t_s,gx,gy,gz"; break;
        case 7: why += "--columns t_ns,gx,gy,gz,ax,ay,az or t_ns,ax,ay,az,gx,gy,gz"; break;
        case 8:
            why +=
                "--columns t_s,px,py,pz,qx,qy,qz,qw or t_s,px,py,pz,qw,qx,qy,qz or "
                "t_ns,gx,gy,gz,ax,ay,az,temperature";
            break;
        case 10: why += "--columns t_ns,gx,gy,gz,ax,ay,az,mx,my,mz"; break;
        default: why += "--columns t_ns,gx,gy,gz,ax,ay,az,..."; break;
    }
    throw BadData(why + "; beside it --units t=us,gyro=deg/s,accel=g where a name has none");
}

Layout matrix_layout(const Table& table, std::size_t first) {
    Layout layout;
    layout.format = Format::kitti;
    layout.matrix = true;
    for (std::size_t i = 0; i < table.columns; ++i) {
        Column column;
        column.role = i < first ? Role::time : Role::unknown;
        column.axis = i < first ? -1 : static_cast<int>(i - first);
        layout.columns.push_back(column);
    }
    layout.notes.emplace_back("taken as KITTI poses: the rows of a 3 x 4 matrix");
    return layout;
}

}  // namespace

Layout bare_layout(const Table& table, const Evidence& evidence, const ReadOptions&) {
    const Numbering numbers{table, evidence};
    if (table.columns == 12 && numbers.matrix(0)) return matrix_layout(table, 0);
    if (table.columns == 13 && numbers.matrix(1)) return matrix_layout(table, 1);
    std::vector<std::string> fitting;
    Layout layout;
    for (const Known& known : known_layouts(numbers)) {
        auto columns = parse_columns(known.columns);
        const bool count =
            known.more ? table.columns >= columns.size() : table.columns == columns.size();
        if (!count || !known.fits()) continue;
        fitting.push_back(std::string(known.name) + " (" + known.columns + ")");
        layout.notes = {std::string("without a header: taken as ") + known.name + " (" +
                        known.columns + "), which alone fits the numbers; --columns settles it"};
        const std::size_t more = table.columns - columns.size();
        columns.resize(table.columns);
        for (Column& c : columns) c.name.clear();
        for (std::size_t i = table.columns - more; i < table.columns; ++i)
            columns[i].role = Role::ignored;
        if (more > 0)
            layout.notes.push_back("the last " + std::to_string(more) + " columns are not used");
        layout.columns = std::move(columns);
    }
    if (fitting.size() != 1) refuse(table, fitting, table.columns == 8 && numbers.quaternion(4));
    return layout;
}

}  // namespace fairlead::sim
