// The fits recover what was simulated, within stated bounds, and refuse what they cannot know.
#include "fairlead/sense/calibrate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fairlead/sense/calibrate_accel.hpp"
#include "fairlead/sense/calibrate_gyro.hpp"
#include "fairlead/sense/calibrate_mag.hpp"
#include "host_sim/generate/random.hpp"

namespace {

using namespace fairlead;
using sim::Random;

Vec3 noise(Random& random, double sigma) {
    return {static_cast<float>(sigma * random.normal()),
            static_cast<float>(sigma * random.normal()),
            static_cast<float>(sigma * random.normal())};
}
Vec3 direction(Random& random) {
    const Vec3 v = noise(random, 1);
    return (1 / norm(v)) * v;
}
void expect_near(const Vec3& a, const Vec3& b, float bound) { EXPECT_LT(norm(a - b), bound); }

TEST(Moments, MeanAndLargestDeviationOfThreeAxes) {
    // y spreads twice as far as x and three times as far as z, whatever axis comes first
    for (int turn = 0; turn < 3; ++turn) {
        const auto turned = [turn](const Vec3& v) {
            return turn == 0 ? v : turn == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y};
        };
        Moments moments;
        EXPECT_EQ(moments.deviation(), 0.0f);
        moments.push(turned({5, 6, 7}));
        EXPECT_EQ(moments.deviation(), 0.0f);
        moments.reset();
        for (const float k : {-3.0f, -1.0f, 1.0f, 3.0f})
            moments.push(turned({1 + 3 * k, -2 + 6 * k, 10 - 2 * k}));
        EXPECT_EQ(moments.count(), 4u);
        expect_near(moments.mean(), turned({1, -2, 10}), 1e-5f);
        EXPECT_NEAR(moments.deviation(), 6 * std::sqrt(20.0 / 3), 1e-4);
    }
}

TEST(Calibration, DefaultChangesNothing) {
    Sample s;
    s.t_ns = 7;
    s.gyro_rad_s = {1, 2, 3};
    s.accel_m_s2 = {4, 5, 6};
    s.mag_uT = {7, 8, 9};
    s.flags = flag::clipped;
    const Sample out = Calibrator{}(s);
    EXPECT_EQ(out.t_ns, 7);
    EXPECT_EQ(out.flags, s.flags);
    expect_near(out.gyro_rad_s, s.gyro_rad_s, 1e-6f);
    expect_near(out.mag_uT, s.mag_uT, 1e-6f);
}

TEST(Calibration, CorrectsThenMounts) {
    Calibration c;
    c.gyro.offset = {0.1f, 0, 0};
    c.gyro_offset_per_K = {0.01f, 0, 0};
    c.temperature_C = 20;
    c.q_bs = from_rotation_vector(Vec3{0, 0, pi_v<float> / 2});
    Sample s;
    s.gyro_rad_s = {1.15f, 0, 0};
    const Sample out = Calibrator{c}(s, 25);
    expect_near(out.gyro_rad_s, {0, 1, 0}, 1e-6f);
}

TEST(Calibration, SurvivesStorageAndRefusesDamage) {
    Calibration c;
    c.mag.offset = {1, -2, 3};
    auto saved = save(c);
    ASSERT_TRUE(restore(saved));
    EXPECT_EQ((*restore(saved)).mag.offset.y, -2);
    saved.value.mag.offset.y = -2.0001f;
    EXPECT_EQ(restore(saved).status(), Status::bad_data);
}

TEST(GyroBiasFit, FindsBiasAndNoise) {
    Random random{1};
    GyroBiasFit fit;
    const Vec3 bias{0.01f, -0.02f, 0.005f};
    constexpr double sigma = 0.003, dt = 0.005;
    for (int i = 0; i < 300; ++i) fit.push(bias + noise(random, sigma), static_cast<float>(dt));
    EXPECT_EQ(fit.result().status(), Status::not_enough_data);
    for (int i = 0; i < 1700; ++i) fit.push(bias + noise(random, sigma), static_cast<float>(dt));
    const auto r = fit.result();
    ASSERT_TRUE(r);
    expect_near(r->bias_rad_s, bias, 5 * r->uncertainty);
    EXPECT_NEAR(r->uncertainty, sigma / std::sqrt(2000), 1e-5);
    EXPECT_NEAR(r->noise_rad_s, sigma, 0.1 * sigma);
    EXPECT_NEAR(r->random_walk, sigma * std::sqrt(dt), 0.1 * sigma * std::sqrt(dt));
}

