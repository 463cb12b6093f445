#include "host_sim/recording/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fairlead/math/quat.hpp"
#include "host_sim/recording/calendar.hpp"
#include "host_sim/recording/decimal.hpp"
#include "host_sim/recording/encoding.hpp"
#include "host_sim/recording/layout.hpp"
#include "host_sim/recording/lines.hpp"
#include "host_sim/recording/stamps.hpp"
#include "host_sim/recording/table.hpp"

namespace fairlead::sim {
namespace {

struct FieldError {
    std::size_t column;
    std::string why;
};

/// Marks that stand for a value that is not there.
bool is_missing(std::string_view field) {
    for (const char* mark :
         {"", "nan", "NaN", "NAN", "na", "NA", "N/A", "n/a", "null", "NULL", "None", "-", "--"})
        if (field == mark) return true;
    return false;
}

/// The columns of one vector, and their factor.
struct Triple {
    std::array<std::size_t, 4> at{};
    std::size_t size{};
    double factor{1}, offset{};
    bool present() const { return size > 0; }
};

class RowReader {
  public:
    explicit RowReader(const Layout& layout) : layout_{layout} {
        for (std::size_t i = 0; i < layout.columns.size(); ++i) {
            const Column& c = layout.columns[i];
            if (layout.matrix && c.role == Role::unknown) continue;
            if (c.role == Role::time) time_ = i, has_time_ = true;
            if (c.role == Role::time_rest) rest_ = i, has_rest_ = true;
            take(Role::gyro, gyro_, i);
            take(Role::accel, accel_, i);
            take(Role::mag, mag_, i);
            take(Role::position, position_, i);
            take(Role::quaternion, quaternion_, i);
            take(Role::temperature, temperature_, i);
            take(Role::clipped, clipped_, i);
            take(Role::gap, gap_, i);
            take(Role::moving, moving_, i);
        }
    }

    bool imu() const { return gyro_.present() || accel_.present() || mag_.present(); }
    bool reference() const { return position_.present() || quaternion_.present(); }

    void read(const Fields& fields, Recording& out) {
        const std::int64_t t_ns = has_time_ ? time_of(fields) : 0;
        if (layout_.matrix) return out.poses.push_back(matrix_pose(fields, t_ns));
        if (!imu()) return out.poses.push_back(pose_of(fields, t_ns));
        out.samples.push_back(sample_of(fields, t_ns));
        if (!reference() && !moving_.present()) return;
        out.truth.push_back(pose_of(fields, t_ns));
        out.moving.push_back(moving_.present() && fields[moving_.at[0]] == "1" ? 1 : 0);
    }

  private:
    void take(Role role, Triple& triple, std::size_t i) {
        const Column& c = layout_.columns[i];
        if (c.role != role) return;
        triple.at[static_cast<std::size_t>(std::max(c.axis, 0))] = i;
        ++triple.size;
        if (c.unit) triple.factor = c.unit->factor, triple.offset = c.unit->offset;
    }

    std::string_view number(const Fields& fields, std::size_t i) {
        return number_text(fields[i], layout_.style, storage_);
    }

    std::int64_t stamp(const Fields& fields, std::size_t i, int shift) {
        const auto value = scaled_integer(number(fields, i), shift);
        if (value) return *value;
        const bool date = fields[i].find_first_of(":/") != std::string_view::npos;
        throw FieldError{
            i, "is not a time in " + layout_.columns[i].unit->name +
                   (date ? ": dates are read as 2023-05-01T12:34:56.789, 01-May-2023 12:34:56.789 "
                           "or 12:34:56.789 alone"
                         : ", a decimal number within 292 years of zero") +
                   "; --rate HZ or --times FILE gives other times"};
    }

    std::int64_t time_of(const Fields& fields) {
        const std::int64_t t = stamp(fields, time_, layout_.columns[time_].unit->time_shift);
        if (!has_rest_) return t;
        const std::int64_t rest = stamp(fields, rest_, 0);
        if (rest < 0 || rest > 999999999)
            throw FieldError{rest_, "is not a count of nanoseconds below 1 s"};
        if (t > INT64_MAX - rest) throw FieldError{time_, "is a time beyond 292 years"};
        return t + rest;
    }

    float real(const Fields& fields, std::size_t i, const Triple& triple) {
        const std::string_view text = number(fields, i);
        if (triple.factor == 1 && triple.offset == 0) {
            if (const auto value = real32(text)) return *value;
        } else if (const auto value = real64(text)) {
            return static_cast<float>(*value * triple.factor + triple.offset);
        }
        throw FieldError{i, "is not a number"};
    }

