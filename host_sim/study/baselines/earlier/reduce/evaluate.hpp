#pragma once
// What a decoded curve says at a time: the value, and how it moves there.
#include <array>
#include <cstdint>

#include "host_sim/study/baselines/earlier/reduce/channel.hpp"

namespace fairlead::earlier {

/// The value of a curve at t_ns, in signal units: the very arithmetic that the tolerance is held
/// in.
template <class Channel>
inline typename Channel::Value value_at(const Curve<Channel>& curve,
                                        const typename Channel::Scale& scale, std::uint32_t tick_ns,
                                        std::int64_t t_ns) noexcept {
    const Polynomial<Channel::dimension, Channel::order> p{curve.span};
    return Channel::value(p(ticks_between(curve.span.t0_ns, t_ns, tick_ns)), scale);
}

/// Velocity and acceleration of a vector curve, per second.
template <std::size_t D>
struct VectorRates {
    std::array<float, D> velocity{}, acceleration{};
};
template <std::size_t D, std::size_t Order>
inline VectorRates<D> rates_at(const Curve<VectorChannel<D, Order>>& curve,
                               const typename VectorChannel<D, Order>::Scale& scale,
                               std::uint32_t tick_ns, std::int64_t t_ns) noexcept {
    const Polynomial<D, Order> p{curve.span};
    const float u = ticks_between(curve.span.t0_ns, t_ns, tick_ns);
    const float per_s = 1e9f / static_cast<float>(tick_ns);
    const auto first = p.derivative(u, 1), second = p.derivative(u, 2);
    VectorRates<D> out;
    for (std::size_t d = 0; d < D; ++d) {
        out.velocity[d] = first[d] * scale.unit(d) * per_s;
        out.acceleration[d] = second[d] * scale.unit(d) * per_s * per_s;
    }
    return out;
}

/// Angular velocity and acceleration of an orientation curve, body frame, rad/s and rad/s^2.
struct RotationRates {
    Vec3 velocity_rad_s{}, acceleration_rad_s2{};
};
inline RotationRates rates_at(const Curve<OrientationChannel>& curve,
                              const OrientationChannel::Scale&, std::uint32_t tick_ns,
                              std::int64_t t_ns) noexcept {
    const Polynomial<4, 4> polynomial{curve.span};
    const float u = ticks_between(curve.span.t0_ns, t_ns, tick_ns);
    const float per_s = 1e9f / static_cast<float>(tick_ns);
    const auto quat = [](const std::array<float, 4>& v) { return Quat{v[0], v[1], v[2], v[3]}; };
    const Quat p = quat(polynomial(u)), p1 = quat(polynomial.derivative(u, 1)),
               p2 = quat(polynomial.derivative(u, 2));
    // p = r q with unit q: w = 2 vec(conj(p) p') / p.p, and its derivative
    const float square = dot(p, p);
    if (!(square > 0)) return {};
    const Vec3 w = (2 / square) * vec(conj(p) * p1);
    const Vec3 a = (2 / square) * vec(conj(p) * p2) - (2 * dot(p, p1) / square) * w;
    return {per_s * w, per_s * per_s * a};
}

}  // namespace fairlead::earlier
