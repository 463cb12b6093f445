// Progress: after two seconds, on a terminal only, with a rate and the time left.
#include <gtest/gtest.h>

#include <string>

#include "host_sim/recording/progress.hpp"

using namespace fairlead::sim;

namespace {

double clock_s = 0;
double now() { return clock_s; }

/// What a run of `seconds` writes that counts 100 records a second, of 2000.
std::string written(bool terminal, double seconds, std::size_t total = 2000, double begun_s = -1) {
    std::FILE* file = std::tmpfile();
    clock_s = 50;
    {
        Progress progress{"replay", total, "records", {file, terminal, now, begun_s}};
        for (std::size_t done = 0; clock_s < 50 + seconds; ++done, clock_s += 0.01)
            progress.show(done);
    }
    std::string text(1 << 16, '\0');
    std::rewind(file);
    text.resize(std::fread(text.data(), 1, text.size(), file));
    std::fclose(file);
    return text;
}

}  // namespace

TEST(Progress, IsSilentForShortWorkAndInAPipe) {
    EXPECT_EQ(written(true, 1.9), "");
    EXPECT_EQ(written(false, 15), "");
}

TEST(Progress, CountsTheTwoSecondsFromTheCommandsStart) {
    const double start_s = 50;
    EXPECT_NE(written(true, 1, 2000, start_s - 5), "") << "the third stage of a long command";
    EXPECT_EQ(written(true, 0.15, 2000, start_s - 5), "") << "a stage that is done at once";
    EXPECT_EQ(written(true, 0.9, 2000, start_s - 1), "");
}

TEST(Progress, TellsShareRateAndTimeLeft) {
    const std::string text = written(true, 10.05);
    EXPECT_EQ(text.substr(0, 50), "\r\033[Kreplay:  10 %, 100 records/s, 18 s left\r\033[Krep");
    EXPECT_NE(text.find("replay:  49 %, 100 records/s, 11 s left"), std::string::npos);
    EXPECT_EQ(text.substr(text.size() - 4), "\r\033[K") << "the line is taken away";
    std::size_t lines = 0;
    for (const char c : text) lines += c == '\r' ? 1 : 0;
    EXPECT_LT(lines, 50u) << "a few times a second";
    EXPECT_NE(written(true, 3, 0).find("100 records/s"), std::string::npos);
    EXPECT_NE(written(true, 3, 1000000).find("2 h 46 min left"), std::string::npos);
}
