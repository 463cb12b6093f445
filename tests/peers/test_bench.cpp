// The bench's own parts: it reads what fairlead-sim says, checks what it decodes, keeps results.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "host_sim/study/bench_peers/cache.hpp"
#include "host_sim/study/bench_peers/ours.hpp"
#include "host_sim/study/bench_peers/report.hpp"

namespace {

using namespace fairlead::sim;

class PeerBench : public testing::Test {
  protected:
    PeerBench() { std::filesystem::create_directories(folder_); }
    ~PeerBench() override { std::filesystem::remove_all(folder_); }

    static Cell cell() {
        Cell cell;
        cell.track.name = "x";
        cell.track.channel = Channel::position;
        cell.track.period_s = 0.01;
        cell.tolerance = 0.001;
        for (int i = 0; i < 4; ++i) {
            cell.track.t.push_back(0.01 * i);
            for (const double x : {0.1 * i, 1.0, -2.0}) cell.track.x.push_back(x);
        }
        return cell;
    }
    /// A stand-in for fairlead-sim that says `json` and decodes to `csv`.
    Program stand_in(const std::string& json, const std::string& csv) const {
        write_bytes(folder_ + "/csv", csv);
        const std::string path = folder_ + "/program";
        write_bytes(path, "#!/bin/sh\ncase \"$1\" in reduce) echo '" + json +
                              "';; decode) for a; do out=$a; done; cp '" + folder_ +
                              "/csv' \"$out\";; esac\n");
        std::filesystem::permissions(path, std::filesystem::perms::owner_all);
        return {path, folder_, ""};
    }

    const std::string folder_ = testing::TempDir() + "fairlead_peers";
};

constexpr const char* json =
    R"({"samples": 4, "bytes": 321, "position": {"control_points": 7, "knots": 3, "bytes": 300,)"
    R"( "max_error_m": 0.0005, "max_delay_samples": 59, "mean_delay_samples": 21.5}})";

TEST_F(PeerBench, ReadsTheFiguresAndChecksEverySample) {
    const std::string csv =
        "t_ns,px,py,pz,qw,qx,qy,qz\n"
        "0,0,1,-2,,,,\n10000000,0.1,1.0005,-2,,,,\n20000000,,,,,,,\n30000000,0.3,1,-2.0007,,,,\n";
    const auto ours = stand_in(json, csv).reduce(cell(), 60, settings[medium]);
    ASSERT_TRUE(ours);
    EXPECT_EQ(ours->control_points, 7u);
    EXPECT_EQ(ours->bytes, 321u) << "all bytes of the stream count";
    EXPECT_EQ(ours->samples_missing, 1u);
    EXPECT_NEAR(ours->error, 0.7, 1e-9);
    EXPECT_EQ(ours->max_delay, 59);
    EXPECT_EQ(ours->mean_delay, 21.5);
    EXPECT_NEAR(ours->speed, 10, 1e-9);  // of the one step that is decoded
    EXPECT_NEAR(ours->speed_error, std::hypot(10, 0.05) - 10, 1e-9);
}

TEST_F(PeerBench, ASampleThatIsNotDecodedIsMissing) {
    const auto ours = stand_in(json, "t_ns,px,py,pz,qw,qx,qy,qz\n0,0,1,-2,,,,\n")
                          .reduce(cell(), 60, settings[medium]);
    ASSERT_TRUE(ours);
    EXPECT_EQ(ours->samples_missing, 3u);
}

TEST_F(PeerBench, SkipsWithoutTheProgram) {
    EXPECT_FALSE((Program{folder_ + "/absent", folder_, ""}.reduce(cell(), 60, settings[medium])));
}

TEST_F(PeerBench, KeepsResultsByDataAndTolerance) {
    const std::string path = folder_ + "/cache";
    int made = 0;
    const auto get = [&](Cache& cache, const Track& track, double tolerance) {
        return cache.get(cache_key("method", hash(track), tolerance), [&] {
            ++made;
            return std::to_string(made);
        });
    };
    Track other = cell().track;
    other.x[5] = std::nextafter(other.x[5], 9);
    {
        Cache cache{path};
        EXPECT_EQ(get(cache, cell().track, 0.001), "1");
        EXPECT_EQ(get(cache, cell().track, 0.001), "1");
    }
    Cache cache{path};
    EXPECT_EQ(get(cache, cell().track, 0.001), "1");
    EXPECT_EQ(get(cache, cell().track, 0.002), "2");
    EXPECT_EQ(get(cache, other, 0.001), "3");
}

TEST_F(PeerBench, TablesShowGeometricMeansAndTheWorst) {
    std::vector<CellResult> results(2);
    for (std::size_t i = 0; i < 2; ++i) {
        results[i].name = "r" + std::to_string(i);
        results[i].seconds = 1;
        results[i].knots = {{"libsisl", 100, 0.9}, {"other", i == 0 ? 50u : 200u, 1.2}};
        results[i].bytes[0] = {{"a", "s", 80, true}, {"delta + Rice", "s", 160, true}};
        results[i].ours[medium][0] =
            Ours{i == 0 ? 40u : 90u, i == 0 ? 20u : 80u, 0.99, 0, 60, 20, 0.5, 0.001};
    }
    const std::string tables = to_markdown(results);
    EXPECT_NE(tables.find("| **fairlead, medium, delay 60** | 0.60 (0.90) |"), std::string::npos)
        << tables;
    EXPECT_NE(tables.find("| other, tolerance broken on 2 of 2 | 1.00 (2.00) |"),
              std::string::npos);
    EXPECT_NE(tables.find("| best rival, medium, delay 60 | 0.50 (1.00) |"), std::string::npos);
    EXPECT_NE(tables.find("| delta + Rice, medium, delay 60 | 0.25 (0.50) |"), std::string::npos);
    EXPECT_NE(to_json(results).find("\"fairlead, medium, delay 60\": {\"control_points\": 40"),
              std::string::npos);
}

TEST_F(PeerBench, OnlyTheTablesOfThePageChange) {
    const std::string page = "a\n<!-- tables: make bench-peers -->\nold\n<!-- end of tables -->\nb";
    const std::string once = with_tables(page, "new\n");
    EXPECT_EQ(once, "a\n<!-- tables: make bench-peers -->\n\nnew\n\n<!-- end of tables -->\nb");
    EXPECT_EQ(with_tables(once, "new\n"), once);
    EXPECT_THROW(with_tables("nothing", "new"), BadData);
}

}  // namespace
