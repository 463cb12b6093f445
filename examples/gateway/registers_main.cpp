// build/fairlead-registers: writes every file that is printed from the register map, or with
// --check says which of them are stale (exit code 1).
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "examples/gateway/map_text.hpp"

int main(int argc, char** argv) {
    const bool check = argc == 2 && std::string{argv[1]} == "--check";
    if (argc > 1 && !check) {
        std::fputs("usage: fairlead-registers [--check]   (in the project's folder)\n", stderr);
        return 64;
    }
    int stale = 0;
    for (const auto& file : fairlead::gateway::generated_files) {
        const std::string text = file.text();
        if (check) {
            std::ifstream in{file.path, std::ios::binary};
            const std::string now{std::istreambuf_iterator<char>{in}, {}};
            if (now == text) continue;
            std::fprintf(stderr, "%s is stale: run `make registers`\n", file.path);
            stale = 1;
        } else if (!(std::ofstream{file.path, std::ios::binary} << text).flush()) {
            std::fprintf(stderr, "cannot write %s\n", file.path);
            return 73;
        }
    }
    return stale;
}
