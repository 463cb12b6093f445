// The watch of a calibration: progress rises with what the user does, 100 percent comes with a
// result alone, and what it finds is what was simulated.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "examples/gateway/calibration_watch.hpp"
#include "host_sim/generate/random.hpp"

using namespace fairlead;
using namespace fairlead::gateway;
namespace bit = calibration_bit;

namespace {

const Vec3 gyro_offset{0.02f, -0.01f, 0.03f}, accel_offset{0.2f, -0.1f, 0.15f};
const Vec3 hard_iron{30, -20, 12};

/// A board in a field of 48 uT, read at 200 Hz.
class Bench {
  public:
    CalibrationWatch watch;
    std::int64_t t_ns{7'000'000'000};

    void rest(const Quat& q, double seconds) { run(q, {}, seconds); }
    /// Turns from q by a rate, in the body.
    void turn(Quat& q, const Vec3& rate_rad_s, double seconds) {
        run(q, rate_rad_s, seconds);
        q = q_;
    }
    void push(Sample s) {
        watch.push(s);
        t_ns += step_ns;
    }
    Sample reading(const Quat& q, const Vec3& rate_rad_s) {
        Sample s;
        s.t_ns = t_ns;
        const Quat to_body = conj(q);
        s.gyro_rad_s = rate_rad_s + gyro_offset + noise(0.002);
        s.accel_m_s2 = rotate(to_body, Vec3{0, 0, 9.80665f}) + accel_offset + noise(0.02);
        s.mag_uT = rotate(to_body, Vec3{0, 20, -43.6f}) + hard_iron + noise(0.3);
        s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
        return s;
    }

  private:
    static constexpr std::int64_t step_ns = 5'000'000;
    void run(const Quat& from, const Vec3& rate_rad_s, double seconds) {
        q_ = from;
        for (double t = 0; t < seconds; t += 5e-3) {
            push(reading(q_, rate_rad_s));
            q_ = normalised(q_ * from_rotation_vector(5e-3f * rate_rad_s));
        }
    }
    Vec3 noise(double sigma) {
        const auto one = [&] { return static_cast<float>(sigma * random_.normal()); };
        return {one(), one(), one()};
    }
    sim::Random random_{3};
    Quat q_{};
};

void expect_near(const Vec3& a, const Vec3& b, float bound) { EXPECT_LT(norm(a - b), bound); }

constexpr float quarter = pi_v<float> / 2;

}  // namespace

TEST(CalibrationWatch, FollowsAUserToTheEnd) {
    Bench bench;
    const CalibrationState& s = bench.watch.state();
    Quat q{};
    bench.rest(q, 1);
    EXPECT_EQ(s.sensors, bit::gyro | bit::accel | bit::mag);
    EXPECT_GT(s.gyro_percent, 25);
    EXPECT_LT(s.gyro_percent, 100);
    EXPECT_EQ(s.done, 0);
    bench.rest(q, 2);
    EXPECT_EQ(s.gyro_percent, 100);
    EXPECT_EQ(s.done, bit::gyro);
    EXPECT_EQ(s.accel_faces, 1u << 4) << "+z is up";
    EXPECT_LT(s.mag_percent, 50) << "one direction";
    for (const Vec3& rate : {Vec3{quarter, 0, 0}, Vec3{quarter, 0, 0}, Vec3{quarter, 0, 0},
                             Vec3{0, 0, quarter}, Vec3{0, 0, 2 * quarter}}) {
        EXPECT_FALSE(s.done & bit::accel);
        bench.turn(q, rate, 1);
        bench.rest(q, 2);
    }
    EXPECT_EQ(s.accel_faces, 0x3F);
    EXPECT_EQ(s.done & bit::accel, bit::accel);
    std::uint16_t before = s.mag_percent;
    for (int i = 0; i < 16; ++i) {
        bench.turn(q, i % 2 ? Vec3{1.3f, 0.2f, 0.4f} : Vec3{0.3f, 1.1f, -0.5f}, 2);
        EXPECT_GE(s.mag_percent, before);
        before = s.mag_percent;
    }
    EXPECT_EQ(s.mag_percent, 100);
    EXPECT_EQ(s.done, bit::gyro | bit::accel | bit::mag);
    expect_near(s.gyro_offset_rad_s, gyro_offset, 5e-4f);
    expect_near(s.accel.offset, accel_offset, 0.02f);
    expect_near(s.mag.offset, hard_iron, 1.0f);
}

TEST(CalibrationWatch, ABoardThatMovesGetsNowhereWithItsGyroscopeAndFaces) {
    Bench bench;
    Quat q{};
    for (int i = 0; i < 20; ++i) bench.turn(q, {i % 2 ? 0.5f : -0.5f, 0.1f, 0}, 1);
    EXPECT_EQ(bench.watch.state().done & (bit::gyro | bit::accel), 0);
    EXPECT_EQ(bench.watch.state().accel_faces, 0);
    EXPECT_LT(bench.watch.state().gyro_percent, 100);
}

TEST(CalibrationWatch, ABoardThatLiesStillIsNeverATurnedOne) {
    Bench bench;
    bench.rest(Quat{}, 60);
    EXPECT_LT(bench.watch.state().mag_percent, 100);
    EXPECT_EQ(bench.watch.state().done, bit::gyro);
}

TEST(CalibrationWatch, ReadingsThatAreNoNumbersAndClocksThatBeginAnewDoNoHarm) {
    Bench bench;
    Quat q{};
    for (int i = 0; i < 2000; ++i) {
        Sample s = bench.reading(q, {});
        const float wrong = i % 3 ? std::numeric_limits<float>::quiet_NaN()
                                  : std::numeric_limits<float>::infinity();
        if (i % 2) s.gyro_rad_s.x = s.accel_m_s2.y = s.mag_uT.z = wrong;
        if (i % 500 == 0) bench.t_ns = i % 1000 ? 0 : 9'000'000'000'000'000;
        bench.push(s);
    }
    EXPECT_EQ(bench.watch.state().done, 0);
    bench.rest(q, 3);
    EXPECT_EQ(bench.watch.state().done, bit::gyro);
    expect_near(bench.watch.state().gyro_offset_rad_s, gyro_offset, 5e-4f);
}

TEST(CalibrationWatch, WithoutReadingsItSaysSo) {
    CalibrationWatch watch;
    Sample s;
    for (int i = 0; i < 100; ++i, s.t_ns += 10'000'000) watch.push(s);
    EXPECT_EQ(watch.state().sensors, 0);
}
