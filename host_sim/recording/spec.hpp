#pragma once
// The small grammar that SPEC arguments share: items joined by '+', each a name and arguments
// joined by ':'. SPEC = ITEM { '+' ITEM }, ITEM = NAME { ':' ARGUMENT }.
#include <stdexcept>
#include <string>
#include <vector>

namespace fairlead::sim {

/// A SPEC that cannot be understood: a usage error, exit code 2.
struct BadSpec : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

struct SpecItem {
    std::string text, name;
    std::vector<std::string> arguments;

    /// Throws BadSpec unless the number of arguments is within the bounds.
    void expect_arguments(std::size_t least, std::size_t most) const;
    /// Argument i as a number in [low, high]; `fallback` where it is absent.
    double number(std::size_t i, double low, double high) const;
    double number(std::size_t i, double low, double high, double fallback) const;
    long whole(std::size_t i, long low, long high) const;
    [[noreturn]] void refuse(const std::string& why) const;
};

std::vector<SpecItem> parse_spec(const std::string& spec);
double parse_real(const std::string& text);  // the whole text, finite; throws BadSpec
std::vector<std::string> split(const std::string& text, char separator);

}  // namespace fairlead::sim