TEST(GyroBiasFit, RefusesMotion) {
    GyroBiasFit fit;
    for (int i = 0; i < 1000; ++i)
        fit.push({0.2f * std::sin(0.01f * static_cast<float>(i)), 0, 0}, 0.005f);
    EXPECT_EQ(fit.result().status(), Status::bad_data);
}

TEST(GyroTemperatureFit, FindsTheLine) {
    Random random{2};
    GyroTemperatureFit fit;
    const Vec3 at25{0.01f, -0.02f, 0.005f}, per_K{2e-4f, -1e-4f, 5e-5f};
    fit.push(at25, 25);
    fit.push(at25 + 2.0f * per_K, 27);
    EXPECT_EQ(fit.result().status(), Status::not_enough_data);
    for (int i = 0; i < 30; ++i) {
        const float t = 15 + static_cast<float>(i);
        fit.push(at25 + (t - 25) * per_K + noise(random, 2e-5), t);
    }
    const auto r = fit.result();
    ASSERT_TRUE(r);
    expect_near(r->per_K, per_K, 4e-6f);
    expect_near(r->bias_rad_s + (25 - r->temperature_C) * r->per_K, at25, 3e-5f);
    EXPECT_LT(r->residual_rad_s, 6e-5f);
}

TEST(GyroBiasFit, WantsTwoSecondsAndTwentyReadings) {
    const auto status = [](int readings, float dt_s) {
        GyroBiasFit fit;
        for (int i = 0; i < readings; ++i) fit.push({0.01f, 0, 0}, dt_s);
        return fit.result().status();
    };
    EXPECT_EQ(status(32, 1.0f / 16), Status::not_enough_data);
    EXPECT_EQ(status(33, 1.0f / 16), Status::ok) << "two seconds";
    EXPECT_EQ(status(19, 1), Status::not_enough_data);
    EXPECT_EQ(status(20, 1), Status::ok);
}

TEST(GyroTemperatureFit, ThreeRestsWithoutNoiseGiveTheirLine) {
    const Vec3 at25{0.01f, -0.02f, 0.005f}, per_K{2e-3f, -1e-3f, 5e-4f};
    for (const float step_K : {5.0f, -5.0f}) {  // getting warmer, getting colder
        GyroTemperatureFit fit;
        for (int i = -1; i < 2; ++i)
            fit.push(at25 + static_cast<float>(i) * step_K * per_K,
                     25 + static_cast<float>(i) * step_K);
        const auto r = fit.result();
        ASSERT_TRUE(r) << step_K;
        EXPECT_NEAR(r->temperature_C, 25, 1e-4f);
        expect_near(r->bias_rad_s, at25, 1e-7f);
        expect_near(r->per_K, per_K, 1e-7f);
        EXPECT_LT(r->residual_rad_s, 1e-5f);
    }
}

TEST(GyroTemperatureFit, WantsRestsThatDiffer) {
    GyroTemperatureFit fit;
    for (int i = 0; i < 10; ++i) fit.push({0.01f, 0, 0}, 20 + 0.4f * static_cast<float>(i));
    EXPECT_EQ(fit.result().status(), Status::not_enough_data) << "3.6 K are no span";
    fit.push({0.02f, 0, 0}, 26);
    EXPECT_TRUE(fit.result());
    GyroTemperatureFit least;  // the span that is asked for, and no more
    for (const float t : {20.0f, 22.0f, 20 + GyroTemperatureFit::span_K_min})
        least.push({0.01f, 0, 0}, t);
    EXPECT_TRUE(least.result());
    GyroTemperatureFit two;
    two.push({0.01f, 0, 0}, 10);
    two.push({0.01f, 0, 0}, 30);
    EXPECT_EQ(two.result().status(), Status::not_enough_data);
}

TEST(GyroTurnFit, FindsScaleFromAKnownTurn) {
    GyroTurnFit fit;
    for (int i = 0; i < 1000; ++i) fit.push({0.001f, 0, 0.97f * 2 * pi_v<float> / 5}, 0.005f);
    const auto r = fit.result(2, 2 * pi_v<float>);
    ASSERT_TRUE(r);
    EXPECT_NEAR(r->factor, 1 / 0.97, 1e-3);
    EXPECT_EQ(fit.result(0, 1).status(), Status::not_enough_data);
    GyroTurnFit crooked;
    for (int i = 0; i < 500; ++i) crooked.push({0.6f, 0, 0.9f}, 0.005f);
    EXPECT_EQ(crooked.result(2, 2.25f).status(), Status::bad_data);
    EXPECT_EQ(fit.result(2, 3 * pi_v<float>).status(), Status::bad_data) << "another angle";
}

