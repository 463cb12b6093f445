#pragma once
// What the numbers themselves say: the size of gravity, unit quaternions, steps of time, and
// whether the angular rate turns gravity as far as it is seen to turn.
#include <optional>
#include <string>
#include <vector>

#include "host_sim/recording/units.hpp"

namespace fairlead::sim {

using Numbers = std::vector<double>;

double median(Numbers values);  // of the finite ones; NaN where there is none

/// Median length of the vectors that three columns hold.
double median_length(const Numbers& x, const Numbers& y, const Numbers& z);

/// The lengths of the middle half of the vectors are within a quarter of the median.
bool steady_length(const Numbers& x, const Numbers& y, const Numbers& z);

/// The columns are unit quaternions, in any order, in at least 99 % of the rows that hold numbers.
bool unit_quaternions(const Numbers& a, const Numbers& b, const Numbers& c, const Numbers& d);

/// The unit in which a length is that of gravity: m/s2, g, mg. Empty: in none.
std::optional<Unit> gravity_unit(double length);

/// The unit in which a length is that of the earth's field (15 to 100 uT). Empty: in none.
std::optional<Unit> field_unit(double length);

/// The typical step of a time column, in its own unit: bursts and jumps do not count. 0: none.
double typical_step(const Numbers& times);

struct TimeRange {
    double low_hz, high_hz;  // rates that records of this kind have
};
inline constexpr TimeRange imu_rates{1, 20000}, pose_rates{0.2, 5000};

/// The one unit of time that gives a rate in range; where several do, the one that gives times of
/// our epoch. Empty: none or several (`why` names the rates). `whole`: the stamps are integers.
std::optional<Unit> time_unit(const Numbers& times, const TimeRange& range, std::string& why);

/// The factor by which the angular rate must be taken so that it turns gravity as it is seen to
/// turn; 1: rad/s, 0.0175: deg/s. Empty: too little motion to tell. All of one length, SI but for
/// the rate; times in seconds.
std::optional<double> turning_factor(const std::vector<double>& t_s,
                                     const std::vector<Numbers>& gyro,
                                     const std::vector<Numbers>& accel);

}  // namespace fairlead::sim
