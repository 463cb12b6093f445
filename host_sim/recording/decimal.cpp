#include "host_sim/recording/decimal.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>
#include <type_traits>

namespace fairlead::sim {
namespace {

/// The parts of a decimal number: the value is 0.DIGITS * 10^point.
struct Decimal {
    bool negative{};
    std::string digits;  // without leading zeros; empty: zero
    int point{};
    int last_place{};
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes the exponent off the end: e-5. False: not an exponent.
bool take_exponent(std::string_view text, int& exponent) {
    if (text.empty()) return true;
    if (text.front() != 'e' && text.front() != 'E') return false;
    text.remove_prefix(1);
    const bool negative = !text.empty() && text.front() == '-';
    if (negative || (!text.empty() && text.front() == '+')) text.remove_prefix(1);
    if (text.empty() || !std::all_of(text.begin(), text.end(), is_digit)) return false;
    constexpr int far = 100000;  // beyond every number that is used, and far from overflow
    for (const char c : text) exponent = std::min(far, exponent * 10 + (c - '0'));
    if (negative) exponent = -exponent;
    return true;
}

std::optional<Decimal> parse(std::string_view text) {
    if (text.size() > 4096) return {};
    Decimal out;
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
        out.negative = text.front() == '-';
        text.remove_prefix(1);
    }
    std::size_t i = 0, count = 0;
    bool after_point = false;
    int places = 0;
    for (; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && !after_point)); ++i) {
        if (text[i] == '.') {
            after_point = true;
            continue;
        }
        ++count;
        if (after_point) ++places;
        if (text[i] != '0' || !out.digits.empty()) out.digits += text[i];
    }
    int exponent = 0;
    if (count == 0 || !take_exponent(text.substr(i), exponent)) return {};
    out.last_place = exponent - places;
    out.point = static_cast<int>(out.digits.size()) + out.last_place;
    return out;
}

template <class T>
std::optional<T> real(std::string_view text) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    if (!text.empty() && text.front() == '+') return {};
    T value{};
    const auto end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, value);
    // out of range is rounded like any decimal: to zero, or to infinity, which the intake rejects
    if (result.ec == std::errc::result_out_of_range && result.ptr == end)
        return static_cast<T>(std::strtod(std::string(text).c_str(), nullptr));
    if (result.ec != std::errc{} || result.ptr != end) return {};
    return value;
}

}  // namespace

std::optional<std::int64_t> scaled_integer(std::string_view text, int shift) {
    const auto number = parse(text);
    if (!number) return {};
    const int point = number->point + shift;
    if (number->digits.empty() || point < 0) return 0;
    if (point > 19) return {};
    const auto digit = [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        return static_cast<std::uint64_t>(at < number->digits.size() ? number->digits[at] - '0'
                                                                     : 0);
    };
    std::uint64_t value = 0;  // 19 digits are below 2^64
    for (int i = 0; i < point; ++i) value = value * 10 + digit(i);
    if (digit(point) >= 5) ++value;
    constexpr std::uint64_t limit = std::uint64_t{1} << 63;
    if (value > limit - (number->negative ? 0 : 1)) return {};
    return static_cast<std::int64_t>(number->negative ? ~value + 1 : value);
}

std::optional<int> last_place(std::string_view text) {
    const auto number = parse(text);
    if (!number) return {};
    return number->last_place;
}

std::optional<float> real32(std::string_view text) { return real<float>(text); }
std::optional<double> real64(std::string_view text) { return real<double>(text); }

}  // namespace fairlead::sim