    static bool missing(const Fields& fields, const Triple& triple) {
        for (std::size_t k = 0; k < triple.size; ++k)
            if (!is_missing(fields[triple.at[k]])) return false;
        return true;
    }

    /// False: the sensor has no measurement in this record.
    bool vector(const Fields& fields, const Triple& triple, Vec3& out) {
        if (!triple.present() || missing(fields, triple)) return false;
        const auto at = [&](std::size_t k) { return real(fields, triple.at[k], triple); };
        out = {at(0), at(1), at(2)};
        return true;
    }

    Sample sample_of(const Fields& fields, std::int64_t t_ns) {
        Sample s;
        s.t_ns = t_ns;
        if (vector(fields, gyro_, s.gyro_rad_s)) s.flags |= flag::gyro_valid;
        if (vector(fields, accel_, s.accel_m_s2)) s.flags |= flag::accel_valid;
        if (vector(fields, mag_, s.mag_uT)) s.flags |= flag::mag_valid;
        if (temperature_.present() && !missing(fields, temperature_)) {
            s.temperature_c = real(fields, temperature_.at[0], temperature_);
            s.flags |= flag::temperature_valid;
        }
        if (clipped_.present()) s.flags |= clipped_flags(fields[clipped_.at[0]]);
        if (gap_.present() && fields[gap_.at[0]] == "1") s.flags |= flag::gap_before;
        return s;
    }

    std::uint32_t clipped_flags(std::string_view letters) const {
        std::uint32_t flags = 0;
        for (const char c : letters) {
            if (c == 'g')
                flags |= flag::gyro_clipped;
            else if (c == 'a')
                flags |= flag::accel_clipped;
            else if (c == 'm')
                flags |= flag::mag_clipped;
            else
                throw FieldError{clipped_.at[0], "is not a choice of the letters g, a and m"};
        }
        return flags != 0 ? flags | flag::clipped : 0;
    }

    Pose pose_of(const Fields& fields, std::int64_t t_ns) {
        Pose pose;
        pose.t_ns = t_ns;
        if (vector(fields, position_, pose.p_w_m)) pose.flags |= flag::position_valid;
        if (quaternion_.present() && !missing(fields, quaternion_)) {
            const auto at = [&](std::size_t k) {
                return real(fields, quaternion_.at[k], quaternion_);
            };
            pose.q_wb = {at(0), at(1), at(2), at(3)};
            pose.flags |= flag::orientation_valid;
        }
        return pose;
    }

    Pose matrix_pose(const Fields& fields, std::int64_t t_ns) {
        const std::size_t first = layout_.columns.size() - 12;
        std::array<std::array<double, 4>, 3> m{};
        for (std::size_t k = 0; k < 12; ++k) {
            const auto value = real64(number(fields, first + k));
            if (!value) throw FieldError{first + k, "is not a number"};
            m[k / 4][k % 4] = *value;
        }
        Pose pose;
        pose.t_ns = t_ns;
        pose.flags = flag::position_valid | flag::orientation_valid;
        pose.p_w_m = {static_cast<float>(m[0][3]), static_cast<float>(m[1][3]),
                      static_cast<float>(m[2][3])};
        pose.q_wb = quaternion_of(m);
        return pose;
    }

    /// The largest of the four components first, so that no root of a small number divides.
    static Quat quaternion_of(const std::array<std::array<double, 4>, 3>& m) {
        const double t = m[0][0] + m[1][1] + m[2][2];
        std::array<double, 4> q{};  // w, x, y, z
        if (t > 0) {
            q = {1 + t, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]};
        } else {
            std::size_t i = m[1][1] > m[0][0] ? 1 : 0;
            if (m[2][2] > m[i][i]) i = 2;
            const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
            q[0] = m[k][j] - m[j][k];
            q[1 + i] = 1 + m[i][i] - m[j][j] - m[k][k];
            q[1 + j] = m[j][i] + m[i][j];
            q[1 + k] = m[k][i] + m[i][k];
        }
        const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        return {static_cast<float>(q[0] / n), static_cast<float>(q[1] / n),
                static_cast<float>(q[2] / n), static_cast<float>(q[3] / n)};
    }

