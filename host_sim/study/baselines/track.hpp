#pragma once
// One channel of a recording as the rivals see it: no gaps, times in seconds, values in double.
// Positions have 3 components and an error per axis; orientations are unit quaternions w x y z,
// sign-continuous, and their error is the rotation angle of the normalised value.
#include <cstddef>
#include <string>
#include <vector>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

enum class Channel { position, orientation };
const char* to_string(Channel channel);

struct Track {
    std::string name;
    Channel channel{};
    double period_s{};
    std::vector<double> t;  // seconds since the first sample
    std::vector<double> x;  // dim() numbers a sample

    std::size_t dim() const { return channel == Channel::position ? 3 : 4; }
    std::size_t size() const { return t.size(); }
    const double* at(std::size_t i) const { return &x[i * dim()]; }
    /// Largest axis error in m, or rotation angle in rad, of `value` taken for sample i.
    double error(std::size_t i, const double* value) const;
};

/// Full rotation angle between two quaternions of any length and sign, exact near 0.
double rotation_angle(const double* a, const double* b);

/// The first `seconds_max` of the longest run of records in which the channel is valid and no
/// record is missing: the stretch that every figure in docs/peers.md is about.
Track longest_run(const Recording& recording, Channel channel, double seconds_max = 60);

/// The same stretch as a recording that holds this channel alone.
Recording cut(const Recording& recording, Channel channel, double seconds_max = 60);

}  // namespace fairlead::sim
