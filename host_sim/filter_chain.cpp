#include "host_sim/filter_chain.hpp"

#include <vector>

#include "host_sim/spec.hpp"

namespace fairlead::sim {

const char* const filter_help =
    "SPEC = FILTER { '+' FILTER }, applied from left to right, for example binomial:9+csg:7:2\n"
    "    binomial:N              binomial mask of N taps, N odd\n"
    "    hs:LAMBDA               smoothing mask H^S\n"
    "    hu:LAMBDA               sharpening mask H^U\n"
    "    sg:N:P                  Savitzky-Golay, N taps (odd), degree P, centred\n"
    "    csg:N:P                 the same read at the newest sample: no latency\n"
    "    taps:A,B,...@CENTRE     taps of your own, oldest first, centre counted from 0\n"
    "    adaptive:HZ:SLOPE       causal, cut-off HZ at rest, growing by SLOPE Hz per rad/s or m/s";

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
    if (item.name == "taps") return own_taps(item);
    item.refuse("unknown filter: binomial, hs, hu, sg, csg, taps or adaptive");
}

NamedFilter filter_of(const SpecItem& item) {
    if (item.name != "adaptive") return NamedFilter{mask_of(item)};
    item.expect_arguments(2, 2);
    const AdaptiveParams params{static_cast<float>(item.number(0, 1e-3, 1e6)),
                                static_cast<float>(item.number(1, 0, 1e6))};
    return NamedFilter{AdaptivePoseFilter{params, params}};
}

}  // namespace

FilterChain parse_filters(const std::string& spec) {
    FilterChain chain;
    if (spec.empty()) return chain;
    for (const SpecItem& item : parse_spec(spec))
        if (chain.append(filter_of(item)) != Status::ok)
            throw BadSpec("'" + spec + "': at most 8 filters in a chain");
    return chain;
}

}  // namespace fairlead::sim
