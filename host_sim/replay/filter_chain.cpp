#include "host_sim/replay/filter_chain.hpp"

#include <cstdio>
#include <vector>

#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {

const char* const filter_help =
    "SPEC = FILTER { '+' FILTER }, applied from left to right, for example binomial:9+csg:7:2\n"
    "    binomial:N              binomial mask of N taps, N odd\n"
    "    hs:LAMBDA               smoothing mask H^S\n"
    "    hu:LAMBDA               sharpening mask H^U\n"
    "    sg:N:P                  Savitzky-Golay, N taps (odd), degree P, centred\n"
    "    csg:N:P                 the same read at the newest sample: no latency\n"
    "    late:N:P:LAG            read LAG samples back, any number; P from 1 (line) to 2 "
    "(parabola)\n"
    "    zerolag:GAIN            causal, no lag at constant rate, noise GAIN times the input's\n"
    "    taps:A,B,...@CENTRE     taps of your own, oldest first, centre counted from 0\n"
    "    adaptive:HZ:SLOPE       causal, cut-off HZ at rest, growing by SLOPE Hz per rad/s or m/s\n"
    "    strain:HZ[:LAG]         strain smoothing, cut-off HZ; LAG records late, 0 to 400\n"
    "                            [as many as make it exact: 3 / (HZ x period)]\n"
    "    fair:M:DAMPING:ROUNDS[:BOUND_M:BOUND_RAD]\n"
    "                            fairing by rho_2 or rho_3 (M), DAMPING below 0.5, up to 100 "
    "rounds;\n"
    "                            no pose moves by more than the bounds   [none]";

namespace {

using AMask = AnyMask<taps_max>;
constexpr long taps_most = static_cast<long>(taps_max);

std::size_t odd_size(const SpecItem& item) {
    const long n = item.whole(0, 1, taps_most);
    if (n % 2 == 0) item.refuse("a centred mask has an odd number of taps");
    return static_cast<std::size_t>(n);
}

AMask checked(const Result<AMask>& mask, const SpecItem& item) {
    if (!mask) item.refuse("not a mask: its taps must be finite and sum to 1");
    return *mask;
}

AMask own_taps(const SpecItem& item) {
    item.expect_arguments(1, 1);
    const auto halves = split(item.arguments[0], '@');
    if (halves.size() != 2) item.refuse("expected taps:A,B,...@CENTRE");
    std::vector<double> taps;
    double centre{};
    try {
        for (const std::string& text : split(halves[0], ',')) taps.push_back(parse_real(text));
        centre = parse_real(halves[1]);
    } catch (const BadSpec& error) {
        item.refuse(error.what());
    }
    if (taps.size() > taps_max) item.refuse("at most 257 taps");
    if (!(centre >= 0 && centre < static_cast<double>(taps.size())) ||
        static_cast<double>(static_cast<std::size_t>(centre)) != centre)
        item.refuse("the centre is the index of a tap, counted from 0");
    return checked(AMask::from_taps(taps.data(), taps.size(), static_cast<std::size_t>(centre)),
                   item);
}

AMask savitzky_golay(const SpecItem& item, bool causal) {
    item.expect_arguments(2, 2);
    const std::size_t n =
        causal ? static_cast<std::size_t>(item.whole(0, 1, taps_most)) : odd_size(item);
    const long degree = item.whole(1, 0, static_cast<long>(n) - 1);
    return checked(
        AMask::savitzky_golay(n, static_cast<std::size_t>(degree), causal ? n - 1 : n / 2), item);
}

AMask late_mask_of(const SpecItem& item) {
    item.expect_arguments(3, 3);
    const long n = item.whole(0, 2, taps_most);
    const double late = item.number(2, 0, static_cast<double>(n - 1));
    return checked(AMask::late(static_cast<std::size_t>(n), item.number(1, 1, 2), late), item);
}

AMask mask_of(const SpecItem& item) {
    if (item.name == "binomial") {
        item.expect_arguments(1, 1);
        return checked(AMask::binomial(odd_size(item)), item);
    }
    if (item.name == "hs" || item.name == "hu") {
        item.expect_arguments(1, 1);
        const double lambda = item.number(0, -1000, 1000);
        return checked(item.name == "hs" ? AMask::smoothing(lambda) : AMask::sharpening(lambda),
                       item);
    }
    if (item.name == "sg") return savitzky_golay(item, false);
    if (item.name == "csg") return savitzky_golay(item, true);
    if (item.name == "late") return late_mask_of(item);
    if (item.name == "zerolag") {
        item.expect_arguments(1, 1);
        const auto mask = AMask::zero_lag(item.number(0, 1e-6, 1));
        if (!mask) item.refuse("needs more than 257 taps: about 4 / GAIN^2");
        return *mask;
    }
    if (item.name == "taps") return own_taps(item);
    item.refuse(
        "unknown filter: binomial, hs, hu, sg, csg, late, zerolag, taps, adaptive, strain or fair");
}

NamedFilter adaptive_of(const SpecItem& item) {
    item.expect_arguments(2, 2);
    const AdaptiveParams params{static_cast<float>(item.number(0, 1e-3, 1e6)),
                                static_cast<float>(item.number(1, 0, 1e6))};
    return NamedFilter{AdaptivePoseFilter{params, params}};
}

NamedFilter strain_of(const SpecItem& item, double step_s) {
    item.expect_arguments(1, 2);
    const auto hz = static_cast<float>(item.number(0, 1e-6, 1e6));
    const auto step = static_cast<float>(step_s);
    if (const char* wrong = strain_weight_error(hz, step)) {
        char at[64];
        std::snprintf(at, sizeof at, " (at %.6g records a second)", 1 / step_s);
        item.refuse(wrong + std::string(at));
    }
    const long lag = item.arguments.size() > 1 ? item.whole(1, 0, static_cast<long>(lag_max))
                                               : static_cast<long>(strain_lag(hz, step));
    return NamedFilter{Boxed{NamedFilter::Strain{*StrainParams::from_cutoff(hz, step, 1),
                                                 static_cast<std::size_t>(lag)}}};
}

NamedFilter fairing_of(const SpecItem& item) {
    if (item.arguments.size() != 3) item.expect_arguments(5, 5);
    const long order = item.whole(0, 2, 3);
    FairingParams params;
    params.damping_p = params.damping_q = static_cast<float>(item.number(1, 1e-3, 0.499));
    const auto rounds = static_cast<std::size_t>(item.whole(2, 1, static_cast<long>(rounds_max)));
    if (item.arguments.size() == 5) {
        params.bound_m = static_cast<float>(item.number(3, 0, 1e6));
        params.bound_rad = static_cast<float>(item.number(4, 0, 4));
    }
    if (order == 2) return NamedFilter{Boxed{NamedFilter::Fairing2{rounds, params}}};
    return NamedFilter{Boxed{NamedFilter::Fairing3{rounds, params}}};
}

NamedFilter filter_of(const SpecItem& item, double step_s) {
    if (item.name == "adaptive") return adaptive_of(item);
    if (item.name == "strain") return strain_of(item, step_s);
    if (item.name == "fair") return fairing_of(item);
    return NamedFilter{mask_of(item)};
}

}  // namespace

FilterChain parse_filters(const std::string& spec, double step_s) {
    FilterChain chain;
    if (spec.empty()) return chain;
    for (const SpecItem& item : parse_spec(spec))
        if (chain.append(filter_of(item, step_s)) != Status::ok)
            throw BadSpec("'" + spec + "': at most 8 filters in a chain");
    return chain;
}

}  // namespace fairlead::sim
