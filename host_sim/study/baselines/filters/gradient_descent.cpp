#include "host_sim/study/baselines/filters/gradient_descent.hpp"

#include "fairlead/math/quat.hpp"

namespace fairlead::sim {
namespace {

constexpr std::size_t rounds_between_checks = 8;  // the cost is looked at now and then

/// J^-1 g and J^-T g of the rotation vector v, J the right Jacobian, by the series to v^2.
Vec3 jacobian_inverse(const Vec3& v, const Vec3& g) {
    const Vec3 c = cross(v, g);
    return g + 0.5f * c + (1 / 12.0f) * cross(v, c);
}

/// Gradient of the strain with respect to each step between samples, steps given: 2 lambda times
/// the differences of the bends, which end at the samples next to the ends.
std::vector<Vec3> step_gradient(const std::vector<Vec3>& steps, float lambda) {
    std::vector<Vec3> g(steps.size());
    for (std::size_t i = 1; i < steps.size(); ++i) {
        const Vec3 bend = (2 * lambda) * (steps[i] - steps[i - 1]);
        g[i] += bend;
        g[i - 1] = g[i - 1] - bend;
    }
    return g;
}

double bends(const std::vector<Vec3>& steps) {
    double sum = 0;
    for (std::size_t i = 1; i < steps.size(); ++i) {
        const Vec3 d = steps[i] - steps[i - 1];
        sum += static_cast<double>(dot(d, d));
    }
    return sum;
}

std::vector<Vec3> steps_of(const std::vector<Vec3>& p) {
    std::vector<Vec3> steps;
    for (std::size_t i = 1; i < p.size(); ++i) steps.push_back(p[i] - p[i - 1]);
    return steps;
}
std::vector<Vec3> steps_of(const std::vector<Quat>& q) {
    std::vector<Vec3> steps;
    for (std::size_t i = 1; i < q.size(); ++i)
        steps.push_back(rotation_vector(conj(q[i - 1]) * q[i]));
    return steps;
}

void move(const std::vector<Vec3>& raw, std::vector<Vec3>& p, float lambda, float size) {
    const auto g = step_gradient(steps_of(p), lambda);
    for (std::size_t i = 0; i < p.size(); ++i) {
        Vec3 slope = 2.0f * (p[i] - raw[i]);
        if (i > 0) slope += g[i - 1];
        if (i < g.size()) slope = slope - g[i];
        p[i] = p[i] - size * slope;
    }
}

/// Eq. (24): by the rotation vector x of q exp(x), body frame.
void move(const std::vector<Quat>& raw, std::vector<Quat>& q, float lambda, float size) {
    const auto steps = steps_of(q);
    const auto g = step_gradient(steps, lambda);
    for (std::size_t i = 0; i < q.size(); ++i) {
        Vec3 slope = 2.0f * rotation_vector(conj(raw[i]) * q[i]);
        if (i > 0) slope += jacobian_inverse(-steps[i - 1], g[i - 1]);
        if (i < g.size()) slope = slope - jacobian_inverse(steps[i], g[i]);
        q[i] = normalised(q[i] * from_rotation_vector(-size * slope));
    }
}

double deviation(const Vec3& a, const Vec3& b) { return static_cast<double>(dot(b - a, b - a)); }
double deviation(const Quat& a, const Quat& b) {
    const Vec3 d = rotation_vector(conj(a) * b);
    return static_cast<double>(dot(d, d));
}

template <class Value>
double cost_of(const std::vector<Value>& raw, const std::vector<Value>& x, double lambda) {
    double sum = lambda * bends(steps_of(x));
    for (std::size_t i = 0; i < x.size(); ++i) sum += deviation(raw[i], x[i]);
    return sum;
}

template <class Value>
DescentResult descend_to(const std::vector<Value>& raw, std::vector<Value>& x, double lambda,
                         double goal, std::size_t rounds_max) {
    x = raw;
    const auto size = static_cast<float>(1 / (2 + 16 * lambda));
    DescentResult result{0, cost_of(raw, x, lambda)};
    while (result.cost > goal && result.rounds < rounds_max) {
        for (std::size_t k = 0; k < rounds_between_checks; ++k)
            move(raw, x, static_cast<float>(lambda), size);
        result.rounds += rounds_between_checks;
        result.cost = cost_of(raw, x, lambda);
    }
    return result;
}

}  // namespace

double strain_cost(const std::vector<Vec3>& raw, const std::vector<Vec3>& p, double lambda) {
    return cost_of(raw, p, lambda);
}
double strain_cost(const std::vector<Quat>& raw, const std::vector<Quat>& q, double lambda) {
    return cost_of(raw, q, lambda);
}
DescentResult descend(const std::vector<Vec3>& raw, std::vector<Vec3>& p, double lambda,
                      double goal, std::size_t rounds_max) {
    return descend_to(raw, p, lambda, goal, rounds_max);
}
DescentResult descend(const std::vector<Quat>& raw, std::vector<Quat>& q, double lambda,
                      double goal, std::size_t rounds_max) {
    return descend_to(raw, q, lambda, goal, rounds_max);
}

}  // namespace fairlead::sim
