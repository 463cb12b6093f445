// The small types below everything: flags, bytes, checks of ranges, unrolled loops, CRC-32.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "fairlead/base/bytes.hpp"
#include "fairlead/base/check.hpp"
#include "fairlead/base/crc32.hpp"
#include "fairlead/base/each.hpp"
#include "fairlead/base/types.hpp"

using namespace fairlead;

TEST(Base, FlagsAreTheBitsThatThePageOfTypesSays) {
    const std::map<std::string, flag::Bits> ours{{"position_valid", flag::position_valid},
                                                 {"orientation_valid", flag::orientation_valid},
                                                 {"gap_before", flag::gap_before},
                                                 {"position_gap", flag::position_gap},
                                                 {"orientation_gap", flag::orientation_gap},
                                                 {"clipped", flag::clipped},
                                                 {"stuck", flag::stuck},
                                                 {"settling", flag::settling},
                                                 {"mag_rejected", flag::mag_rejected},
                                                 {"rest", flag::rest},
                                                 {"gyro_valid", flag::gyro_valid},
                                                 {"accel_valid", flag::accel_valid},
                                                 {"mag_valid", flag::mag_valid},
                                                 {"gyro_clipped", flag::gyro_clipped},
                                                 {"accel_clipped", flag::accel_clipped},
                                                 {"mag_clipped", flag::mag_clipped},
                                                 {"temperature_valid", flag::temperature_valid},
                                                 {"new_run", flag::new_run},
                                                 {"new_grid", flag::new_grid}};
    std::ifstream page{"docs/types.md"};
    std::set<std::string> seen;
    for (std::string line; std::getline(page, line);) {
        if (line.size() < 3 || line[0] != '|' || line[2] < '0' || line[2] > '9') continue;
        const std::size_t cell = line.find('|', 2), end = line.find('|', cell + 1);
        for (std::size_t at = line.find('`', cell); at < end; at = line.find('`', at)) {
            const std::size_t close = line.find('`', at + 1);
            const auto flag = ours.find(line.substr(at + 1, close - at - 1));
            at = close + 1;
            if (flag == ours.end()) continue;  // another name of the same bit
            EXPECT_EQ(flag->second, flag::Bits{1} << std::stoul(line.substr(2))) << flag->first;
            seen.insert(flag->first);
        }
    }
    EXPECT_EQ(seen.size(), ours.size()) << "a flag is not on the page";
}

TEST(Base, BytesAreARange) {
    const std::uint8_t data[] = {1, 2, 3};
    const Bytes some{data, 3, Status::ok}, none{data, 0, Status::ok};
    EXPECT_FALSE(some.empty());
    EXPECT_TRUE(none.empty());
    std::vector<int> seen;
    for (const std::uint8_t byte : some) seen.push_back(byte);
    EXPECT_EQ(seen, (std::vector<int>{1, 2, 3}));
    for (const std::uint8_t byte : none) FAIL() << int{byte};
}

TEST(Base, TheFirstValueOutsideItsRangeIsNamed) {
    const auto refused = [](std::array<int, 3> v) {
        detail::FirstRefused visit;
        visit("a", v[0], 1, 5);
        visit("b", v[1], 1, 5);
        visit("c", v[2], 1, 5);
        return visit.result();
    };
    EXPECT_TRUE(refused({1, 5, 3}));
    EXPECT_EQ(refused({1, 5, 3}).field, std::string{});
    EXPECT_EQ(refused({0, 6, 3}).field, std::string{"a"});
    EXPECT_EQ(refused({1, 6, 0}).field, std::string{"b"});
    EXPECT_EQ(refused({1, 5, 0}).field, std::string{"c"});
    EXPECT_EQ(refused({1, 5, 6}).status, Status::bad_argument);
    detail::FirstRefused visit;
    visit("not a number", std::numeric_limits<float>::quiet_NaN(), 1.0f, 5.0f);
    EXPECT_FALSE(visit.result());
}

TEST(Base, EachVisitsEveryIndexOnceInOrder) {
    std::vector<std::size_t> seen;
    each<5>([&](auto i) { seen.push_back(i); });
    EXPECT_EQ(seen, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
    each<0>([&](auto) { FAIL(); });
}

// the check value of CRC-32 (ISO 3309, as in Ethernet and zip), and sums made in pieces
TEST(Base, Crc32) {
    const char digits[] = "123456789";
    EXPECT_EQ(crc32(digits, 9), 0xCBF43926u);
    EXPECT_EQ(crc32(digits, 0), 0u);
    for (std::size_t n = 0; n <= 9; ++n)
        EXPECT_EQ(crc32(digits + n, 9 - n, crc32(digits, n)), 0xCBF43926u) << n;
}
