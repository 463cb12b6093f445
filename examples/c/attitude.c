/* Attitude alone in C: the raw numbers of an IMU in, its orientation out.
 * docs/c.md has the commands that build it. */
#include <fairlead.h>
#include <math.h>
#include <stdio.h>

static fairlead_attitude attitude;

/* At rest for five seconds, then the board nods by 30 degrees about its x axis; 100 samples/s. */
static fairlead_sample sample_at(int i) {
    const float t = i < 500 ? 0 : (float)(i - 500) / 100, swing = 0.5236f;
    const float angle = swing * sinf(t), rate = i < 500 ? 0 : swing * cosf(t);
    fairlead_sample sample = {0};
    sample.t_ns = i * INT64_C(10000000);
    sample.gyro_rad_s[0] = rate + 0.0005f * (float)(i % 5 - 2); /* and some noise */
    sample.gyro_rad_s[1] = 0.0005f * (float)(i % 7 - 3);
    sample.gyro_rad_s[2] = 0.0005f * (float)(i % 3 - 1);
    sample.accel_m_s2[0] = 0.002f * (float)(i % 3 - 1);
    sample.accel_m_s2[1] = 9.80665f * sinf(angle) + 0.002f * (float)(i % 5 - 2);
    sample.accel_m_s2[2] = 9.80665f * cosf(angle) + 0.002f * (float)(i % 7 - 3);
    sample.flags = FAIRLEAD_GYRO_VALID | FAIRLEAD_ACCEL_VALID;
    return sample;
}

int main(void) {
    fairlead_attitude_params params;
    fairlead_attitude_defaults(&params);
    params.calibration.gyro.offset[0] = 0.001f; /* rad/s, as found on this board */
    params.calibration.gyro.offset[1] = params.calibration.gyro.offset[2] = 0;
    if (fairlead_attitude_init(&attitude, sizeof attitude, &params) != FAIRLEAD_OK) {
        fprintf(stderr, "refused: %s\n", fairlead_attitude_refused_field(&attitude));
        return 1;
    }
    for (int i = 0; i < 2000; ++i) {
        const fairlead_sample sample = sample_at(i);
        fairlead_pose pose;
        const fairlead_status status = fairlead_attitude_push(&attitude, &sample, &pose);
        if (status != FAIRLEAD_OK) {
            printf("sample %d: %s\n", i, fairlead_status_text(status));
        } else if (i % 250 == 0 && !(pose.flags & FAIRLEAD_SETTLING)) {
            printf("%5.2f s  w x y z %.4f %.4f %.4f %.4f\n", (double)pose.t_ns * 1e-9,
                   (double)pose.q_wb[0], (double)pose.q_wb[1], (double)pose.q_wb[2],
                   (double)pose.q_wb[3]);
        }
    }
    fairlead_attitude_estimate now;
    if (fairlead_attitude_now(&attitude, &now) != FAIRLEAD_OK) return 1;
    printf("gyro bias %.5f %.5f %.5f rad/s, inclination known to %.2f deg\n",
           (double)now.bias_rad_s[0], (double)now.bias_rad_s[1], (double)now.bias_rad_s[2],
           (double)now.inclination_sigma_rad * 57.29578);
    return 0;
}
