#include "host_sim/recording/lines.hpp"

#include <algorithm>

#include "host_sim/recording/decimal.hpp"

namespace fairlead::sim {
namespace {

bool take_mark(std::string_view& text, std::string_view mark) {
    if (text.substr(0, mark.size()) != mark) return false;
    text.remove_prefix(mark.size());
    return true;
}

std::string_view unquoted(std::string_view field) {
    field = without_blanks(field);
    const bool quoted = field.size() >= 2 && field.front() == field.back() &&
                        (field.front() == '"' || field.front() == '\'');
    return quoted ? without_blanks(field.substr(1, field.size() - 2)) : field;
}

/// Where the field that starts the text ends.
std::size_t field_end(std::string_view text, char separator) {
    int depth = 0;
    char quote = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quote != 0) {
            if (c == quote) quote = 0;
            continue;
        }
        if (c == '"') quote = c;
        if (c == '[' || c == '(') ++depth;
        if ((c == ']' || c == ')') && depth > 0) --depth;
        if (depth > 0) continue;
        if (separator == ' ' ? c == ' ' || c == '\t' : c == separator) return i;
    }
    return text.size();
}

bool all_numbers(std::string_view line, const Style& style) {
    Fields fields;
    split_fields(line, style.separator, fields);
    return std::all_of(fields.begin(), fields.end(),
                       [&](auto f) { return f.empty() || is_number(f, style); });
}

}  // namespace

std::string_view without_blanks(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\v\f", wide = "\xC2\xA0";  // and no-break space
    for (;;) {
        if (!text.empty() && blanks.find(text.front()) != blanks.npos)
            text.remove_prefix(1);
        else if (!text.empty() && blanks.find(text.back()) != blanks.npos)
            text.remove_suffix(1);
        else if (text.substr(0, wide.size()) == wide)
            text.remove_prefix(wide.size());
        else
            return text;
    }
}

bool LineReader::next(Line& line) {
    while (!rest_.empty()) {
        const auto end = rest_.find_first_of("\r\n");
        std::string_view text = rest_.substr(0, end);
        line.ended = end != std::string_view::npos;
        rest_.remove_prefix(line.ended ? end : rest_.size());
        if (line.ended && !take_mark(rest_, "\r\n")) rest_.remove_prefix(1);
        line.number = ++number_;
        text = without_blanks(text);
        line.comment = take_mark(text, "#") || take_mark(text, "%") || take_mark(text, "//");
        line.text = without_blanks(text);
        if (!line.text.empty()) return true;
    }
    return false;
}

void split_fields(std::string_view line, char separator, Fields& fields) {
    fields.clear();
    if (separator == ' ') {
        for (line = without_blanks(line); !line.empty(); line = without_blanks(line)) {
            const std::size_t end = field_end(line, ' ');
            fields.push_back(unquoted(line.substr(0, end)));
            line.remove_prefix(end);
        }
        return;
    }
    for (;;) {
        const std::size_t end = field_end(line, separator);
        fields.push_back(unquoted(line.substr(0, end)));
        if (end == line.size()) return;
        line.remove_prefix(end + 1);
    }
}

Style style_of(std::string_view line) {
    const auto has = [&](char c) { return field_end(line, c) < line.size(); };
    for (const char separator : {';', '\t'}) {
        if (!has(separator)) continue;
        const Style point{separator, false}, comma{separator, true};
        return !all_numbers(line, point) && all_numbers(line, comma) ? comma : point;
    }
    if (!has(',')) return {' ', false};
    const Style comma{' ', true};
    const bool blanks = line.find_first_of(" \t") != std::string_view::npos;
    if (blanks && !all_numbers(line, {',', false}) && all_numbers(line, comma)) return comma;
    return {',', false};
}

std::string_view number_text(std::string_view field, const Style& style, std::string& storage) {
    if (!style.decimal_comma || field.find(',') == std::string_view::npos) return field;
    storage = field;
    std::replace(storage.begin(), storage.end(), ',', '.');
    return storage;
}

bool is_number(std::string_view field, const Style& style) {
    std::string storage;
    return real64(number_text(field, style, storage)).has_value();
}

}  // namespace fairlead::sim
