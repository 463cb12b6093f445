#include "examples/gateway/log.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace fairlead::gateway {
namespace {

constexpr std::array<std::string_view, 4> names{"error", "warning", "info", "debug"};
constexpr std::array<std::string_view, 4> priorities{"<3>", "<4>", "<6>", "<7>"};  // as syslog's

bool under_journal() noexcept {
    static const bool there = std::getenv("JOURNAL_STREAM") != nullptr;
    return there;
}

}  // namespace

std::atomic<Level> LogLine::threshold_{Level::info};

LogLine::LogLine(Level level, std::string_view event) noexcept : wanted_{level <= threshold_} {
    if (!wanted_) return;
    const auto i = static_cast<std::size_t>(level);
    if (under_journal()) put(priorities[i]);
    put(names[i]);
    put(' ');
    put(event);
}

LogLine::~LogLine() {
    if (!wanted_) return;
    line_[used_++] = '\n';
    // a full or closed standard error must not stop the gateway
    if (::write(STDERR_FILENO, line_.data(), used_) < 0) return;
}

LogLine& LogLine::add(std::string_view key, std::string_view text) noexcept {
    if (!wanted_) return *this;
    put(' ');
    put(key);
    put('=');
    const bool plain = !text.empty() && text.find_first_of(" \"=\n") == std::string_view::npos;
    if (plain) {
        put(text);
        return *this;
    }
    put('"');
    for (const char letter : text) {
        if (letter == '"' || letter == '\\') put('\\');
        put(letter == '\n' ? ' ' : letter);
    }
    put('"');
    return *this;
}

LogLine& LogLine::add_number(std::string_view key, std::int64_t number) noexcept {
    std::array<char, 24> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return add(key, std::string_view{digits.data(), static_cast<std::size_t>(end - digits.data())});
}

void LogLine::put(std::string_view text) noexcept {
    const std::size_t n = std::min(text.size(), line_.size() - 1 - used_);
    std::copy_n(text.begin(), n, line_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ += n;
}

}  // namespace fairlead::gateway
