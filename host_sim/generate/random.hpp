#pragma once
// Random numbers with the same bits on every compiler: a counter hashed by SplitMix64 (Steele, Lea,
// Flood 2014), normals by Box and Muller over the library's own elementary functions. (The
// distributions of <random> differ between standard libraries.)
#include <cstdint>

#include "fairlead/math/approx.hpp"
#include "fairlead/math/vec.hpp"

namespace fairlead::sim {

class Random {
  public:
    explicit Random(std::uint64_t seed) : state_{seed} {}

    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }

    /// Even over 0 ... n - 1, n > 0; the bias of the remainder is below n / 2^64.
    std::uint64_t below(std::uint64_t n) { return next() % n; }

    /// Even in [low, high), 53 bits.
    double uniform(double low = 0, double high = 1) {
        return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
    }

    /// Mean 0, variance 1.
    double normal() {
        const double radius = approx::sqrt(-2 * approx::log(1 - uniform()));
        return radius * approx::sin_cos(uniform() * 2 * pi_v<double>).cos;
    }

    BasicVec3<double> normal3(double sigma) {  // in a fixed order, whatever the compiler does
        const double x = normal(), y = normal(), z = normal();
        return {sigma * x, sigma * y, sigma * z};
    }

    /// Even over the unit sphere.
    BasicVec3<double> direction() {
        for (;;) {
            const BasicVec3<double> v = normal3(1);
            if (const double n = norm(v); n > 1e-6) return (1 / n) * v;
        }
    }

  private:
    std::uint64_t state_;
};

}  // namespace fairlead::sim
