#include "host_sim/study/bench_cubics/tables.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace fairlead::sim::cubics {
namespace {

constexpr std::size_t runs = 0, classes = 6, lines = 78;  // first rows of values

std::size_t length_class(std::int32_t h) { return h <= 12 ? 0 : h <= 30 ? 1 : 2; }
std::size_t size_of(std::size_t symbol) {
    return symbol == code::value_escape ? 16 : (symbol + 1) / 2;
}

/// A row of probabilities as costs in 1/16 bit, rounded up, so that the frequencies fit.
template <std::size_t N>
std::array<std::uint8_t, N> costs_of(const std::array<double, N>& weight) {
    double sum = 0;
    for (const double w : weight) sum += w;
    std::array<std::uint8_t, N> cost{};
    for (std::size_t i = 0; i < N; ++i)
        cost[i] = static_cast<std::uint8_t>(
            std::min(double{code::cost_max}, std::ceil(-16 * std::log2(weight[i] / sum))));
    const auto total = [&cost] {
        std::uint32_t all = 0;
        for (const std::uint8_t c : cost) all += code::frequency(c);
        return all;
    };
    while (total() > 1u << code::frequency_bits) ++*std::min_element(cost.begin(), cost.end());
    return cost;
}

/// What is expected of the values of a class of |k|, before anything of its rows was counted.
std::array<double, Rows::value_size> expected_values(const Counts& counts, std::size_t size) {
    std::array<double, Rows::value_size> row{};
    double sum = 0;
    const double width = .6 + .8 * static_cast<double>(size);
    for (std::size_t s = 0; s < row.size(); ++s) {
        for (std::size_t r = 0; r < 9; ++r) row[s] += counts.value[classes + size * 9 + r][s];
        row[s] += s == code::value_escape
                      ? .2
                      : .02 + 2 / width * std::pow(width / (1 + width), size_of(s));
        sum += row[s];
    }
    for (double& p : row) p /= sum;
    return row;
}

void train_values(const Counts& counts, Costs& costs) {
    for (std::size_t r = 0; r < Rows::value_count; ++r) {
        auto row = counts.value[r];
        const bool classed = r >= classes && r < lines;
        std::array<double, Rows::value_size> expected{};
        if (classed) expected = expected_values(counts, (r - classes) / 9);
        const double decay = r < 3 || r >= lines ? 8. / 9 : 4. / 5;
        for (std::size_t s = 0; s < row.size(); ++s)
            row[s] += classed                   ? 12 * expected[s]
                      : s == code::value_escape ? .5
                                                : .1 + std::pow(decay, size_of(s));
        costs.value[r] = costs_of(row);
    }
}

void train_ways(const Counts& counts, Costs& costs) {
    for (std::size_t bucket = 0; bucket < 8; ++bucket) {
        std::array<double, Rows::way_size> all{.5, .5, .01};
        double sum = 0;
        for (std::size_t c = 0; c < 17; ++c)
            for (std::size_t w = 0; w < all.size(); ++w) all[w] += counts.way[c * 8 + bucket][w];
        for (const double w : all) sum += w;
        for (std::size_t c = 0; c < 17; ++c) {
            auto row = counts.way[c * 8 + bucket];
            double mine = 4;
            for (std::size_t w = 0; w < row.size(); ++w) row[w] += 4 * all[w] / sum, mine += row[w];
            for (std::size_t w = 0; w < row.size(); ++w)  // nothing is impossible
                row[w] = std::max(row[w], mine * (w == 2 ? 5e-4 : 2e-3));
            costs.way[c * 8 + bucket] = costs_of(row);
        }
    }
}

}  // namespace

template <std::size_t N>
std::size_t way_row(const State<N>& state, std::int32_t left) {
    const double x = static_cast<double>(left) / state.last_ticks;
    const std::size_t bucket = x < .4    ? 0
                               : x < .7  ? 1
                               : x < 1   ? 2
                               : x < 1.3 ? 3
                               : x < 1.7 ? 4
                               : x < 2.5 ? 5
                               : x < 4   ? 6
                                         : 7;
    return std::min<std::size_t>(state.last_code, 16) * 8 + bucket;
}

template <std::size_t N>
std::size_t length_row(const State<N>& state) {
    return state.run > 0 ? 17 : std::min<std::size_t>(state.last_code, 16);
}

