#include "examples/gateway/toml_parser.hpp"

#include <string_view>

namespace fairlead::gateway {
namespace {

/// Bytes of the well-formed UTF-8 sequence at the start of `text`; 0: there is none (Unicode 15,
/// table 3-7).
std::size_t utf8_length(std::string_view text) noexcept {
    const auto byte = [&](std::size_t i) -> unsigned {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
    const unsigned lead = byte(0);
    if (lead < 0x80) return 1;
    if (lead >= 0xC2 && lead <= 0xDF) return follows(1) ? 2 : 0;
    if (lead >= 0xE0 && lead <= 0xEF) {
        const bool overlong = lead == 0xE0 && byte(1) < 0xA0;
        const bool surrogate = lead == 0xED && byte(1) > 0x9F;
        return follows(1) && follows(2) && !overlong && !surrogate ? 3 : 0;
    }
    if (lead >= 0xF0 && lead <= 0xF4) {
        const bool overlong = lead == 0xF0 && byte(1) < 0x90;
        const bool beyond = lead == 0xF4 && byte(1) > 0x8F;
        return follows(1) && follows(2) && follows(3) && !overlong && !beyond ? 4 : 0;
    }
    return 0;
}

bool is_forbidden(char letter) noexcept {
    const auto c = static_cast<unsigned char>(letter);
    return (c < 0x20 && letter != '\t' && letter != '\n' && letter != '\r') || c == 0x7F;
}

/// Follows texts and comments through a file, one character at a time.
class Scanner {
  public:
    /// True inside of a text or a comment, where any letter may stand.
    bool is_free() const noexcept { return comment_ || quote_ != 0; }

    /// Takes the character at the start of `text`; returns how many bytes belong together with it.
    std::size_t take(std::string_view text) noexcept {
        const char letter = text[0];
        if (comment_) {
            comment_ = letter != '\n';
            return 1;
        }
        if (quote_ == 0) {
            comment_ = letter == '#';
            if (letter != '"' && letter != '\'') return 1;
            quote_ = letter;
            triple_ = is_triple(text);
            return triple_ ? 3 : 1;
        }
        if (quote_ == '"' && letter == '\\') return text.size() > 1 && is_ascii(text[1]) ? 2 : 1;
        if (letter == '\n' && !triple_) quote_ = 0;  // the parser will refuse it
        if (letter != quote_ || (triple_ && !is_triple(text))) return 1;
        std::size_t size = triple_ ? 3 : 1;
        while (triple_ && size < 5 && size < text.size() && text[size] == quote_) ++size;
        quote_ = 0;
        return size;
    }

  private:
    static bool is_ascii(char c) noexcept { return static_cast<unsigned char>(c) < 0x80; }
    bool is_triple(std::string_view text) const noexcept {
        return text.size() >= 3 && text[1] == quote_ && text[2] == quote_;
    }

    char quote_{0};  // of the text that we are in
    bool triple_{};
    bool comment_{};
};

}  // namespace

std::optional<std::string> screen_toml(const std::string& text) {
    if (text.size() > toml_size_max)
        return "1: the text is longer than " + std::to_string(toml_size_max) + " bytes";
    constexpr std::string_view mark = "\xEF\xBB\xBF";  // some editors begin a file with it
    std::size_t at = text.compare(0, mark.size(), mark) == 0 ? mark.size() : 0;
    std::size_t line = 1;
    Scanner scanner;
    while (at < text.size()) {
        const std::string_view rest = std::string_view{text}.substr(at);
        const std::size_t length = utf8_length(rest);
        const std::string where = std::to_string(line);
        if (length == 0) return where + ": the text is not UTF-8";
        if (length > 1) {
            if (!scanner.is_free())
                return where + ": a letter beyond ASCII stands outside of a text";
            at += length;
            continue;
        }
        if (is_forbidden(rest[0])) {
            return where + ": the text contains the control character " +
                   std::to_string(static_cast<int>(rest[0]));
        }
        const std::size_t taken = scanner.take(rest);
        for (std::size_t i = 0; i < taken; ++i) {
            if (is_forbidden(rest[i])) return where + ": the text contains a control character";
            if (rest[i] == '\n') ++line;
        }
        at += taken;
    }
    return std::nullopt;
}

}  // namespace fairlead::gateway
