// docs/parameters.md tells the defaults and ranges that the source has: every field has its row,
// and every row a field.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/intake_params.hpp"
#include "fairlead/smooth/adaptive.hpp"
#include "fairlead/smooth/fairing.hpp"
#include "fairlead/smooth/strain_weight.hpp"
#include "fairlead/stream_params.hpp"

namespace {

using namespace fairlead;

/// As the page writes numbers: integers in full, others with the digits that they need.
std::string text(std::int64_t v) { return v == never_ns ? "never_ns" : std::to_string(v); }
std::string text(std::uint32_t v) { return std::to_string(v); }
std::string text(float v) {
    char out[32];
    std::snprintf(out, sizeof out, "%.7g", static_cast<double>(v));
    return std::string{out} == "1e+06" ? "1000000" : out;
}

struct Row {
    std::string value, least, greatest;
    bool operator==(const Row& o) const {
        return value == o.value && least == o.least && greatest == o.greatest;
    }
};
void PrintTo(const Row& row, std::ostream* out) {
    *out << "default " << row.value << ", " << row.least << " to " << row.greatest;
}

/// The rows of the section that starts with a heading: the first cell in backquotes is the name.
std::map<std::string, Row> rows_of(const std::string& heading) {
    std::ifstream page{"docs/parameters.md"};
    EXPECT_TRUE(page) << "run the tests from the project's folder";
    std::map<std::string, Row> rows;
    bool inside = false;
    for (std::string line; std::getline(page, line);) {
        if (line.rfind("## ", 0) == 0) inside = line.rfind("## " + heading, 0) == 0;
        if (!inside || line.rfind("| `", 0) != 0) continue;
        std::vector<std::string> cells;
        std::istringstream in{line};
        for (std::string cell; std::getline(in, cell, '|');) {
            const std::size_t from = cell.find_first_not_of(" `"), to = cell.find_last_not_of(" `");
            cells.push_back(from == std::string::npos ? "" : cell.substr(from, to - from + 1));
        }
        EXPECT_EQ(cells.size(), 8u) << line;
        if (cells.size() < 8) continue;
        EXPECT_FALSE(cells[2].empty() || cells[6].empty() || cells[7].empty()) << line;
        EXPECT_TRUE(rows.emplace(cells[1], Row{cells[3], cells[4], cells[5]}).second) << line;
    }
    return rows;
}

template <class Params>
void add(std::map<std::string, Row>& rows, const Params& params) {
    Params::each(params, [&rows](const char* name, auto value, auto least, auto greatest) {
        rows[name] = {text(value), text(least), text(greatest)};
    });
}

TEST(Parameters, ThePageTellsTheIntakes) {
    std::map<std::string, Row> rows;
    add(rows, IntakeParams{});
    EXPECT_EQ(rows_of("The intake"), rows);
}

TEST(Parameters, ThePageTellsTheStreams) {
    constexpr std::size_t board = 120;
    std::map<std::string, Row> rows;
    add(rows, StreamParams<Channels<Position, Orientation>, board>{});
    add(rows, StreamParams<Channels<Vector<3>>, board>{});
    Row& delay = rows["delay_records"];
    EXPECT_EQ(delay, (Row{"120", "16", "120"}));
    delay.value = delay.greatest = "the board's";
    EXPECT_EQ(rows_of("The stream"), rows);
}

// docs/types.md: every flag with its bit, in order.
TEST(Parameters, ThePageOfTypesHasEveryFlag) {
    std::ifstream types{"lib/include/fairlead/base/types.hpp"}, page{"docs/types.md"};
    std::stringstream source, told;
    source << types.rdbuf();
    told << page.rdbuf();
    const std::regex flag{R"(Bits (\w+) =\s+1u << (\d+);)"};
    const std::string text = source.str();
    int found = 0;
    for (std::sregex_iterator i{text.begin(), text.end(), flag}, end; i != end; ++i, ++found) {
        const std::string bit = "| " + (*i)[2].str() + " | `" + (*i)[1].str() + "`";
        EXPECT_NE(told.str().find(bit), std::string::npos) << bit;
    }
    EXPECT_EQ(found, 19);
}

/// Each field beyond either end of its range is the one that is named; how many there are.
template <class Params>
std::size_t refuse_each(Params params) {
    EXPECT_TRUE(check(params));
    std::set<std::string> named;
    Params::each(params, [&](const char* name, auto& value, auto least, auto greatest) {
        const auto good = value;
        const auto refused = [&] {
            const Check found = check(params);
            EXPECT_FALSE(found);
            EXPECT_EQ(found.status, Status::bad_argument);
            EXPECT_STREQ(found.field, name);
        };
        using Number = std::remove_reference_t<decltype(value)>;
        if constexpr (std::is_floating_point_v<Number>) {
            value = least - 1;
            refused();
            if (std::isfinite(greatest)) {
                value = greatest * 1.1f;
                refused();
            }
            value = std::numeric_limits<Number>::quiet_NaN();
            refused();
        } else {
            if (least > std::numeric_limits<Number>::min()) {
                value = least - 1;
                refused();
            }
            if (greatest < std::numeric_limits<Number>::max()) {
                value = greatest + 1;
                refused();
            }
        }
        value = greatest;
        EXPECT_TRUE(detail::check_ranges(params)) << name;
        value = least;
        EXPECT_TRUE(detail::check_ranges(params)) << name;
        value = good;
        named.insert(name);
    });
    return named.size();
}

TEST(Parameters, AreCheckedOneByOne) {
    EXPECT_EQ(refuse_each(IntakeParams{}), 9u);
    EXPECT_EQ(refuse_each(AttitudeParams{}), sizeof(AttitudeParams) / sizeof(float));
    EXPECT_EQ(refuse_each(AdaptiveParams{}), 2u);
    EXPECT_EQ(refuse_each(FairingParams{}), 4u);
    EXPECT_EQ(refuse_each(*StrainParams::from_cutoff(5, 0.01f)), 1u);
}

// A board can ask them when it is compiled.
static_assert(check(AttitudeParams{}) && check(AdaptiveParams{}) && check(FairingParams{}));
static_assert(check(StrainParams{}));

}  // namespace