template <std::size_t N>
std::size_t value_row(const State<N>& state, std::size_t c, std::int32_t h, bool line, bool moved) {
    if (line) return lines + length_class(h);
    if (state.run > 0) return runs + (state.run == 2 ? 0 : 3) + length_class(h);
    // the size of the last residuals, and of the bend, in 1/1024 steps
    const std::int64_t bend = curve::ahead(state.at[c], h).bend;
    const std::int64_t size = 512 * std::abs(state.last_k[c]) + 256 * std::abs(state.before_k[c]) +
                              std::abs(bend) / 4 + 12;
    constexpr std::int64_t limit[] = {358, 819, 1536, 2662, 4301, 7168, 12288};
    std::size_t of = 0;
    while (of < 7 && size > limit[of]) ++of;
    const std::size_t third = N == 1 ? length_class(h) : c == 0 ? 0u : moved ? 2u : 1u;
    return classes + (of * 3 + curve::length_ratio(h, state.last_ticks)) * 3 + third;
}

template <std::size_t N>
void count(Counts& counts, const State<N>& s, std::int32_t left, const Piece<N>& p) {
    const bool line = curve::is_line(p.code);
    if (p.code == curve::code::jump) return;
    const std::int32_t h = p.subs / curve::subs_per_tick;
    const bool ends = p.code == curve::code::to_end;
    if (s.run == 0 && !s.loose())
        ++counts.way[way_row(s, left)][static_cast<std::size_t>(line   ? Way::breaks
                                                                : ends ? Way::to_end
                                                                       : Way::listed)];
    if (line) ++counts.line[p.code - curve::code::line];
    if (!line && !ends && (s.run == 0 || s.run == 3)) ++counts.length[length_row(s)][p.code];
    if (s.run == 3) return;
    bool moved = false;
    for (std::size_t c = 0; c < N; ++c) {
        const std::size_t row = value_row(s, c, h, line, moved);
        ++counts.value[row][code::value_symbol(p.k[c], told_sign(s, c, line))];
        moved = moved || p.k[c] != 0;
    }
}

template std::size_t way_row(const State<1>&, std::int32_t);
template std::size_t way_row(const State<3>&, std::int32_t);
template std::size_t length_row(const State<1>&);
template std::size_t length_row(const State<3>&);
template std::size_t value_row(const State<1>&, std::size_t, std::int32_t, bool, bool);
template std::size_t value_row(const State<3>&, std::size_t, std::int32_t, bool, bool);
template void count(Counts&, const State<1>&, std::int32_t, const Piece<1>&);
template void count(Counts&, const State<3>&, std::int32_t, const Piece<3>&);

Costs train(const Counts& counts) {
    Costs costs;
    train_ways(counts, costs);
    for (std::size_t r = 0; r < Rows::length_count; ++r) {
        auto row = counts.length[r];
        for (std::size_t s = 0; s < row.size(); ++s) {
            const double away = std::fabs(static_cast<double>(s) - static_cast<double>(r));
            row[s] += r < curve::length_count ? 1.5 / (1 + away) : 1;
        }
        costs.length[r] = costs_of(row);
    }
    auto line = counts.line;
    for (double& w : line) w += 1;
    costs.line = costs_of(line);
    train_values(counts, costs);
    return costs;
}

bool write_tables(const Costs& costs, const std::string& file) {
    std::ofstream out{file};
    const auto row = [&out](const auto& costs_of_row) {
        out << "{";
        for (std::size_t i = 0; i < costs_of_row.size(); ++i)
            out << (i > 0 ? ", " : "") << static_cast<unsigned>(costs_of_row[i]);
        out << "}";
    };
    const auto rows = [&](const auto& all) {
        out << "    {\n";
        for (const auto& one : all) out << "        ", row(one), out << ",\n";
        out << "    },\n";
    };
    out << "#pragma once\n"
           "// Generated (build/bench-cubics --tables). Costs of symbols in 1/16 bit; "
           "code/cubic_model.hpp\n"
           "// says what the rows are. Trained on the positions of the 13 recordings of "
           "tracker120\n"
           "// (BROAD): delay 120 records, 1 and 5 mm.\n"
           "#include \"fairlead/code/cubic_model.hpp\"\n\n"
           "// clang-format off\n"
           "namespace fairlead::code {\n\n"
           "template <std::size_t N>\nextern const CubicCosts cubic_costs;\n\n"
           "template <>\ninline constexpr CubicCosts cubic_costs<1>{\n";
    rows(costs.way);
    rows(costs.length);
    out << "    ";
    row(costs.line);
    out << ",\n";
    rows(costs.value);
    out << "};\n\n}  // namespace fairlead::code\n// clang-format on\n";
    return static_cast<bool>(out.flush());
}

double value_bits(const Costs& costs, std::size_t row, std::int32_t k, std::int8_t sign) {
    std::uint8_t all[code::value_symbols];
    std::copy(costs.value[row].begin(), costs.value[row].end(), all);
    return code::value_cost(all, k, sign) / 16.0;
}

double plain_bits(std::int32_t k) {
    return 5.0 + code::bit_count(static_cast<std::uint32_t>(std::abs(k)));
}

}  // namespace fairlead::sim::cubics
