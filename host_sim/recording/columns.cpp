#include "host_sim/recording/columns.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "host_sim/recording/decimal.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

using Tokens = std::vector<std::string>;
using Words = std::vector<std::string_view>;

bool among(std::string_view word, const Words& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// A name taken apart: lower-case words, and what stands in the last brackets.
struct Name {
    Tokens tokens;
    std::string bracket;
    bool has_bracket{};
};

bool is_lower(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }
bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

void add_tokens(std::string_view text, Tokens& tokens) {
    std::string word;
    const auto close = [&] {
        if (!word.empty()) tokens.push_back(word);
        word.clear();
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (!is_lower(c) && !is_upper(c)) {
            close();
            continue;
        }
        if (is_upper(c) && i > 0 && is_lower(text[i - 1])) close();  // camelCase
        word += is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c;
    }
    close();
}

Name taken_apart(std::string_view text) {
    Name name;
    const auto close = text.find_last_of("])");
    const auto open = close == std::string_view::npos ? close : text.find_last_of("[(", close);
    // brackets within brackets, as in m/(s^2): take the outermost
    const auto first = text.find_first_of("[(");
    if (first != std::string_view::npos && close != std::string_view::npos && close > first &&
        text.substr(close + 1).find_first_not_of(" \t\"':") != std::string_view::npos) {
        add_tokens(text.substr(0, first),
                   name.tokens);  // IMU(0):accelX: what is in them is no unit
        add_tokens(text.substr(close + 1), name.tokens);
        return name;
    }
    if (open != std::string_view::npos && first != std::string_view::npos && close > first) {
        name.has_bracket = true;
        name.bracket = text.substr(first + 1, close - first - 1);
        add_tokens(text.substr(0, first), name.tokens);
        add_tokens(text.substr(close + 1), name.tokens);
        return name;
    }
    add_tokens(text, name.tokens);
    return name;
}

int axis_of(std::string_view word) {
    if (word == "x") return 0;
    if (word == "y") return 1;
    if (word == "z") return 2;
    if (word == "w") return 3;
    return -1;
}

const Words gyro_words{"gyro",     "gyr",  "gyroscope", "gyros", "omega",
                       "gyrorate", "rate", "rotrate",   "angvel"};
const Words accel_words{"acc",      "accel", "accelerometer", "acceleration",
                        "accelero", "accls", "alpha",         "accelerations"};
const Words mag_words{"mag", "magn", "magnetometer", "magnetic", "magneto", "compass", "magnet"};
const Words position_words{"pos", "position", "translation", "trans", "location"};
const Words quaternion_words{"quat", "quaternion", "orientation", "rotation", "rot", "attitude"};
const Words time_words{"t",        "time",  "timestamp", "timestamps", "stamp",  "ts",
                       "utc",      "epoch", "epoc",      "elapsed",    "tstamp", "clock",
                       "datetime", "date",  "zeit",      "uhrzeit",    "tiempo"};
const Words count_words{"num",     "number", "n",      "no",  "index",         "idx",
                        "id",      "i",      "frame",  "seq", "sequence",      "count",
                        "counter", "sample", "packet", "row", "packetcounter", "samplenumber"};
const Words other_words{"bias",      "cov",      "covariance", "std",    "stddev",  "sigma",
                        "var",       "variance", "err",        "error",  "offset",  "roll",
                        "pitch",     "yaw",      "heading",    "lat",    "lon",     "latitude",
                        "longitude", "altitude", "pressure",   "euler",  "gravity", "inc",
                        "increment", "delta",    "reset",      "azimuth"};
const Words secondary_words{"linear",       "lin",    "user",       "free", "uncal",
                            "uncalibrated", "unfilt", "unfiltered", "raw"};

/// x, y, z with a unit that only one quantity has: "x (rad/s)".
Role role_of_unit(const std::string& bracket) {
    Role found = Role::bare;
    std::size_t count = 0;
    for (const Role role : {Role::gyro, Role::accel, Role::mag, Role::position})
        if (!plain_unit(bracket).empty() && unit_of(*quantity_of(role), bracket)) {
            found = role;
            ++count;
        }
    return count == 1 ? found : Role::bare;
}

/// A name that says nothing, with an axis and a unit of one sensor alone: "Beschl. X (m/s2)".
void take_role_of_unit(Column& column, const std::string& bracket) {
    const Role role = role_of_unit(bracket);
    if (role != Role::gyro && role != Role::accel && role != Role::mag) return;
    if (real64(bracket)) return;  // a factor is a unit of anything
    column.role = role;
    column.by_unit = true;
}

/// An angle about an axis or in a turn, where a quaternion has no unit.
bool is_angle(const std::string& bracket) {
    const std::string plain = plain_unit(bracket);
    for (const char* word : {"deg", "rad", "azimuth", "pitch", "roll", "yaw"})
        if (plain.find(word) != std::string::npos) return true;
    return false;
}

/// T alone: a time, but T (degC) is a temperature.
Role role_of_t(const std::string& bracket) {
    if (plain_unit(bracket).empty() || unit_of(Quantity::time, bracket)) return Role::time;
    return unit_of(Quantity::temperature, bracket) ? Role::temperature : Role::unknown;
}

bool any(const Tokens& tokens, const Words& words) {
    return std::any_of(tokens.begin(), tokens.end(),
                       [&](const std::string& t) { return among(t, words); });
}

bool is_vector_word(std::string_view word) {
    return among(word, {"g", "w", "a", "m", "b", "h", "p", "t", "q", "v", "gf"}) ||
           among(word, gyro_words) || among(word, accel_words) || among(word, mag_words) ||
           among(word, position_words) || among(word, quaternion_words);
}

/// Splits an axis off the end: "gx", "accel_x", "omega_0". Leaves -1 where there is none.
int take_axis(Tokens& tokens, bool& numbered) {
    if (tokens.empty()) return -1;
    std::string& last = tokens.back();
    if (const int axis = axis_of(last); axis >= 0) {
        tokens.pop_back();
        return axis;
    }
    if (last.size() < 2 && tokens.size() < 2) return -1;
    const char end = last.back();
    const std::string stem = last.substr(0, last.size() - 1);
    const bool digit = end >= '0' && end <= '4';
    if (!is_vector_word(stem) && !(stem.empty() && digit)) return -1;
    if (digit) {
        numbered = true;
        stem.empty() ? tokens.pop_back() : void(last = stem);
        return end - '0';
    }
    const int axis = axis_of(std::string_view(&end, 1));
    if (axis >= 0) last = stem;
    return axis;
}

/// Of no use here: a bias, an angle, a term of a controller (axisP[0]).
bool is_other(const Tokens& tokens) {
    const auto says = [](const std::string& t) { return among(t, other_words); };
    const auto first = std::find_if(tokens.begin(), tokens.end(), says);
    if (first == tokens.end()) return tokens.size() > 1 && tokens.front() == "axis";
    const bool offset_time = *first == "offset" && any(tokens, time_words);  // from the start
    return !offset_time || std::any_of(first + 1, tokens.end(), says);
}

/// An axis in the middle of a name: Accel_LN_X_CAL, gyro_x_raw.
int middle_axis(Tokens& tokens) {
    for (std::size_t i = tokens.size(); i-- > 0;)
        if (const int axis = axis_of(tokens[i]); axis >= 0 && axis < 3) {
            tokens.erase(tokens.begin() + static_cast<std::ptrdiff_t>(i));
            return axis;
        }
    return -1;
}

/// The first word of one letter that stands for a quantity: a_RS_S_x, left_gx.
char letter_of(const Tokens& tokens) {
    for (const std::string& t : tokens)
        if (t.size() == 1 && std::string_view("gwamptqvbh").find(t) != std::string_view::npos)
            return t.front();
    return 0;
}

Role role_of_letter(const Tokens& tokens) {
    const auto first =
        std::find_if(tokens.begin(), tokens.end(), [](const std::string& t) { return t == "b"; });
    if (first != tokens.end() && first + 1 != tokens.end() &&
        among(*(first + 1), {"w", "a", "g", "acc", "gyr"}))
        return Role::ignored;  // b_w, b_a: a bias
    switch (letter_of(tokens)) {
        case 'g':
        case 'w': return Role::gyro;
        case 'a': return Role::accel;
        case 'm':
        case 'b':
        case 'h': return Role::mag;
        case 'p':
        case 't': return Role::position;
        case 'q': return Role::quaternion;
        case 'v': return Role::ignored;
        default: return Role::unknown;
    }
}

/// The role of a name with an axis.
Role vector_role(const Tokens& tokens) {
    if (tokens.empty()) return Role::bare;
    const bool turns = any(tokens, {"rate", "velocity", "speed"});
    if (any(tokens, gyro_words) || (turns && any(tokens, {"angular", "rotation", "rot", "ang"})))
        return Role::gyro;
    if (turns || any(tokens, {"vel"})) return Role::ignored;
    if (any(tokens, accel_words)) return Role::accel;
    if (any(tokens, mag_words)) return Role::mag;
    if (any(tokens, quaternion_words)) return Role::quaternion;
    if (any(tokens, position_words)) return Role::position;
    return role_of_letter(tokens);
}

/// The role of a name without one.
Role scalar_role(const Tokens& tokens, bool sensor) {
    if (tokens.size() == 1 && tokens[0] == "clipped") return Role::clipped;
    if (tokens.size() == 1 && tokens[0] == "gap") return Role::gap;
    if (tokens.size() == 1 && tokens[0] == "moving") return Role::moving;
    if (any(tokens, {"temp", "temperature", "tempc"})) return Role::temperature;
    if (any(tokens, {"tick", "ticks"})) return Role::ignored;  // of a clock of any rate
    if (!sensor && any(tokens, time_words)) return Role::time;
    const bool alone = std::all_of(tokens.begin(), tokens.end(), [](const std::string& t) {
        return std::isdigit(static_cast<unsigned char>(t.front())) == 0 &&
               unit_of(Quantity::time, t).has_value();
    });
    if (!tokens.empty() && alone) return Role::time;
    if (sensor && any(tokens, time_words)) return Role::time;
    if (tokens.empty() || any(tokens, count_words)) return Role::ignored;
    return Role::unknown;
}

/// A unit at the end of a name without brackets: acc_x_m_s2, gyroX_dps, time_ms.
std::optional<Unit> take_unit(Tokens& tokens, Quantity quantity, std::size_t keep) {
    for (std::size_t n = std::min<std::size_t>(4, tokens.size()); n > 0; --n) {
        if (tokens.size() < n + keep) continue;
        std::string joined;
        for (std::size_t i = tokens.size() - n; i < tokens.size(); ++i) joined += tokens[i];
        if (std::isdigit(static_cast<unsigned char>(joined.front())) != 0) continue;
        const auto unit = unit_of(quantity, joined);
        if (!unit) continue;
        tokens.resize(tokens.size() - n);
        return unit;
    }
    return {};
}

/// A unit behind the axis, whatever the quantity: then the axis is the last word again.
bool drop_unit_behind_axis(Tokens& tokens, Tokens& unit) {
    for (std::size_t n = 1; n <= 4 && n < tokens.size(); ++n) {
        Tokens front(tokens.begin(), tokens.end() - static_cast<std::ptrdiff_t>(n));
        Tokens probe = front;
        bool numbered = false;
        if (take_axis(probe, numbered) < 0 || numbered) continue;
        unit.assign(tokens.end() - static_cast<std::ptrdiff_t>(n), tokens.end());
        std::string joined;
        for (const std::string& t : unit) joined += t;
        for (const Quantity q :
             {Quantity::gyro, Quantity::accel, Quantity::mag, Quantity::position}) {
            if (std::isdigit(static_cast<unsigned char>(joined.front())) != 0) break;
            if (!unit_of(q, joined)) continue;
            tokens = front;
            return true;
        }
    }
    return false;
}

std::string trimmed_name(std::string_view text) {
    while (!text.empty() && std::string_view(" \t#%\"'").find(text.front()) != text.npos)
        text.remove_prefix(1);
    while (!text.empty() && std::string_view(" \t\"'\r").find(text.back()) != text.npos)
        text.remove_suffix(1);
    return std::string(text);
}

void read_unit(Column& column, const Name& name, Tokens tokens, const Tokens& behind) {
    const auto quantity = quantity_of(column.role);
    if (!quantity) return;
    if (name.has_bracket && !plain_unit(name.bracket).empty()) {
        column.unit = unit_of(*quantity, name.bracket);
        if (!column.unit) column.unknown_unit = name.bracket;
        return;
    }
    if (!behind.empty()) {
        std::string joined;
        for (const std::string& t : behind) joined += t;
        column.unit = unit_of(*quantity, joined);
    } else if (column.role == Role::time || column.role == Role::time_rest) {
        column.unit = take_unit(tokens, *quantity, 0);
        for (std::size_t i = 0; !column.unit && i < tokens.size(); ++i)  // seconds_elapsed
            if (tokens[i].size() > 1) column.unit = unit_of(*quantity, tokens[i]);
    } else {
        column.unit = take_unit(tokens, *quantity, 1);
    }
    const Tokens& t = name.tokens;
    if (!column.unit && any(t, {"raw", "lsb", "counts"})) column.unknown_unit = "raw counts";
    if (column.role == Role::accel && std::find(t.begin(), t.end(), "gf") != t.end())
        column.unit = unit_of(Quantity::accel, "g");
}

}  // namespace

