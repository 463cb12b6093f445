#pragma once
// Every numeric threshold that more than one place must agree on: name, value, what it bounds, and
// the test that holds it. Tuning that a user may change lives in parameter structs, not here.
#include "fairlead/base/compiler.hpp"

namespace fairlead::tolerance {

/// Largest |sum of taps - 1| of a mask given by hand; the centre tap takes up the rest, so that the
/// mask used is affine-invariant exactly. Holds taps typed to seven decimals. (test_mask)
inline constexpr double mask_sum = 1e-6;

/// Largest |tap| of a mask given by hand: beyond it a float filter has lost its digits. (test_mask)
inline constexpr double mask_tap = 1e3;

}  // namespace fairlead::tolerance