    const Layout& layout_;
    std::size_t time_{}, rest_{};
    bool has_time_{}, has_rest_{};
    Triple gyro_, accel_, mag_, position_, quaternion_, temperature_, clipped_, gap_, moving_;
    std::string storage_;
};

[[noreturn]] void refuse(std::size_t line, const Layout& layout, const Fields& fields,
                         const FieldError& error) {
    const std::string& name = layout.columns[error.column].name;
    std::string found(fields[error.column].substr(0, 40));
    throw BadData("line " + std::to_string(line) + ", column " + std::to_string(error.column + 1) +
                  (name.empty() ? "" : " (" + name + ")") + ": '" + found + "' " + error.why +
                  "; --salvage uses the records before it");
}

void check_count(const Line& line, const Layout& layout, Fields& fields) {
    while (fields.size() > layout.columns.size() && fields.back().empty()) fields.pop_back();
    if (fields.size() == layout.columns.size()) return;
    throw BadData("line " + std::to_string(line.number) + ": " + std::to_string(fields.size()) +
                  (fields.size() == 1 ? " column" : " columns") + ", expected " +
                  std::to_string(layout.columns.size()) + "; --salvage uses the records before it");
}

std::string described(const Layout& layout) {
    std::string out;
    for (const Column& c : layout.columns) {
        out += (out.empty() ? "" : ",") + short_name(c);
        const bool vector = c.role != Role::time && c.role != Role::time_rest;
        if (c.unit && vector && (c.unit->factor != 1 || c.unit->offset != 0))
            out += "[" + c.unit->name + "]";
    }
    return layout.matrix ? "the rows of a 3 x 4 matrix" : out;
}

void note_resolution(const Layout& layout, const Fields& fields, Recording& recording) {
    // a first row may have more fields than there are columns: it is refused later
    for (std::size_t i = 0; i < std::min(fields.size(), layout.columns.size()); ++i) {
        const Column& c = layout.columns[i];
        if (c.role != Role::time || fields[i].find_first_of("eE") == std::string_view::npos)
            continue;
        std::string storage;
        const auto place = last_place(number_text(fields[i], layout.style, storage));
        if (!place || *place + c.unit->time_shift < 3) continue;
        recording.notes.push_back(
            "times are written with an exponent, as spreadsheets do, in steps of 1e" +
            std::to_string(*place + c.unit->time_shift - 9) +
            " s: what is finer is lost; export them as text to keep it");
    }
}

void read_rows(std::string_view text, const Layout& layout, const ReadOptions& options,
               Recording& recording) {
    RowReader rows{layout};
    if (rows.imu() && rows.reference()) {
        recording.notes.emplace_back("the poses beside the sensors are kept as the reference");
        recording.frame = ReferenceFrame::level;
    }
    LineReader reader{text};
    Line line;
    Fields fields;
    bool first = true;
    while (reader.next(line)) {
        if (line.number < layout.first_line) continue;
        if (line.comment || is_separator_line(line.text)) continue;
        if (options.progress && recording.size() % 256 == 0)
            options.progress(static_cast<std::size_t>(line.text.data() - text.data()), text.size());
        if (line.text.find('\0') != std::string_view::npos)
            throw BadData("line " + std::to_string(line.number) +
                          ": zero bytes, as a cut of power leaves them; --salvage uses the "
                          "records before it");
        split_fields(line.text, layout.style.separator, fields);
        if (first) note_resolution(layout, fields, recording);
        first = false;
        if (!layout.header.empty() && line.text == layout.header) {
            recording.notes.push_back("the header is repeated in line " +
                                      std::to_string(line.number));
            continue;
        }
        check_count(line, layout, fields);
        try {
            rows.read(fields, recording);
        } catch (const FieldError& error) {
            refuse(line.number, layout, fields, error);
        }
    }
    if (!line.ended && recording.size() > 0)
        recording.notes.push_back("line " + std::to_string(line.number) +
                                  " has no end of line: it is used, but may be cut");
}

}  // namespace

void parse_text(std::string_view bytes, const ReadOptions& given, Role sensor_hint,
                Recording& recording) {
    std::string storage, decimal_storage;
    std::size_t date_column = std::string_view::npos;
    const std::string_view text = with_decimal_times(as_utf8(bytes, storage, recording.notes),
                                                     decimal_storage, date_column, recording.notes);
    const ReadOptions& options = given;
    const Layout layout = layout_of(text, options, sensor_hint, date_column);
    if (layout.columns.empty()) return;
    recording.format = layout.format;
    recording.columns = described(layout);
    recording.notes.insert(recording.notes.end(), layout.notes.begin(), layout.notes.end());
    const auto finish = [&] {
        if (layout.no_times) give_times(options, recording);
    };
    try {
        read_rows(text, layout, options, recording);
    } catch (const BadData&) {
        finish();
        throw;
    }
    finish();
}

}  // namespace fairlead::sim
