#pragma once
// A mask on a whole segment in double, straight from Lee & Shin 2002: eq. (17), (18) with the taps
// themselves (no partial sums), ends by repeated use of eq. (26).
#include <algorithm>
#include <cstddef>
#include <vector>

#include "tests/ref/rotation.hpp"

namespace ref {

using Taps = std::vector<double>;

/// Half rotation vectors between neighbours.
inline std::vector<V> steps_of(const std::vector<Q>& q) {
    std::vector<V> w;
    for (std::size_t i = 0; i + 1 < q.size(); ++i)
        w.push_back(0.5 * to_vector(mul(inverse(q[i]), q[i + 1])));
    return w;
}
inline std::vector<V> steps_of(const std::vector<V>& p) {
    std::vector<V> w;
    for (std::size_t i = 0; i + 1 < p.size(); ++i) w.push_back(p[i + 1] - p[i]);
    return w;
}
inline Q moved(const Q& q, const V& by) { return mul(q, from_vector(2 * by)); }
inline V moved(const V& p, const V& by) { return p + by; }

/// Eq. (26) on n displacements.
inline V extended(const std::vector<V>& w, long n, long i) {
    if (n == 0) return {};
    if (n == 1) return w[0];
    while (i < 0 || i >= n) i = i < 0 ? -i : 2 * n - i - 2;
    return w[static_cast<std::size_t>(i)];
}

/// Eq. (17) for sample i when the first `known` samples are there.
template <class Value>
Value masked(const std::vector<Value>& x, const Taps& a, long centre, long i, long known) {
    const std::vector<V> w = steps_of(x);
    const long n = known - 1;
    V sum{};
    for (long t = 0; t < static_cast<long>(a.size()); ++t) {
        const long m = t - centre;
        V p{};
        for (long j = 0; j < m; ++j) p = p + extended(w, n, i + j);
        for (long j = m; j < 0; ++j) p = p - extended(w, n, i + j);
        sum = sum + a[static_cast<std::size_t>(t)] * p;
    }
    return moved(x[static_cast<std::size_t>(i)], sum);
}

/// The whole segment, every sample known.
template <class Value>
std::vector<Value> masked(const std::vector<Value>& x, const Taps& a, long centre) {
    std::vector<Value> out;
    for (long i = 0; i < static_cast<long>(x.size()); ++i)
        out.push_back(masked(x, a, centre, i, static_cast<long>(x.size())));
    return out;
}

/// The whole segment as a stream knows it: sample i is due when i + ahead is there.
template <class Value>
std::vector<Value> masked_stream(const std::vector<Value>& x, const Taps& a, long centre) {
    const long ahead = static_cast<long>(a.size()) - 1 - centre, n = static_cast<long>(x.size());
    std::vector<Value> out;
    for (long i = 0; i < n; ++i) out.push_back(masked(x, a, centre, i, std::min(n, i + ahead + 1)));
    return out;
}

}  // namespace ref
