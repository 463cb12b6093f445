#include "host_sim/recording/calendar.hpp"

#include <cstdint>

#include "host_sim/recording/lines.hpp"

namespace fairlead::sim {
namespace {

bool digit(char c) { return c >= '0' && c <= '9'; }

/// Reads forward in a line; every step says whether it was possible.
struct Reader {
    std::string_view text;
    std::size_t at;

    bool number(std::size_t digits, int& out) {
        if (at + digits > text.size()) return false;
        out = 0;
        for (std::size_t i = 0; i < digits; ++i) {
            if (!digit(text[at + i])) return false;
            out = 10 * out + (text[at + i] - '0');
        }
        at += digits;
        return true;
    }
    bool one_of(std::string_view choices) {
        if (at >= text.size() || choices.find(text[at]) == std::string_view::npos) return false;
        ++at;
        return true;
    }
    std::string_view digits() {
        const std::size_t from = at;
        while (at < text.size() && digit(text[at])) ++at;
        return text.substr(from, at - from);
    }
};

struct Stamp {
    std::size_t begin{}, end{};  // in the line
    std::int64_t seconds{};
    std::string_view fraction;  // digits behind the point
    bool zone{};
};

bool leap(int year) { return (year % 4 == 0 && year % 100 != 0) || year % 400 == 0; }

int days_in(int month, int year) {
    constexpr int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    return days[month - 1] + (month == 2 && leap(year) ? 1 : 0);
}

std::int64_t days_since_1970(int year, int month, int day) {
    std::int64_t days = day - 1;
    for (int y = 1970; y < year; ++y) days += leap(y) ? 366 : 365;
    for (int m = 1; m < month; ++m) days += days_in(m, year);
    return days;
}

/// "Z", "+02", "+0200", "+02:00" or nothing. False: a zone that does not exist.
bool read_zone(Reader& r, Stamp& out) {
    Reader ahead = r;
    if (ahead.one_of("Zz")) {
        out.zone = true;
        r = ahead;
        return true;
    }
    const bool west = ahead.at < ahead.text.size() && ahead.text[ahead.at] == '-';
    if (!ahead.one_of("+-")) return true;
    int hours = 0, minutes = 0;
    if (!ahead.number(2, hours)) return true;
    ahead.one_of(":");
    if (!ahead.number(2, minutes)) minutes = 0;
    if (hours > 14 || minutes > 59) return false;
    const int offset_s = 60 * (60 * hours + minutes);
    out.seconds -= west ? -offset_s : offset_s;
    out.zone = true;
    r = ahead;
    return true;
}

/// The time that begins at `from`.
bool read_stamp(std::string_view line, std::size_t from, bool comma_fraction, Stamp& out) {
    Reader r{line, from};
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
    if (!r.number(4, year) || !r.one_of("-/") || !r.number(2, month) || !r.one_of("-/") ||
        !r.number(2, day) || !r.one_of("Tt _") || !r.number(2, hour) || !r.one_of(":") ||
        !r.number(2, minute) || !r.one_of(":") || !r.number(2, second))
        return false;
    if (year < 1970 || year > 2261 || month < 1 || month > 12 || day < 1 ||
        day > days_in(month, year) || hour > 23 || minute > 59 || second > 60)
        return false;
    out.begin = from;
    out.seconds = 86400 * days_since_1970(year, month, day) + 3600 * hour + 60 * minute + second;
    Reader point = r;
    if (point.one_of(comma_fraction ? ".," : ".")) {
        out.fraction = point.digits();
        if (!out.fraction.empty()) r = point;
    }
    if (!read_zone(r, out) || out.seconds < 0) return false;
    out.end = r.at;
    return out.end == line.size() || !(digit(line[out.end]) || line[out.end] == ':');
}

bool find_stamp(std::string_view line, Stamp& out) {
    const bool comma_fraction = line.find_first_of(";\t") != std::string_view::npos;
    for (std::size_t at = 0; at + 19 <= line.size(); ++at) {
        if (!digit(line[at]) || (at > 0 && digit(line[at - 1]))) continue;
        out = {};
        if (read_stamp(line, at, comma_fraction, out)) return true;
    }
    return false;
}

/// Does a line without a calendar time hold a record already?
bool holds_record(std::string_view line) {
    const Style style = style_of(line);
    Fields fields;
    split_fields(line, style.separator, fields);
    for (const std::string_view f : fields)
        if (is_number(f, style) && f.find_first_of("0123456789") != std::string_view::npos)
            return true;
    return false;
}

}  // namespace

std::string_view with_decimal_times(std::string_view text, std::string& storage, bool& found,
                                    std::vector<std::string>& notes) {
    found = false;
    Stamp stamp;
    LineReader first{text};
    for (Line line; !found && first.next(line);) {
        if (line.comment) continue;
        found = find_stamp(line.text, stamp);
        if (!found && holds_record(line.text)) break;
    }
    if (!found) return text;
    bool local = false;
    std::size_t copied = 0;
    LineReader reader{text};
    for (Line line; reader.next(line);) {
        if (line.comment || !find_stamp(line.text, stamp)) continue;
        const auto start = static_cast<std::size_t>(line.text.data() - text.data());
        storage += text.substr(copied, start + stamp.begin - copied);
        storage += std::to_string(stamp.seconds);
        if (!stamp.fraction.empty()) storage += "." + std::string(stamp.fraction);
        copied = start + stamp.end;
        local = local || !stamp.zone;
    }
    storage += text.substr(copied);
    notes.push_back(std::string("times are dates of the calendar, read as seconds since 1970") +
                    (local ? "; without a zone they are taken as UTC" : ""));
    return storage;
}

}  // namespace fairlead::sim
