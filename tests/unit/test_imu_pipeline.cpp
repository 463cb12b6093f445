// An inertial sensor's samples in, frames out: the same poses as the stages give one by one, and
// bytes that a decoder understands.
#include "fairlead/imu_pipeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "fairlead/wire/decoder.hpp"

namespace {

using namespace fairlead;

/// A board on a turntable that stands still for 5 s and then swings.
Sample turntable(int i) {
    constexpr double period_s = 0.004;
    const double t = std::max(0.0, i * period_s - 5);
    const double angle = 2 - 2 * std::cos(t), rate = 2 * std::sin(t);
    Sample s;
    s.t_ns = i * std::int64_t{4'000'000};
    s.gyro_rad_s = {0, 0, static_cast<float>(rate)};
    s.accel_m_s2 = {0, 0, 9.81f};
    s.mag_uT = {static_cast<float>(18 * std::sin(angle)), static_cast<float>(18 * std::cos(angle)),
                -42};
    s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    return s;
}

TEST(ImuPipeline, IsItsStagesAndItsBytesDecode) {
    using Chain = ImuPipeline<PipelineConfig>;
    Chain::Params params;
    params.motion.encoder.tick_ns = 4'000'000;
    auto chain = std::make_unique<Chain>(params);
    auto decoder = std::make_unique<Decoder>();
    Intake<Sample> intake;
    Attitude attitude;
    std::size_t bytes = 0;
    Decoder::Update update;
    const auto take = [&](const Bytes& frames) {
        bytes += frames.size;
        for (std::size_t k = 0; k < frames.size; ++k) {
            if (!decoder->push(frames.data[k])) continue;
            while (decoder->next(update)) {
                EXPECT_EQ(update.channel, Decoder::Channel::orientation);
            }
        }
    };
    constexpr int n = 7500;  // 30 s
    for (int i = 0; i < n; ++i) {
        take(chain->push(turntable(i)));
        const auto sample = intake.push(turntable(i));
        const auto pose = attitude.push(*sample);
        ASSERT_EQ(static_cast<bool>(pose), static_cast<bool>(chain->pose()));
        ASSERT_NEAR(rotation_angle(pose->q_wb, chain->pose()->q_wb), 0, 1e-5f);
    }
    for (Bytes frames = chain->flush(); !frames.empty(); frames = chain->flush()) take(frames);
    EXPECT_GT(decoder->counters().frames, 0u);
    EXPECT_EQ(decoder->counters().damaged, 0u);
    EXPECT_LT(bytes, n * sizeof(Quat) / 20);
}

// A range is the chip's: neither the calibration's scale nor the mounting may hide its end.
TEST(ImuPipeline, NoticesTheEndOfARangeBeforeCalibrationMovesIt) {
    using Chain = ImuPipeline<PipelineConfig>;
    Chain::Params params;
    params.attitude.gyro_full_scale_rad_s = 4;
    params.attitude.accel_full_scale_m_s2 = 40;
    params.calibration.gyro.matrix = {{0.9f, 0, 0}, {0, 0.9f, 0}, {0, 0, 0.9f}};
    params.calibration.q_bs = from_rotation_vector(Vec3{0.5f, 0.4f, 0.3f});
    auto chain = std::make_unique<Chain>(params);
    for (int i = 0; i < 1000; ++i) {
        Sample s = turntable(i);
        const bool gyro = i == 700, accel = i == 800;
        if (gyro) s.gyro_rad_s.z = -4;
        if (accel) s.accel_m_s2.x = 40;
        chain->push(s);
        ASSERT_TRUE(chain->pose());
        ASSERT_EQ((chain->pose()->flags & flag::clipped) != 0, gyro || accel) << i;
    }
}

}  // namespace
