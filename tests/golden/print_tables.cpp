// Prints the tables of docs/stream.md as JSON, for docs/stream_tables.json.
#include <cstdio>

#include "fairlead/code/cubic_tables.hpp"
#include "fairlead/code/tables.hpp"

namespace {
using namespace fairlead;

template <std::size_t Rows, std::size_t N>
void print(const char* name, const std::uint8_t (&rows)[Rows][N], const char* end) {
    std::printf("    \"%s\": [\n", name);
    for (std::size_t r = 0; r < Rows; ++r) {
        std::printf("      [");
        for (std::size_t i = 0; i < N; ++i) std::printf("%s%u", i > 0 ? ", " : "", rows[r][i]);
        std::printf("]%s\n", r + 1 < Rows ? "," : "");
    }
    std::printf("    ]%s\n", end);
}
template <class Kind, std::size_t N>
void print(const char* end) {
    std::printf("  {\"kind\": %u, \"components\": %zu,\n", unsigned{Kind::id}, N);
    print("length", code::costs<Kind, N>.length, ",");
    print("value", code::costs<Kind, N>.value, "");
    std::printf("  }%s\n", end);
}
void print_cubics(const char* end) {
    const auto& costs = code::cubic_costs<1>;
    std::printf("  {\"kind\": %u, \"components\": 1,\n", unsigned{curve::Cubics::id});
    std::uint8_t line[1][code::cubic_line_symbols];
    for (std::size_t i = 0; i < code::cubic_line_symbols; ++i) line[0][i] = costs.line[i];
    print("way", costs.way, ",");
    print("length", costs.length, ",");
    print("line", line, ",");
    print("value", costs.value, "");
    std::printf("  }%s\n", end);
}
}  // namespace

int main() {
    std::puts("[");
    print<curve::Smooth, 1>(",");
    print<curve::Smooth, 3>(",");
    print_cubics("");
    std::puts("]");
}
