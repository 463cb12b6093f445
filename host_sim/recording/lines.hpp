#pragma once
// A text file as lines and fields: comments, separators, quotes, ends of lines of all systems.
#include <string>
#include <string_view>
#include <vector>

namespace fairlead::sim {

struct Line {
    std::string_view text;  // without blanks around it
    std::size_t number{};   // from 1
    bool comment{};         // begins with #, % or //; the mark is not in `text`
    bool ended{true};       // by an end of line; the last one of a cut file is not
};

/// Steps through a text line by line; ends are \n, \r\n or \r.
class LineReader {
  public:
    explicit LineReader(std::string_view text) : rest_{text} {}
    /// False at the end of the text. Lines without content are passed over.
    bool next(Line& line);

  private:
    std::string_view rest_;
    std::size_t number_{0};
};

using Fields = std::vector<std::string_view>;

/// How a line is split: by ';', a tab, ',' or (' ') blanks. Separators within quotes, and in names
/// within brackets, do not count; blanks and quotes around a field are dropped.
void split_fields(std::string_view line, char separator, Fields& fields);

/// The separator that a line of data uses, and whether its numbers have a decimal comma.
struct Style {
    char separator{','};
    bool decimal_comma{false};
};
Style style_of(std::string_view data_line);

/// A field as a number's text: with a point for a comma. `storage` keeps it where it changes.
std::string_view number_text(std::string_view field, const Style& style, std::string& storage);

/// The field is a number in this style.
bool is_number(std::string_view field, const Style& style);

std::string_view without_blanks(std::string_view text);

}  // namespace fairlead::sim
