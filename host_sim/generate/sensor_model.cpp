#include "host_sim/generate/sensor_model.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

constexpr double deg = pi_v<double> / 180, g = 9.80665;
constexpr Vec3d gravity_up{0, 0, g};       // what an accelerometer at rest shows, ENU
constexpr Vec3d field_uT{0, 19.5, -44.5};  // mid-European: north and down

/// ICM-42688-P, LSM6DSO and MPU-6050 at +-2000 deg/s and +-16 g, beside a LIS3MDL at +-4 gauss.
ImuModel imu_model(double rate_hz, double gyro_mdps, double accel_ug, double gyro_step_dps,
                   double accel_step_mg, double gyro_zero_dps, double accel_zero_mg) {
    ImuModel m;
    m.rate_hz = rate_hz;
    m.gyro_noise = gyro_mdps * 1e-3 * deg;
    m.accel_noise = accel_ug * 1e-6 * g;
    m.mag_noise_uT = 0.32;
    m.gyro_step_rad_s = gyro_step_dps * deg;
    m.accel_step_m_s2 = accel_step_mg * 1e-3 * g;
    m.mag_step_uT = 100.0 / 6842;
    m.gyro_bias_rad_s = gyro_zero_dps * deg / 3;
    m.accel_bias_m_s2 = accel_zero_mg * 1e-3 * g / 3;
    m.gyro_walk = 2e-5;
    return m;
}

SensorModel tracker(const char* name, const char* summary, const TrackerModel& model) {
    return {name, summary, false, model, {}};
}

SensorModel imu(const char* name, const char* summary, const ImuModel& model) {
    return {name, summary, true, {}, model};
}

double quantised(double x, double step) { return step > 0 ? std::floor(x / step + 0.5) * step : x; }

Vec3d quantised(const Vec3d& v, double step) {
    return {quantised(v.x, step), quantised(v.y, step), quantised(v.z, step)};
}

float counted(double x, double step) {  // 16-bit counts, clipped like the chip's
    return static_cast<float>(std::clamp(std::floor(x / step + 0.5), -32768.0, 32767.0) * step);
}

Vec3 counted(const Vec3d& v, double step) {
    return {counted(v.x, step), counted(v.y, step), counted(v.z, step)};
}

Vec3 to_float(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Quat to_float(const Quatd& q) {
    return {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
            static_cast<float>(q.z)};
}

}  // namespace

const std::vector<SensorModel>& sensor_models() {
    static const std::vector<SensorModel> models{
        tracker("ideal", "120 Hz tracker, float32 and nothing else", {120, 0, 0, 0, 0}),
        tracker("optical", "120 Hz optical tracker: 0.1 mm, 0.05 deg white noise",
                {120, 1e-4, 0.05 * deg, 0, 0}),
        tracker("magnetic",
                "120 Hz magnetic tracker: 0.75 mm, 0.15 deg white noise, 14-bit fractions",
                {120, 7.5e-4, 0.15 * deg, 0x1p-14, 0x1p-14}),
        imu("icm42688p", "200 Hz ICM-42688-P: 2.8 mdps/rtHz, 70 ug/rtHz, with a LIS3MDL",
            imu_model(200, 2.8, 70, 1 / 16.4, 1 / 2.048, 0.5, 20)),
        imu("lsm6dso", "208 Hz LSM6DSO: 3.8 mdps/rtHz, 110 ug/rtHz, with a LIS3MDL",
            imu_model(208, 3.8, 110, 0.070, 0.488, 1, 20)),
        imu("mpu6050", "200 Hz MPU-6050: 5 mdps/rtHz, 400 ug/rtHz, with a LIS3MDL",
            imu_model(200, 5, 400, 1 / 16.4, 1 / 2.048, 20, 50)),
    };
    return models;
}

Pose to_pose(const MotionState& truth, std::int64_t t_ns) {
    return {t_ns, to_float(truth.p_w_m), to_float(truth.q_wb),
            flag::position_valid | flag::orientation_valid};
}

Pose TrackerSensor::measure(const MotionState& truth, std::int64_t t_ns) {
    MotionState m = truth;
    m.p_w_m = quantised(m.p_w_m + random_.normal3(model_.position_noise_m), model_.position_step_m);
    const Vec3d turn = random_.normal3(model_.orientation_noise_rad);
    Quatd q = same_side(last_, m.q_wb * from_rotation_vector(turn));
    last_ = q;
    const double step = model_.quaternion_step;
    m.q_wb = {quantised(q.w, step), quantised(q.x, step), quantised(q.y, step),
              quantised(q.z, step)};
    return to_pose(m, t_ns);
}

ImuSensor::ImuSensor(const ImuModel& model, double rate_hz, Random random)
    : model_{model}, rate_hz_{rate_hz}, random_{random} {
    gyro_bias_ = random_.normal3(model.gyro_bias_rad_s);
    accel_bias_ = random_.normal3(model.accel_bias_m_s2);
}

Sample ImuSensor::measure(const MotionState& truth, std::int64_t t_ns) {
    const double bandwidth = approx::sqrt(rate_hz_ / 2);  // noise density to one sigma
    gyro_bias_ += random_.normal3(model_.gyro_walk / approx::sqrt(rate_hz_));
    const Quatd q_bw = conj(truth.q_wb);
    const Vec3d gyro =
        truth.rate_b_rad_s + gyro_bias_ + random_.normal3(model_.gyro_noise * bandwidth);
    const Vec3d accel = rotate(q_bw, truth.accel_w_m_s2 + gravity_up) + accel_bias_ +
                        random_.normal3(model_.accel_noise * bandwidth);
    const Vec3d mag = rotate(q_bw, field_uT) + random_.normal3(model_.mag_noise_uT);
    Sample sample;
    sample.t_ns = t_ns;
    sample.gyro_rad_s = counted(gyro, model_.gyro_step_rad_s);
    sample.accel_m_s2 = counted(accel, model_.accel_step_m_s2);
    sample.mag_uT = counted(mag, model_.mag_step_uT);
    sample.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    return sample;
}

}  // namespace fairlead::sim