const char* to_string(Role role) {
    switch (role) {
        case Role::unknown: return "unknown";
        case Role::ignored: return "not used";
        case Role::time: return "time";
        case Role::time_rest: return "nanoseconds of the time";
        case Role::gyro: return "gyroscope";
        case Role::accel: return "accelerometer";
        case Role::mag: return "magnetometer";
        case Role::position: return "position";
        case Role::quaternion: return "quaternion";
        case Role::temperature: return "temperature";
        case Role::bare: return "x, y, z without a quantity";
        case Role::clipped: return "clipped";
        case Role::gap: return "gap";
        case Role::moving: return "moving";
    }
    return "?";
}

std::optional<Quantity> quantity_of(Role role) {
    switch (role) {
        case Role::time:
        case Role::time_rest: return Quantity::time;
        case Role::gyro: return Quantity::gyro;
        case Role::accel: return Quantity::accel;
        case Role::mag: return Quantity::mag;
        case Role::position: return Quantity::position;
        case Role::temperature: return Quantity::temperature;
        default: return {};
    }
}

Column column_of(std::string_view text) {
    Column column;
    column.name = trimmed_name(text);
    Name name = taken_apart(column.name);
    Tokens tokens = name.tokens, behind;
    const std::string inside = plain_unit(name.bracket);
    if (axis_of(inside) >= 0 || (inside.size() == 1 && inside[0] >= '0' && inside[0] <= '4')) {
        tokens.push_back(inside);  // acc[x], q[0]
        name.bracket.clear();
    }
    // gF, the g-force of a phone's logger, is one word with its axis: gFx
    for (std::size_t i = 0; i + 1 < tokens.size(); ++i)
        if (tokens[i] == "g" && tokens[i + 1].size() == 2 && tokens[i + 1].front() == 'f') {
            name.tokens = {"gf"};
            tokens = {"acc", "g", tokens[i + 1].substr(1)};
            break;
        }
    while (tokens.size() > 1 && among(tokens.back(), {"raw", "cal", "calibrated", "value"}))
        tokens.pop_back();
    if (tokens.size() > 1 && tokens.back() == "axis" && axis_of(tokens[tokens.size() - 2]) >= 0)
        tokens.pop_back();  // x-axis
    const bool other = is_other(name.tokens);
    const bool sensor =
        any(tokens, gyro_words) || any(tokens, accel_words) || any(tokens, mag_words);
    column.secondary = any(name.tokens, secondary_words) && !any(tokens, {"angular"});
    column.axis = take_axis(tokens, column.numbered);
    if (column.axis < 0 && drop_unit_behind_axis(tokens, behind))
        column.axis = take_axis(tokens, column.numbered);
    if (column.axis < 0 && sensor) column.axis = middle_axis(tokens);
    if (other) {
        column.role = Role::ignored;
    } else if (column.axis >= 0) {
        column.role = vector_role(tokens);
        if (column.role == Role::unknown && column.numbered)
            column.role = scalar_role(tokens, sensor);
    } else {
        column.role = scalar_role(tokens, sensor);
    }
    if (column.role == Role::bare && column.axis < 3) column.role = role_of_unit(name.bracket);
    if (column.role == Role::unknown && column.axis >= 0 && column.axis < 3 && !column.numbered)
        take_role_of_unit(column, name.bracket);
    if (column.role == Role::quaternion && is_angle(name.bracket)) column.role = Role::unknown;
    if (column.role == Role::time && tokens == Tokens{"t"}) column.role = role_of_t(name.bracket);
    if (column.role == Role::quaternion)
        column.axis = column.numbered ? column.axis : (column.axis + 1) % 4;  // w, x, y, z
    else if (column.axis == 3 && column.role != Role::bare)
        column.role = Role::unknown;  // no vector has a w
    if (column.role == Role::gyro || column.role == Role::accel || column.role == Role::mag ||
        column.role == Role::position)
        if (column.axis < 0) column.role = Role::unknown;
    read_unit(column, name, tokens, behind);
    if (column.role == Role::time && column.unit && column.unit->name == "ns" &&
        any(name.tokens, {"nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds", "nanos"}))
        column.role = Role::time_rest;  // a whole time where no seconds stand beside it
    return column;
}

