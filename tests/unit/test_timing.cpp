// The scheduler of host_sim/replay/timing.hpp against cases small enough to play by hand.
#include <gtest/gtest.h>

#include <fstream>

#include "examples/firmware/motion.hpp"
#include "fairlead/pipeline.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/replay/timing.hpp"

namespace fairlead::sim {
namespace {

struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, Orientation>;
    using Filter = PoseFilter<9>;
    static constexpr std::size_t delay_records_max = 60;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = 0;
};

Pipeline<Board>::Params params() {
    Pipeline<Board>::Params params;
    params.sample_period_ns = motion::step_ns;
    params.filter = Board::Filter{binomial_mask<9>()};
    return params;
}

TimingModel one_megahertz() {
    TimingModel m;
    m.core_hz = 1e6;  // an instruction, a microsecond
    m.cycles_per_instruction_min = m.cycles_per_instruction_max = 1;
    m.push_budget_s = 500e-6;
    m.response_budget_s = 10e-3;
    m.wire_bytes_per_s = 1000;
    return m;
}

std::vector<TimedPush> every_millisecond(std::size_t n, std::uint64_t instructions) {
    std::vector<TimedPush> pushes(n);
    for (std::size_t i = 0; i < n; ++i)
        pushes[i] = {static_cast<std::int64_t>(i) * 1'000'000, instructions, 0};
    return pushes;
}

TEST(Timing, NamesThePushThatIsTooDear) {
    auto pushes = every_millisecond(9000, 100);
    pushes[8123].instructions = 41200;
    TimingModel m;
    m.core_hz = 168e6;
    m.cycles_per_instruction_min = m.cycles_per_instruction_max = 1;
    m.push_budget_s = 200e-6;
    const auto report = play(m, pushes);
    EXPECT_EQ(report.failures, 1u);
    ASSERT_EQ(report.messages.size(), 1u);
    EXPECT_EQ(report.messages[0],
              "push 8123: 41,200 instructions = 245 us at 168 MHz, budget 200 us");
    EXPECT_EQ(report.dearest_push, 8123u);
}

TEST(Timing, AQueueGrowsWhileAPushIsLong) {
    auto pushes = every_millisecond(10, 100);
    pushes[2].instructions = 3500;  // from 2.0 to 5.5 ms: the records of 3, 4 and 5 ms wait
    auto m = one_megahertz();
    m.push_budget_s = 5e-3;
    auto report = play(m, pushes);
    EXPECT_TRUE(report.ok()) << report.text();
    EXPECT_EQ(report.queue_max, 3u);
    // record 3 waits 2.5 ms and takes 0.1; record 2 itself is done after 3.5 ms
    EXPECT_NEAR(report.response_max_s, 3.5e-3, 1e-12);
    m.queue_capacity = 2;
    report = play(m, pushes);
    EXPECT_EQ(report.failures, 1u);
    EXPECT_EQ(report.messages[0], "push 5: 3 records wait, the queue holds 2");
}

TEST(Timing, TheWireIsSlowerThanItsBytes) {
    auto pushes = every_millisecond(100, 100);
    pushes[10].bytes = 20;  // 20 ms on the wire
    pushes[15].bytes = 10;  // 5 ms later: 15 bytes are still there
    auto m = one_megahertz();
    const auto report = play(m, pushes);
    EXPECT_EQ(report.wire_max, 25u);
    EXPECT_NEAR(report.wire_delay_max_s, 25e-3, 1e-9);
    m.wire_capacity = 24;
    EXPECT_EQ(play(m, pushes).messages.at(0),
              "push 15: 25 bytes wait for the wire, its buffer holds 24");
}

TEST(Timing, AnOverloadedCoreIsSeenAsLateness) {
    auto m = one_megahertz();
    m.push_budget_s = 2e-3;
    m.queue_capacity = 100;
    m.messages_max = 3;
    const auto report = play(m, every_millisecond(100, 1500));
    EXPECT_GT(report.core_load, 1.4);
    EXPECT_NEAR(report.response_max_s, 100 * 1.5e-3 - 99e-3, 1e-9);
    // push i is done at 1.5 (i + 1) ms, stamped at i ms: beyond 10 ms from push 18 on
    EXPECT_EQ(report.failures, 82u);
    ASSERT_EQ(report.messages.size(), 3u);  // all are counted, three are told
    EXPECT_EQ(report.messages[0],
              "push 18: done 10500 us after its record was stamped, budget 10000 us");
}

TEST(Timing, CyclesPerInstructionAreARange) {
    auto m = one_megahertz();
    m.cycles_per_instruction_min = 1.25;
    m.cycles_per_instruction_max = 2;
    auto pushes = every_millisecond(10, 100);
    pushes[4].instructions = 250;  // 500 us at most: just within the budget
    auto report = play(m, pushes);
    EXPECT_TRUE(report.ok()) << report.text();
    EXPECT_NEAR(report.push_min_s, 125e-6, 1e-12);
    EXPECT_NEAR(report.push_max_s, 500e-6, 1e-12);
    EXPECT_NEAR(report.core_load, (9 * 200e-6 + 500e-6) / 9e-3, 1e-9);
    pushes[4].instructions = 251;
    EXPECT_FALSE(play(m, pushes).ok());
}

TEST(Timing, AReplayTellsTheBytesOfEveryPush) {
    Pipeline<Board> pipeline{params()}, other{params()};
    std::vector<Pose> records;
    std::size_t bytes = 0;
    for (std::int64_t n = 0; n < motion::records; ++n) {
        records.push_back(motion::at(n * motion::step_ns));
        bytes += other.push(records.back()).size;
    }
    const auto pushes = replay(pipeline, records, [](std::size_t i) { return 1000 + i; });
    ASSERT_EQ(pushes.size(), records.size());
    std::size_t told = 0;
    for (std::size_t i = 0; i < pushes.size(); ++i) {
        EXPECT_EQ(pushes[i].t_ns, records[i].t_ns);
        EXPECT_EQ(pushes[i].instructions, 1000 + i);
        told += pushes[i].bytes;
    }
    EXPECT_GT(told, 0u);
    EXPECT_EQ(told, bytes);
    // 115200 baud carry this motion with ease; of a byte a second half of it has to wait
    TimingModel board;
    board.wire_capacity = told / 2;
    EXPECT_TRUE(play(board, pushes).ok());
    board.wire_bytes_per_s = 1;
    EXPECT_FALSE(play(board, pushes).ok());
}

TEST(Timing, CountsAreReadAsTheyWereWritten) {
    const std::string path = testing::TempDir() + "timing.counts";
    std::ofstream{path, std::ios::binary} << std::string{"\x05\0\0\0\x01\x02\x03\xF4", 8};
    EXPECT_EQ(read_counts(path), (std::vector<std::uint32_t>{5, 0xF4030201}));
    std::ofstream{path, std::ios::binary} << "odd";
    EXPECT_THROW(read_counts(path), BadData);
}

TEST(Timing, JitterIsSeededAndBounded) {
    auto m = one_megahertz();
    m.interrupt_jitter_s = 300e-6;
    const auto pushes = every_millisecond(1000, 100);
    const auto a = play(m, pushes), b = play(m, pushes);
    EXPECT_EQ(a.response_max_s, b.response_max_s);
    EXPECT_GT(a.response_max_s, 350e-6);
    EXPECT_LE(a.response_max_s, 400e-6);
}

TEST(Timing, BoundsAreReadByCoreAndStage) {
    const std::string path = testing::TempDir() + "timing_bounds.md";
    std::ofstream{path}
        << "# BOUNDS\n| stage | what |\n|---|---|\n\n## Cortex-M0\n"
           "| quat | 9 | 9 | 9 | 9 | 9 | 9 | 9 | 9 | 9 | 9 | x |\n\n## Cortex-M4F\n"
           "| stage | flash | RAM |\n|---|---:|\n"
           "| quat | 2,704 | 72 | 224 | 256 | 343 | 495 | 595 | 605 | 615 | 6 | x |\n";
    const auto bounds = read_bounds(path, "Cortex-M4F");
    ASSERT_EQ(bounds.size(), 1u);
    EXPECT_EQ(bounds.at("quat").flash, 2704u);
    EXPECT_EQ(bounds.at("quat").bound, 605u);
    EXPECT_EQ(bounds.at("quat").any_operands, 615u);
    EXPECT_EQ(bounds.at("quat").flush_worst, 6u);
    EXPECT_THROW(read_bounds(path, "Cortex-M7"), BadData);
}

TEST(Timing, TheCommittedBoundsAreRead) {
    for (const char* core : {"Cortex-M0", "Cortex-M3", "Cortex-M4F", "Cortex-M7", "Cortex-M33"}) {
        const auto stage = read_bounds("BOUNDS.md", core).at("pipeline_32");
        EXPECT_GT(stage.mean, stage.min) << core;
        EXPECT_GT(stage.worst_found, stage.mean) << core;
        EXPECT_GE(stage.bound, stage.worst_found) << core;
        EXPECT_GE(stage.any_operands, stage.bound) << core;
    }
}

}  // namespace
}  // namespace fairlead::sim
