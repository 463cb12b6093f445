// Streams at rest: each version of the library decodes them as the version that wrote them. A
// change of what they say is a change of the format, and needs a new version (docs/stream.md).
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "fairlead/base/crc32.hpp"
#include "tests/golden/listing.hpp"

namespace fairlead::test {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

std::string folder() { return "tests/golden/v" + std::to_string(unsigned{wire::stream_version}); }

TEST(Golden, StreamsSayWhatTheySaid) {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator{folder()}) {
        if (entry.path().extension() != ".bin") continue;
        ++count;
        Listing listing;
        for (const char byte : content(entry.path())) listing.push(static_cast<std::uint8_t>(byte));
        listing.finish();
        const std::string expected = content(fs::path{entry.path()}.replace_extension(".txt"));
        ASSERT_FALSE(expected.empty()) << entry.path();
        EXPECT_TRUE(listing.text == expected)
            << entry.path() << " decodes differently: a new version of the format is due";
        EXPECT_EQ(listing.decoder.counters().nonsense, 0u);
    }
    EXPECT_GE(count, 7u);
}

TEST(Golden, TablesAreThoseOfTheSpecification) {
    std::vector<std::uint8_t> specified;
    const std::string text = content("docs/stream_tables.json");
    std::size_t at = 0;
    for (bool digits = false; at < text.size(); ++at) {
        const bool digit = std::isdigit(static_cast<unsigned char>(text[at])) != 0;
        if (digit && !digits) specified.push_back(0);
        if (digit)
            specified.back() = static_cast<std::uint8_t>(specified.back() * 10 + (text[at] - '0'));
        digits = digit;
    }
    std::vector<std::uint8_t> ours;
    const auto add = [&](const auto& costs, std::uint8_t kind, std::uint8_t components) {
        ours.insert(ours.end(), {kind, components});
        for (const auto& row : costs.length)
            ours.insert(ours.end(), std::begin(row), std::end(row));
        for (const auto& row : costs.value) ours.insert(ours.end(), std::begin(row), std::end(row));
    };
    add(code::costs<curve::Smooth, 1>, 1, 1);
    add(code::costs<curve::Smooth, 3>, 1, 3);
    const code::CubicCosts& cubics = code::cubic_costs<1>;
    ours.insert(ours.end(), {curve::Cubics::id, 1});
    for (const auto& row : cubics.way) ours.insert(ours.end(), std::begin(row), std::end(row));
    for (const auto& row : cubics.length) ours.insert(ours.end(), std::begin(row), std::end(row));
    ours.insert(ours.end(), std::begin(cubics.line), std::end(cubics.line));
    for (const auto& row : cubics.value) ours.insert(ours.end(), std::begin(row), std::end(row));
    EXPECT_TRUE(ours == specified) << "make tables writes docs/stream_tables.json too";
}

TEST(Golden, AnUnknownVersionIsRefusedByItsName) {
    std::string bytes = content(folder() + "/both.bin");
    const std::size_t size = 2 + static_cast<std::uint8_t>(bytes[1]);
    bytes[2] = static_cast<char>(wire::stream_version + 1);
    const std::uint32_t crc = crc32(bytes.data(), size);
    for (std::size_t i = 0; i < 4; ++i) bytes[size + i] = static_cast<char>(crc >> (8 * i));
    Listing listing;
    for (const char byte : bytes) {
        listing.push(static_cast<std::uint8_t>(byte));
        if (listing.decoder.refused() != ListingDecoder::Refused::nothing) break;
    }
    EXPECT_EQ(listing.decoder.refused(), ListingDecoder::Refused::version);
    EXPECT_EQ(listing.text, "");
}

}  // namespace
}  // namespace fairlead::test
