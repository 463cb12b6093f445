#pragma once
// Checks of parameters: the name of the field that is refused.
//
// A parameter struct P names its fields and their ranges once, in P::each(); check(params), the
// test of docs/parameters.md and the tools all read that one table. Checks are constexpr, so that
// a board can ask them with static_assert. Cost: one comparison of each field.
#include "fairlead/base/status.hpp"

namespace fairlead {

/// The result of a check: ok, or bad_argument and the name of the first field that is refused.
struct Check {
    Status status{Status::ok};
    const char* field{""};  // as in the source, members of members with a dot; "" when ok

    constexpr explicit operator bool() const noexcept { return status == Status::ok; }
};

namespace detail {

/// Finds the first field outside its range. NaN is outside of every range, and infinity of each
/// that does not end there.
class FirstRefused {
  public:
    template <class T>
    constexpr void operator()(const char* name, T value, T least, T greatest) noexcept {
        if (found_ && !(value >= least && value <= greatest))
            found_ = Check{Status::bad_argument, name};
    }
    constexpr Check result() const noexcept { return found_; }

  private:
    Check found_{};
};

/// The ranges of the fields of P, each by itself.
template <class P>
constexpr Check check_ranges(const P& params) noexcept {
    FirstRefused refused;
    P::each(params, refused);
    return refused.result();
}

}  // namespace detail
}  // namespace fairlead
