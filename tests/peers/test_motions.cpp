// Real hands: where nothing is missing, no curve breaks.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "host_sim/replay/replay.hpp"
#include "host_sim/study/baselines/track.hpp"
#include "host_sim/study/bench_peers/subjects.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::sim;

TEST(Recordings, HoldNoMotionThatBreaks) {
    const std::string folder = "../shared/recordings/tracker120";
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no recordings in " << folder;
    std::size_t runs = 0, samples = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const Recording whole = read_recording(entry.path().string());
        for (const Channel kind : {Channel::position, Channel::orientation}) {
            const Recording stretch = cut(whole, kind);
            ASSERT_GT(stretch.size(), 3600u) << entry.path();
            for (const bool coarse : {false, true})
                for (const Objective objective : {Objective::bytes, Objective::knots})
                    for (const Beam beam : {Beam::medium, Beam::wide}) {
                        ReplayOptions options;
                        options.tol_pos_m = tolerance_of(Channel::position, coarse);
                        options.tol_rot_rad = tolerance_of(Channel::orientation, coarse);
                        options.objective = objective;
                        options.beam = beam;
                        options.position = kind == Channel::position;
                        options.orientation = !options.position;
                        const Replay result = replay(stretch, options);
                        const auto& channel =
                            options.position ? result.position : result.orientation;
                        const std::string what = entry.path().string() + " " +
                                                 to_string(objective) + " " + to_string(beam);
                        EXPECT_EQ(channel.breaks, 0u) << what;
                        samples += channel.samples;
                        EXPECT_EQ(channel.curves, 1u) << what;
                        ++runs;
                    }
        }
    }
    EXPECT_GE(runs, 8u);
    EXPECT_GT(samples, 700'000u);
}

}  // namespace
