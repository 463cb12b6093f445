#include "host_sim/recording/calendar.hpp"

#include <cstdint>
#include <map>
#include <utility>

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
    bool zone{}, day_only{};
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
    if (ahead.at + 1 < ahead.text.size() && ahead.text[ahead.at] == ' ' &&
        (ahead.text[ahead.at + 1] == '+' || ahead.text[ahead.at + 1] == '-'))
        ++ahead.at;
    const bool west = ahead.at < ahead.text.size() && ahead.text[ahead.at] == '-';
    if (!ahead.one_of("+-")) return true;
    int hours = 0, minutes = 0;
    if (!ahead.number(2, hours)) return true;
    ahead.one_of(":");
    if (!ahead.number(2, minutes)) {
        if (ahead.at != r.at + 3 && ahead.at != r.at + 4) return true;  // " -5": no zone
        minutes = 0;
    }
    if (hours > 14 || minutes > 59) return false;
    const int offset_s = 60 * (60 * hours + minutes);
    out.seconds -= west ? -offset_s : offset_s;
    out.zone = true;
    r = ahead;
    return true;
}

/// "May", in any case.
bool read_month(Reader& r, int& month) {
    constexpr std::string_view names = "janfebmaraprmayjunjulaugsepoctnovdec";
    std::string name;
    for (std::size_t i = r.at; i < r.text.size() && i < r.at + 3; ++i)
        name += static_cast<char>(r.text[i] | 0x20);
    const std::size_t at = names.find(name);
    if (name.size() < 3 || at == names.npos || at % 3 != 0) return false;
    month = static_cast<int>(at / 3) + 1;
    r.at += 3;
    return true;
}

/// "2023-05-01" or "01-May-2023".
bool read_date(Reader& r, int& year, int& month, int& day) {
    Reader named = r;
    if ((named.number(2, day) || named.number(1, day)) && named.one_of("- ") &&
        read_month(named, month) && named.one_of("- ") && named.number(4, year)) {
        r = named;
        return true;
    }
    return r.number(4, year) && r.one_of("-/") && r.number(2, month) && r.one_of("-/") &&
           r.number(2, day);
}

/// "12:34:56.789"; loggers of phones write "12:34:56:789".
bool read_clock(Reader& r, std::string_view points, Stamp& out) {
    int hour = 0, minute = 0, second = 0;
    if (!r.number(2, hour) || !r.one_of(":") || !r.number(2, minute) || !r.one_of(":") ||
        !r.number(2, second) || hour > 23 || minute > 59 || second > 60)
        return false;
    out.seconds += 3600 * hour + 60 * minute + second;
    Reader point = r;
    if (point.one_of(points)) {
        out.fraction = point.digits();
        if (!out.fraction.empty()) r = point;
    }
    return true;
}

/// The time that begins at `from`.
bool read_stamp(std::string_view line, std::size_t from, bool comma_fraction, Stamp& out) {
    Reader r{line, from};
    int year = 0, month = 0, day = 0;
    if (!read_date(r, year, month, day) || !r.one_of("Tt _")) return false;
    if (year < 1970 || year > 2261 || month < 1 || month > 12 || day < 1 ||
        day > days_in(month, year))
        return false;
    out.begin = from;
    out.seconds = 86400 * days_since_1970(year, month, day);
    if (!read_clock(r, comma_fraction ? ".,:" : ".:", out)) return false;
    if (!read_zone(r, out) || out.seconds < 0) return false;
    out.end = r.at;
    return out.end == line.size() || !(digit(line[out.end]) || line[out.end] == ':');
}

bool find_date(std::string_view line, Stamp& out) {
    const bool comma_fraction = line.find_first_of(";\t") != std::string_view::npos;
    for (std::size_t at = 0; at + 18 <= line.size(); ++at) {
        if (!digit(line[at]) || (at > 0 && digit(line[at - 1]))) continue;
        out = {};
        if (read_stamp(line, at, comma_fraction, out)) return true;
    }
    return false;
}

/// A time of the day that is a whole field.
bool find_clock(std::string_view line, Stamp& out) {
    const Style style = style_of(line);
    Fields fields;
    split_fields(line, style.separator, fields);
    for (const std::string_view field : fields) {
        out = {};
        Reader r{field, 0};
        if (!read_clock(r, style.separator == ',' ? ".:" : ".,:", out) || r.at != field.size())
            continue;
        out.begin = static_cast<std::size_t>(field.data() - line.data());
        out.end = out.begin + field.size();
        out.day_only = true;
        return true;
    }
    return false;
}

/// The number of the field that begins at a place of the line.
std::size_t field_at(std::string_view line, std::size_t begin) {
    Fields fields;
    split_fields(line, style_of(line).separator, fields);
    for (std::size_t i = fields.size(); i-- > 0;)
        if (static_cast<std::size_t>(fields[i].data() - line.data()) <= begin) return i;
    return 0;
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

struct Found {
    std::size_t column{std::string_view::npos};
    bool day_only{};
};

/// In half of the first lines with numbers at least: a preamble may hold dates, too.
Found where_times_stand(std::string_view text) {
    constexpr std::size_t lines_most = 64;
    std::map<std::pair<bool, std::size_t>, std::size_t> counts;
    std::size_t records = 0;
    Stamp stamp;
    LineReader reader{text};
    for (Line line; records < lines_most && reader.next(line);) {
        if (line.comment) continue;
        const bool date = find_date(line.text, stamp);
        if (!date && !holds_record(line.text) && !find_clock(line.text, stamp)) continue;
        ++records;
        if (date || find_clock(line.text, stamp))
            ++counts[{stamp.day_only, field_at(line.text, stamp.begin)}];
    }
    for (const auto& [place, count] : counts)
        if (2 * count >= records) return {place.second, place.first};
    return {};
}

}  // namespace

std::string_view with_decimal_times(std::string_view text, std::string& storage,
                                    std::size_t& column, std::vector<std::string>& notes) {
    const Found found = where_times_stand(text);
    column = found.column;
    if (column == std::string_view::npos) return text;
    const bool day_only = found.day_only;
    Stamp stamp;
    bool local = false;
    std::size_t copied = 0;
    std::int64_t last = 0, days_s = 0;
    LineReader reader{text};
    for (Line line; reader.next(line);) {
        if (line.comment) continue;
        if (!(day_only ? find_clock(line.text, stamp) : find_date(line.text, stamp))) continue;
        if (day_only && stamp.seconds < last - 43200) days_s += 86400;  // midnight has passed
        last = stamp.seconds;
        if (day_only) stamp.seconds += days_s;
        const auto start = static_cast<std::size_t>(line.text.data() - text.data());
        storage += text.substr(copied, start + stamp.begin - copied);
        storage += std::to_string(stamp.seconds);
        if (!stamp.fraction.empty()) storage += "." + std::string(stamp.fraction);
        copied = start + stamp.end;
        local = local || !stamp.zone;
    }
    storage += text.substr(copied);
    if (day_only)
        notes.emplace_back("times are of the day, without a date, read as seconds since midnight");
    else
        notes.push_back(std::string("times are dates of the calendar, read as seconds since 1970") +
                        (local ? "; without a zone they are taken as UTC" : ""));
    return storage;
}

}  // namespace fairlead::sim
