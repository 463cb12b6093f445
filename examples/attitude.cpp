// An IMU's raw numbers in, its orientation out: the gate, the filter, and the angles that people
// read.
#include <fairlead/sense/attitude.hpp>
#include <fairlead/sense/intake.hpp>

#include "support.hpp"

using namespace fairlead;

/// The chip's counts at +-2000 deg/s and +-16 g, in SI units; the valid bits say what it has.
Sample sample_of(const Raw& raw) {
    constexpr float rad_s = 2000 * 0.01745329f / 32768, m_s2 = 16 * 9.80665f / 32768;
    Sample s;
    s.t_ns = raw.t_us * 1000;
    s.gyro_rad_s = rad_s * Vec3{raw.gyro[0], raw.gyro[1], raw.gyro[2]};
    s.accel_m_s2 = m_s2 * Vec3{raw.accel[0], raw.accel[1], raw.accel[2]};
    s.flags = flag::gyro_valid | flag::accel_valid;
    return s;
}

int main() {
    Intake<Sample> intake;                             // refuses wrong times and values
    BasicAttitude<float, AttitudeMode::imu> attitude;  // no magnetometer: heading is relative
    Raw raw;
    for (int i = 0; next(raw); ++i) {
        const auto sample = intake.push(sample_of(raw));
        if (!sample) continue;  // refused, and counted in intake.faults()
        const auto pose = attitude.push(*sample);
        if (pose && i % 100 == 0 && !(pose->flags & flag::settling)) print(*pose);
    }
}
