// Real hands: where nothing is missing, no curve breaks.
#include <gtest/gtest.h>

#include <filesystem>

#include "host_sim/replay.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::sim;

constexpr std::size_t a_minute = 7200;
constexpr std::int64_t step_max_ns = 20'000'000;  // of 8.3 ms: a record is missing
constexpr double degree = pi_v<double> / 180;

/// The longest stretch without a gap in which the flagged channel is valid, at most a minute of it.
Recording longest_stretch(const Recording& whole, std::uint32_t valid) {
    std::size_t best = 0, length = 0;
    for (std::size_t i = 0; i < whole.poses.size();) {
        std::size_t end = i;
        for (; end < whole.poses.size() && (whole.poses[end].flags & valid) != 0; ++end)
            if (end > i && whole.t_ns(end) - whole.t_ns(end - 1) > step_max_ns) break;
        if (end - i > length) {
            best = i;
            length = end - i;
        }
        i = end > i ? end : i + 1;
    }
    Recording out = whole;
    const auto from = whole.poses.begin() + static_cast<std::ptrdiff_t>(best);
    out.poses.assign(from, from + static_cast<std::ptrdiff_t>(std::min(length, a_minute)));
    return out;
}

TEST(ReducerOnRecordings, BreaksNoMotion) {
    const std::string folder = "../shared/recordings/tracker120";
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no recordings in " << folder;
    std::size_t runs = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const Recording whole = read_recording(entry.path().string());
        for (const bool position : {true, false}) {
            const Recording stretch =
                longest_stretch(whole, position ? flag::position_valid : flag::orientation_valid);
            ASSERT_GT(stretch.poses.size(), a_minute / 2) << entry.path();
            for (const bool coarse : {false, true})
                for (const Credit slice : {slice_medium, slice_large}) {
                    ReplayOptions options;
                    options.tol_pos_m = coarse ? 0.005 : 0.001;
                    options.tol_rot_rad = (coarse ? 1 : 0.25) * degree;
                    options.slice = slice;
                    options.position = position;
                    options.orientation = !position;
                    const Replay result = replay(stretch, options);
                    const auto& channel = position ? result.position : result.orientation;
                    EXPECT_EQ(channel.breaks, 0u) << entry.path() << " slice " << slice;
                    EXPECT_EQ(channel.curves, 1u) << entry.path() << " slice " << slice;
                    ++runs;
                }
        }
    }
    EXPECT_GE(runs, 8u);
}

}  // namespace
