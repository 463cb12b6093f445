#include "host_sim/study/bench_peers/byte_rivals.hpp"

#include <algorithm>
#include <sstream>

namespace fairlead::sim {
namespace {

constexpr const char* version = "bytes-1";  // changes with every change of a rival

std::string to_text(const std::vector<Tried>& all) {
    std::ostringstream out;
    for (const Tried& tried : all)
        out << tried.rival << '|' << tried.setting << '|' << tried.bytes << '|' << tried.within
            << ';';
    return out.str();
}

std::vector<Tried> parse(const std::string& text) {
    std::vector<Tried> out;
    std::istringstream in{text};
    for (std::string item; std::getline(in, item, ';');) {
        std::istringstream fields{item};
        Tried tried;
        std::getline(fields, tried.rival, '|');
        std::getline(fields, tried.setting, '|');
        char bar = 0;
        fields >> tried.bytes >> bar >> tried.within;
        out.push_back(tried);
    }
    return out;
}

}  // namespace

std::vector<Tried> byte_rivals(const Cell& cell, std::size_t delay, Cache& cache) {
    const std::string bound = delay == no_delay_bound ? "no bound" : std::to_string(delay);
    const std::string method = std::string{version} + ' ' + bound;
    return parse(cache.get(cache_key(method, hash(cell.track), cell.tolerance),
                           [&] { return to_text(sweep(cell.track, cell.tolerance, delay)); }));
}

std::vector<Tried> best_of_each(const std::vector<Tried>& all) {
    std::vector<Tried> out;
    for (const Tried& tried : all) {
        if (!tried.within) continue;
        const auto same = [&](const Tried& other) { return other.rival == tried.rival; };
        const auto found = std::find_if(out.begin(), out.end(), same);
        if (found == out.end())
            out.push_back(tried);
        else if (tried.bytes < found->bytes)
            *found = tried;
    }
    return out;
}

}  // namespace fairlead::sim