TEST(AccelFit, RecoversOffsetScaleAndMisalignment) {
    Random random{3};
    const Mat3 a{{1.02f, 0.01f, -0.005f}, {0.004f, 0.98f, 0.012f}, {0.0f, -0.01f, 1.01f}};
    const Vec3 offset{0.3f, -0.2f, 0.15f};
    AccelFit fit;
    for (int face = 0; face < 6; ++face) {
        EXPECT_EQ(fit.result().status(), Status::not_enough_data);
        const float g = face % 2 == 0 ? 9.80665f : -9.80665f;
        const Vec3 truth{face / 2 == 0 ? g : 0, face / 2 == 1 ? g : 0, face / 2 == 2 ? g : 0};
        for (int i = 0; i < 200; ++i) fit.push(a * truth + offset + noise(random, 0.02));
    }
    const auto r = fit.result();
    ASSERT_TRUE(r);
    expect_near(r->correction.offset, offset, 0.005f);
    EXPECT_LT(r->residual_m_s2, 0.005f);
    for (int i = 0; i < 100; ++i) {  // and in every other direction
        const Vec3 truth = 9.80665f * direction(random);
        expect_near(r->correction(a * truth + offset), truth, 0.01f);
    }
}

/// Six faces as a sensor shows them that multiplies by `scale`; the last one leans by `lean_rad`.
Result<AccelCalibration> six_faces(float scale, float lean_rad) {
    AccelFit fit;
    for (int face = 0; face < 6; ++face) {
        const float g = scale * (face % 2 == 0 ? 9.80665f : -9.80665f);
        Vec3 reading{face / 2 == 0 ? g : 0, face / 2 == 1 ? g : 0, face / 2 == 2 ? g : 0};
        if (face == 5) reading = rotate(from_rotation_vector(Vec3{lean_rad, 0, 0}), reading);
        for (int i = 0; i < 60; ++i) fit.push(reading);
    }
    return fit.result();
}

TEST(AccelFit, RefusesCrookedFacesAndImpossibleScales) {
    EXPECT_TRUE(six_faces(1, 0));
    EXPECT_TRUE(six_faces(1, 0.05f));
    EXPECT_EQ(six_faces(1, 0.25f).status(), Status::bad_data) << "opposite faces contradict";
    EXPECT_TRUE(six_faces(1.05f, 0));
    EXPECT_EQ(six_faces(1.2f, 0).status(), Status::bad_data) << "the range is not what was said";
}

TEST(AccelFit, RefusesWhatIsNoFace) {
    AccelFit fit;
    EXPECT_FALSE(fit.push({7, 7, 0}));
    EXPECT_FALSE(fit.push({20, 0, 0}));
    Random random{4};
    for (int face = 0; face < 6; ++face) {
        const float g = face % 2 == 0 ? 9.8f : -9.8f;
        const Vec3 truth{face / 2 == 0 ? g : 0, face / 2 == 1 ? g : 0, face / 2 == 2 ? g : 0};
        for (int i = 0; i < 100; ++i) fit.push(truth + noise(random, 0.6));
    }
    EXPECT_EQ(fit.result().status(), Status::bad_data) << "it was shaken";
}

struct Magnet {
    Mat3 soft{{1.15f, 0.06f, -0.03f}, {0.06f, 0.9f, 0.04f}, {-0.03f, 0.04f, 1.0f}};
    Vec3 hard{35, -60, 12};
    float field_uT{48};
};

TEST(MagFit, RecoversHardAndSoftIron) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        Random random{seed};
        const Magnet m;
        MagFit fit;
        for (int i = 0; i < 600; ++i)
            fit.push(m.soft * (m.field_uT * direction(random)) + m.hard + noise(random, 0.4));
        const auto r = fit.result();
        ASSERT_TRUE(r) << "seed " << seed;
        expect_near(r->correction.offset, m.hard, 0.3f);
        EXPECT_LT(r->residual, 0.015f);
        EXPECT_LT(r->offset_error_uT, 0.2f);
        for (int i = 0; i < 50; ++i) {  // the corrected direction is the true one
            const Vec3 d = direction(random);
            const Vec3 c = r->correction(m.soft * (m.field_uT * d) + m.hard);
            EXPECT_LT(norm((1 / norm(c)) * c - d), 0.02f) << "seed " << seed;
        }
    }
}

