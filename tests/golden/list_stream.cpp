// Prints what a stream says: list_stream FILE. The texts in this folder are its output.
#include <cstdio>

#include "tests/golden/listing.hpp"

int main(int argc, char** argv) {
    std::FILE* file = argc == 2 ? std::fopen(argv[1], "rb") : nullptr;
    if (file == nullptr) {
        std::fprintf(stderr, "usage: list_stream FILE\n");
        return 2;
    }
    static fairlead::test::Listing listing;
    for (int byte; (byte = std::fgetc(file)) != EOF;) listing.push(static_cast<std::uint8_t>(byte));
    std::fclose(file);
    listing.finish();
    std::fputs(listing.text.c_str(), stdout);
    return 0;
}
