// Orientation on recordings, held to its bounds; and the tools that measure it, on known answers.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "fairlead/math/quat.hpp"
#include "host_sim/generate/random.hpp"
#include "host_sim/replay/attitude_run.hpp"
#include "host_sim/report/allan.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::sim;

std::vector<Recording> recordings() {
    std::vector<Recording> out;
    const std::string folder = "../shared/recordings";
    if (std::filesystem::is_directory(folder))
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ".imu")
                out.push_back(read_recording(entry.path().string()));
    return out;
}

double mean_total(const std::vector<Recording>& all, const Conditions& conditions) {
    double sum = 0;
    for (const Recording& r : all)
        sum += score(r, run_attitude(r, AttitudeMode::imu_mag, {}, conditions)).total_deg;
    return sum / static_cast<double>(all.size());
}

TEST(AttitudeOnRecordings, KeepsItsBounds) {
    const auto all = recordings();
    if (all.empty()) GTEST_SKIP() << "no recordings in ../shared/recordings";
    EXPECT_LE(mean_total(all, {}), 1.80);
    double inclination = 0;
    for (const Recording& r : all)
        inclination += score(r, run_attitude(r, AttitudeMode::imu)).inclination_deg;
    EXPECT_LE(inclination / static_cast<double>(all.size()), 0.57);
    Conditions lossy, fast, sparse;
    lossy.drop = {0.01, 5, 1};
    EXPECT_LE(mean_total(all, lossy), 1.85);
    fast.rate_error = 0.01;
    EXPECT_LE(mean_total(all, fast), 1.90);
    sparse.every = 3;
    EXPECT_LE(mean_total(all, sparse), 1.95);
    double moving = 0;
    for (const Recording& r : all) {
        Conditions late;
        late.start_s = movement_start_s(r);
        const auto estimate = run_attitude(r, AttitudeMode::imu_mag, {}, late);
        moving += score(r, estimate, late.start_s).total_deg;
    }
    EXPECT_LE(moving / static_cast<double>(all.size()), 2.80);
}

Recording turned_recording() {
    Recording r;
    r.name = "turned";
    for (int i = 0; i < 10; ++i) {
        Sample s;
        s.t_ns = i * 10'000'000;
        Pose truth;
        truth.t_ns = s.t_ns;
        truth.q_wb = {0.5f, 0.5f, -0.5f, 0.5f};
        truth.flags = i < 8 ? flag::orientation_valid : 0u;
        r.samples.push_back(s);
        r.truth.push_back(truth);
        r.moving.push_back(i >= 2 ? 1 : 0);
    }
    return r;
}

TEST(Score, TellsHeadingFromInclination) {
    const Recording r = turned_recording();
    std::vector<Pose> turned = r.truth, tilted = r.truth;
    const Quat about_up = from_rotation_vector(Vec3{0, 0, 0.1f});
    const Quat about_east = from_rotation_vector(Vec3{0.1f, 0, 0});
    for (std::size_t i = 0; i < turned.size(); ++i) {
        turned[i].q_wb = about_up * turned[i].q_wb;
        tilted[i].q_wb = about_east * tilted[i].q_wb;
    }
    const double angle = 0.1 * 57.29577951308232;
    const Score a = score(r, turned), b = score(r, tilted);
    EXPECT_EQ(a.count, 6u);  // moving, and the reference valid
    EXPECT_NEAR(a.heading_deg, angle, 1e-4);
    EXPECT_NEAR(a.inclination_deg, 0, 0.05);
    EXPECT_NEAR(b.inclination_deg, angle, 1e-4);
    EXPECT_NEAR(b.heading_deg, 0, 1e-4);
    EXPECT_NEAR(b.total_deg, angle, 1e-4);
}

TEST(Score, ReadsBackWhatItWrote) {
    const Recording r = turned_recording();
    const auto again = parse_estimate_csv(to_estimate_csv(r.truth), "x.csv");
    ASSERT_EQ(again.size(), r.truth.size());
    EXPECT_EQ(again[3].t_ns, r.truth[3].t_ns);
    EXPECT_EQ(again[3].q_wb.y, r.truth[3].q_wb.y);
    EXPECT_THROW(parse_estimate_csv("t_ns,qw,qx,qy,qz\n1,2,3\n", "x.csv"), BadData);
}

TEST(Allan, WhiteNoiseAndWalkAreTold) {
    Random random{1};
    constexpr double period_s = 0.01, sigma = 0.2, step = 0.002;
    std::vector<double> white, walking;
    double walk = 0;
    for (int i = 0; i < 60000; ++i) {
        white.push_back(sigma * random.normal());
        walk += step * random.normal();
        walking.push_back(walk);
    }
    const AllanFigures w = allan_figures(allan_deviation(white, period_s));
    EXPECT_NEAR(w.density, sigma * std::sqrt(period_s), 0.05 * sigma * std::sqrt(period_s));
    const AllanFigures k = allan_figures(allan_deviation(walking, period_s));
    EXPECT_NEAR(k.walk, step / std::sqrt(period_s), 0.5 * step / std::sqrt(period_s));
}

TEST(Allan, FindsTheLongestRest) {
    std::vector<double> speed(1000, 0.001);
    for (std::size_t i = 200; i < 300; ++i) speed[i] = std::sin(static_cast<double>(i));
    const Stretch rest = longest_rest(speed, 0.01, 0.02);
    EXPECT_EQ(rest.first, 300u);
    EXPECT_EQ(rest.last, 1000u);
}

}  // namespace