TEST(Fits, AReadingThatIsNoNumberCountsForNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    Random random{11};
    const Magnet m;
    MagFit mag;
    GyroBiasFit gyro;
    for (int i = 0; i < 600; ++i) {
        mag.push(m.soft * (m.field_uT * direction(random)) + m.hard);
        gyro.push({0.01f, 0, 0}, 0.01f);
        if (i % 100 != 50) continue;
        mag.push({nan, 1, 2});
        gyro.push({0, nan, 0}, 0.01f);
    }
    EXPECT_EQ(mag.count(), 600u);
    ASSERT_TRUE(mag.result());
    expect_near(mag.result()->correction.offset, m.hard, 0.01f);
    ASSERT_TRUE(gyro.result());
    expect_near(gyro.result()->bias_rad_s, {0.01f, 0, 0}, 1e-6f);
    AccelFit accel;
    EXPECT_FALSE(accel.push({nan, 0, 0}));
    GyroTurnFit turn;
    turn.push({1, nan, 0}, 2);
    EXPECT_FALSE(turn.result(0, 2)) << "a turn of which a part is missing";
}

TEST(MagFit, RefusesAnEllipsoidTooLong) {
    // along axes of the sensor, and between two of them
    for (const Vec3& axis :
         {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0, 0.6f, 0.8f},
          Vec3{0.70710678f, 0, 0.70710678f}, Vec3{0.70710678f, 0.70710678f, 0}}) {
        const auto stretched = [&axis](float by) {
            Random random{7};
            MagFit fit;
            for (int i = 0; i < 300; ++i) {
                const Vec3 d = 50.0f * direction(random);
                fit.push(d + ((by - 1) * dot(d, axis)) * axis);
            }
            return fit.result();
        };
        EXPECT_TRUE(stretched(1.5f));
        EXPECT_TRUE(stretched(3.8f));
        EXPECT_EQ(stretched(4.2f).status(), Status::bad_data);
        EXPECT_TRUE(stretched(1 / 3.8f));
        EXPECT_EQ(stretched(1 / 4.2f).status(), Status::bad_data);
    }
}

TEST(MagFit, RefusesPoorCoverage) {
    Random random{6};
    const Magnet m;
    MagFit few, flat, cap;
    for (int i = 0; i < 500; ++i) {
        Vec3 d = direction(random);
        if (i < 50) few.push(m.field_uT * d + m.hard);
        cap.push(m.field_uT * ((1 / norm(d + Vec3{3, 0, 0})) * (d + Vec3{3, 0, 0})) + m.hard +
                 noise(random, 0.4));
        d.z = 0;
        flat.push((m.field_uT / norm(d)) * d + m.hard + noise(random, 0.4));
    }
    EXPECT_EQ(few.result().status(), Status::not_enough_data);
    EXPECT_EQ(flat.result().status(), Status::not_enough_data);
    EXPECT_EQ(cap.result().status(), Status::not_enough_data);
}

// Who has only begun to turn the board is told to go on, not that the readings are bad; and what is
// accepted in the end keeps its word.
TEST(MagFit, AsksForMoreDirectionsUntilTheCentreIsKnown) {
    for (const double noise_uT : {0.1, 0.4, 1.0}) {
        bool accepted = false;
        for (double lowest = 0.95; lowest > -1; lowest -= 0.15) {  // a growing cap of the sphere
            Random random{static_cast<std::uint64_t>(100 * (lowest + 1))};
            const Magnet m;
            MagFit fit;
            for (int i = 0; i < 600; ++i) {
                Vec3 d = direction(random);
                while (static_cast<double>(d.z) < lowest) d = direction(random);
                fit.push(m.field_uT * d + m.hard + noise(random, noise_uT));
            }
            const auto r = fit.result();
            SCOPED_TRACE(testing::Message() << "noise " << noise_uT << ", cap above " << lowest);
            if (!r) {
                EXPECT_EQ(r.status(), Status::not_enough_data);
                EXPECT_FALSE(accepted) << "more directions are not less";
                continue;
            }
            accepted = true;
            EXPECT_LT(norm(r->correction.offset - m.hard), 4 * r->offset_error_uT);
            EXPECT_LE(r->offset_error_uT, 1.0f);
        }
        EXPECT_TRUE(accepted);
    }
}

TEST(MagFit, RefusesWhatIsNoEllipsoid) {
    Random random{7};
    MagFit fit;
    for (int i = 0; i < 500; ++i)
        fit.push(20.0f * (1 + std::abs(noise(random, 1).x)) * direction(random));
    EXPECT_EQ(fit.result().status(), Status::bad_data);
}

}  // namespace