std::vector<Column> parse_columns(const std::string& text) {
    std::vector<Column> columns;
    for (const std::string& name : split(text, ',')) {
        Column column;
        if (name == "-" || name.empty()) {
            column.role = Role::ignored;
            column.name = "-";
        } else {
            column = column_of(name);
        }
        if (column.role == Role::unknown || column.role == Role::bare)
            throw BadSpec("--columns: '" + name +
                          "' is not known; names are t_ns (t_us, t_ms, t_s), gx gy gz, ax ay az, "
                          "mx my mz, px py pz, qw qx qy qz, temperature, sec, nsec, and - for a "
                          "column that is not used; units in brackets: ax[g]");
        if (column.numbered && column.role == Role::quaternion)
            throw BadSpec("--columns: '" + name + "': name the axes qw, qx, qy, qz");
        if (!column.unknown_unit.empty())
            throw BadSpec("--columns: '" + column.unknown_unit + "' is no unit of " + name + ": " +
                          known_units(*quantity_of(column.role)));
        columns.push_back(column);
    }
    return columns;
}

std::string short_name(const Column& column) {
    static constexpr std::array<char, 4> vector_axes{'x', 'y', 'z', 'w'};
    static constexpr std::array<char, 4> quaternion_axes{'w', 'x', 'y', 'z'};
    const auto at = static_cast<std::size_t>(std::clamp(column.axis, 0, 3));
    const auto with = [&](const char* stem) { return std::string(stem) + vector_axes[at]; };
    switch (column.role) {
        case Role::time: return column.unit ? "t_" + column.unit->name : "t";
        case Role::time_rest: return "nsec";
        case Role::gyro: return with("g");
        case Role::accel: return with("a");
        case Role::mag: return with("m");
        case Role::position: return with("p");
        case Role::quaternion: return std::string("q") + quaternion_axes[at];
        case Role::temperature: return "temperature";
        case Role::bare: return with("");
        case Role::clipped: return "clipped";
        case Role::gap: return "gap";
        case Role::moving: return "moving";
        case Role::ignored:
        case Role::unknown: break;
    }
    return "-";
}

}  // namespace fairlead::sim
