/* Everything that the C interface promises, checked from C; writes the frames of records.h to FILE,
 * for the comparison with those of frames.cpp.   usage: checks FILE */
#include <fairlead.h>
#include <stdio.h>
#include <string.h>

#include "records.h"

static int failures = 0, checks = 0;
static void check(bool good, const char* what, int line) {
    ++checks;
    if (good) return;
    ++failures;
    printf("FAIL line %d: %s\n", line, what);
}
#define CHECK(condition) check((condition), #condition, __LINE__)

#if FAIRLEAD_TAKES_POSES
typedef fairlead_pose record;
#define PUSH fairlead_pipeline_push_pose
#elif FAIRLEAD_TAKES_SAMPLES
typedef fairlead_sample record;
#define PUSH fairlead_pipeline_push_sample
#else
typedef fairlead_vector record;
#define PUSH fairlead_pipeline_push_vector
#endif
#if FAIRLEAD_TAKES_VECTORS
typedef fairlead_vector filtered_record;
#else
typedef fairlead_pose filtered_record;
#endif

static fairlead_pipeline pipeline;
static fairlead_decoder decoder;
static fairlead_live live;
static fairlead_attitude attitude;
static uint8_t stream[65536];
static size_t stream_size = 0;
static filtered_record kept[record_count];
static int kept_count = 0;
static fairlead_piece pieces[4096];
static int piece_count = 0;

static record record_at(int i) {
    record r;
    memset(&r, 0, sizeof r);
    r.t_ns = record_time(i);
#if FAIRLEAD_TAKES_POSES
    for (int a = 0; a < 3; ++a) r.p_w_m[a] = 0.1f * (float)(a + 1) * record_wave(i + 20 * a);
    r.q_wb[0] = 1;
    r.q_wb[1] = 0.004f * record_wave(i); /* of unit length within the intake's tolerance */
    r.flags = FAIRLEAD_POSITION_VALID | FAIRLEAD_ORIENTATION_VALID;
#elif FAIRLEAD_TAKES_SAMPLES
    for (int a = 0; a < 3; ++a) r.gyro_rad_s[a] = 0.3f * record_wave(i + 20 * a);
    r.accel_m_s2[2] = 9.80665f;
    r.flags = FAIRLEAD_GYRO_VALID | FAIRLEAD_ACCEL_VALID;
#else
    for (int a = 0; a < FAIRLEAD_COMPONENTS; ++a) r.value[a] = record_wave(i + 20 * a);
    r.flags = FAIRLEAD_VECTOR_VALID;
#endif
    if (!record_is_valid(i)) r.flags = 0;
    return r;
}

static void take(const fairlead_bytes bytes) {
    CHECK(stream_size + bytes.size <= sizeof stream);
    if (bytes.size > 0) memcpy(stream + stream_size, bytes.data, bytes.size);
    stream_size += bytes.size;
}

static void check_memory_without_object(void) {
    record r = record_at(0);
    fairlead_pipeline_statistics counts;
    fairlead_decoder_statistics seen;
    fairlead_event event;
    filtered_record out;
    fairlead_piece piece;
    fairlead_axis_motion motion;
    fairlead_position_motion position;
    fairlead_attitude_estimate estimate;
    fairlead_fault_counts faults;
    fairlead_sample sample;
    fairlead_pose pose;
    int64_t t_ns;
    memset(&event, 0, sizeof event);
    memset(&sample, 0, sizeof sample);
    memset(&piece, 0, sizeof piece);
    CHECK(PUSH(&pipeline, &r).status == FAIRLEAD_CLOSED);
    CHECK(PUSH(NULL, &r).status == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_pipeline_idle(&pipeline).status == FAIRLEAD_CLOSED);
    CHECK(fairlead_pipeline_flush(&pipeline).status == FAIRLEAD_CLOSED);
    CHECK(fairlead_pipeline_flush(NULL).status == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_pipeline_reset(&pipeline) == FAIRLEAD_CLOSED);
    CHECK(fairlead_pipeline_count(&pipeline, &counts) == FAIRLEAD_CLOSED);
    CHECK(fairlead_pipeline_filtered(&pipeline, &out) == FAIRLEAD_CLOSED);
    CHECK(fairlead_pipeline_push_event(&pipeline, &event) == FAIRLEAD_CLOSED);
    CHECK(fairlead_pipeline_refused_field(&pipeline) == NULL);
    CHECK(fairlead_pipeline_refused_field(NULL) == NULL);
    CHECK(!fairlead_decoder_push(&decoder, 0) && !fairlead_decoder_finish(&decoder));
    CHECK(!fairlead_decoder_next(&decoder, &piece) && !fairlead_decoder_push(NULL, 0));
    CHECK(!fairlead_decoder_next_event(&decoder, &event));
    CHECK(fairlead_decoder_count(&decoder, &seen) == FAIRLEAD_CLOSED);
    CHECK(fairlead_piece_axis(&piece, 0, &motion) == FAIRLEAD_CLOSED);
    CHECK(fairlead_piece_axis(NULL, 0, &motion) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(!fairlead_live_push(&live, 0) && !fairlead_live_finish(NULL));
    CHECK(fairlead_live_position(&live, 0, &position) == FAIRLEAD_CLOSED);
    CHECK(fairlead_live_position_until(&live, &t_ns) == FAIRLEAD_CLOSED);
    CHECK(fairlead_live_count(NULL, &seen) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_attitude_push(&attitude, &sample, &pose) == FAIRLEAD_CLOSED);
    CHECK(fairlead_attitude_now(&attitude, &estimate) == FAIRLEAD_CLOSED);
    CHECK(fairlead_attitude_count(&attitude, &faults) == FAIRLEAD_CLOSED);
    CHECK(fairlead_attitude_reset(&attitude) == FAIRLEAD_CLOSED);
    CHECK(fairlead_attitude_refused_field(&attitude) == NULL);
}

static void check_texts(void) {
    CHECK(fairlead_version() == FAIRLEAD_C_VERSION);
    CHECK(strcmp(fairlead_status_text(FAIRLEAD_OK), "ok") == 0);
    CHECK(strcmp(fairlead_status_text(FAIRLEAD_NO_VALID_DATA), "no valid data") == 0);
    CHECK(strcmp(fairlead_status_text(FAIRLEAD_STATUS_COUNT), "unknown") == 0);
    CHECK(strcmp(fairlead_status_text(-1), "unknown") == 0);
}

static bool refuses(const fairlead_pipeline_params* params, const char* field) {
    record r = record_at(0);
    fairlead_event event;
    memset(&event, 0, sizeof event);
    return fairlead_pipeline_init(&pipeline, sizeof pipeline, params) == FAIRLEAD_BAD_ARGUMENT &&
           strcmp(fairlead_pipeline_refused_field(&pipeline), field) == 0 &&
           PUSH(&pipeline, &r).status == FAIRLEAD_BAD_ARGUMENT &&
           fairlead_pipeline_push_event(&pipeline, &event) == FAIRLEAD_BAD_ARGUMENT &&
           fairlead_pipeline_reset(&pipeline) == FAIRLEAD_BAD_ARGUMENT &&
           fairlead_pipeline_flush(&pipeline).size == 0;
}

static void check_parameters(void) {
    fairlead_pipeline_params good, wrong;
    record r = record_at(0);
    fairlead_pipeline_defaults(NULL);
    fairlead_pipeline_defaults(&good);
    CHECK(good.sample_period_ns > 0 && good.delay_records == FAIRLEAD_DELAY_RECORDS_MAX);
    CHECK(good.header_interval_ns == INT64_C(60000000000) && good.intake.unit_tolerance > 0);
#define REFUSED(member, value, field) \
    wrong = good;                     \
    wrong.member = (value);           \
    CHECK(refuses(&wrong, field))
    REFUSED(sample_period_ns, 1, "sample_period_ns");
    REFUSED(delay_records, FAIRLEAD_DELAY_RECORDS_MAX + 1, "delay_records");
    REFUSED(restart_interval_ns, -1, "restart_interval_ns");
    REFUSED(header_interval_ns, 0, "header_interval_ns");
    REFUSED(event_delay_records, 1000001, "event_delay_records");
    REFUSED(intake.gap_ns, -1, "gap_ns");
    REFUSED(intake.leap_ns, 0, "leap_ns");
    REFUSED(intake.position_max_m, -1, "position_max_m");
    REFUSED(intake.value_max, -1, "value_max");
    REFUSED(intake.gyro_max_rad_s, 0, "gyro_max_rad_s");
    REFUSED(intake.accel_max_m_s2, 0, "accel_max_m_s2");
    REFUSED(intake.mag_max_uT, 0, "mag_max_uT");
    REFUSED(intake.unit_tolerance, 1, "unit_tolerance");
#if FAIRLEAD_SENDS_POSITION
    REFUSED(tolerance.position_m[1], 0, "tolerance.position_m");
#endif
#if FAIRLEAD_SENDS_ORIENTATION
    REFUSED(tolerance.orientation_rad, 2, "tolerance.orientation_rad");
#endif
#if FAIRLEAD_TAKES_VECTORS
    REFUSED(tolerance.value[FAIRLEAD_COMPONENTS - 1], 0, "tolerance.value");
#endif
#if FAIRLEAD_TAKES_SAMPLES
    REFUSED(calibration.accel.matrix[2][1], 1e30f * 1e30f, "calibration");
    REFUSED(calibration.q_bs[0], 1e30f * 1e30f, "calibration");
    CHECK(good.calibration.gyro.offset[1] < -0.019f && good.calibration.mag.matrix[2][2] > 0.9f);
#endif
    CHECK(fairlead_pipeline_init(&pipeline, sizeof pipeline - 1, &good) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_pipeline_init(NULL, sizeof pipeline, &good) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_pipeline_init(&pipeline, sizeof pipeline, &good) == FAIRLEAD_OK);
    CHECK(PUSH(&pipeline, &r).status == FAIRLEAD_OK);
    CHECK(PUSH(&pipeline, NULL).status == FAIRLEAD_BAD_ARGUMENT);
}

static void check_stream(const char* path) {
    fairlead_pipeline_statistics counts;
    fairlead_bytes bytes;
    uint64_t refused = 0, invalid = 0;
    FILE* file;
    CHECK(fairlead_pipeline_init(&pipeline, sizeof pipeline, NULL) == FAIRLEAD_OK);
    CHECK(strcmp(fairlead_pipeline_refused_field(&pipeline), "") == 0);
    for (int i = 0; i < record_count; ++i) {
        const record r = record_at(i);
        bytes = PUSH(&pipeline, &r);
        take(bytes);
        refused += bytes.status == FAIRLEAD_REFUSED;
        invalid += bytes.status == FAIRLEAD_NO_VALID_DATA;
        if (fairlead_pipeline_filtered(&pipeline, &kept[kept_count]) == FAIRLEAD_OK) ++kept_count;
#if FAIRLEAD_EVENTS_MAX > 0
        if (i == 100) {
            fairlead_event event = {0, 3, 1, 0};
            event.t_ns = r.t_ns;
            for (int n = 0; n < FAIRLEAD_EVENTS_MAX; ++n)
                CHECK(fairlead_pipeline_push_event(&pipeline, &event) == FAIRLEAD_OK);
            CHECK(fairlead_pipeline_push_event(&pipeline, &event) == FAIRLEAD_OVERRUN);
            take(fairlead_pipeline_idle(&pipeline));
        }
#endif
    }
    do {
        bytes = fairlead_pipeline_flush(&pipeline);
        take(bytes);
        if (fairlead_pipeline_filtered(&pipeline, &kept[kept_count]) == FAIRLEAD_OK) ++kept_count;
    } while (bytes.status == FAIRLEAD_OK);
    CHECK(bytes.status == FAIRLEAD_END);
    CHECK(fairlead_pipeline_count(&pipeline, &counts) == FAIRLEAD_OK);
    CHECK(counts.faults.backward_time == 1 && counts.faults.repeated_time == 1 &&
          counts.faults.gap > 0);
    CHECK(counts.sample_period_ns > 0 && counts.frames > 5 && counts.run == 0);
    CHECK(counts.restarts > 0 && counts.restarts < counts.frames && counts.given_up == 0);
    CHECK(counts.refused_events == (FAIRLEAD_EVENTS_MAX > 0));
    CHECK(refused == 1);
    CHECK(FAIRLEAD_TAKES_SAMPLES || invalid == 40);
    CHECK(kept_count > record_count - 60);
    file = fopen(path, "wb");
    CHECK(file != NULL && fwrite(stream, 1, stream_size, file) == stream_size);
    if (file != NULL) fclose(file);
}

static void read_pieces(bool parsed) {
    fairlead_event event;
    if (!parsed) return;
    while (piece_count < 4096 && fairlead_decoder_next(&decoder, &pieces[piece_count]))
        ++piece_count;
    while (fairlead_decoder_next_event(&decoder, &event)) {
        CHECK(event.channel == 3 && event.value == 1 && event.t_ns == record_time(100));
        CHECK(FAIRLEAD_EVENTS_MAX > 0);
    }
}

#if FAIRLEAD_SENDS_POSITION || FAIRLEAD_TAKES_VECTORS
/* The distance of a value from the curve of an axis; large where there is no curve. */
static float axis_error(int64_t t_ns, int channel, int axis, float value) {
    fairlead_axis_motion motion;
    for (int i = piece_count; i-- > 0;) {
        const fairlead_piece* p = &pieces[i];
        if (p->rotates || p->channel != channel || p->axis != axis) continue;
        if (fairlead_piece_axis(p, t_ns, &motion) != FAIRLEAD_OK) continue;
        return motion.value > value ? motion.value - value : value - motion.value;
    }
    return 1e9f;
}
#endif
#if FAIRLEAD_SENDS_ORIENTATION
/* 1 - |dot product|: about angle^2 / 8. */
static float rotation_error(int64_t t_ns, const float* q_wb) {
    fairlead_rotation_motion motion;
    for (int i = piece_count; i-- > 0;) {
        float dot = 0;
        if (!pieces[i].rotates) continue;
        if (fairlead_piece_rotation(&pieces[i], t_ns, &motion) != FAIRLEAD_OK) continue;
        for (int a = 0; a < 4; ++a) dot += motion.q_wb[a] * q_wb[a];
        return 1 - (dot < 0 ? -dot : dot);
    }
    return 1e9f;
}
#endif

static void check_curves(void) {
    fairlead_decoder_statistics seen;
    fairlead_pipeline_params params;
    fairlead_axis_motion motion;
    fairlead_pipeline_defaults(&params);
    CHECK(fairlead_decoder_init(&decoder, sizeof decoder, 65536) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_decoder_init(&decoder, sizeof decoder, -2) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_decoder_init(&decoder, 1, FAIRLEAD_ANY_STREAM) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_decoder_init(&decoder, sizeof decoder, FAIRLEAD_ANY_STREAM) == FAIRLEAD_OK);
    for (size_t i = 0; i < stream_size; ++i)
        read_pieces(fairlead_decoder_push(&decoder, stream[i]));
    while (fairlead_decoder_finish(&decoder)) read_pieces(true);
    CHECK(fairlead_decoder_count(&decoder, &seen) == FAIRLEAD_OK);
    CHECK(seen.good_bytes == stream_size && seen.losses == 0 && seen.nonsense == 0);
    CHECK(seen.events == (FAIRLEAD_EVENTS_MAX > 0 ? FAIRLEAD_EVENTS_MAX : 0u));
    CHECK(seen.run_index == 1 && seen.last_refusal == FAIRLEAD_HEADER_GOOD && seen.in_step);
    CHECK(piece_count > 10);
    for (int i = 0; i < kept_count; ++i) {
        const filtered_record* r = &kept[i];
#if FAIRLEAD_SENDS_POSITION
        for (int a = 0; a < 3 && (r->flags & FAIRLEAD_POSITION_VALID); ++a)
            CHECK(axis_error(r->t_ns, 0, a, r->p_w_m[a]) <=
                  1.001f * params.tolerance.position_m[a]);
#endif
#if FAIRLEAD_SENDS_ORIENTATION
        const float angle = params.tolerance.orientation_rad;
        if (r->flags & FAIRLEAD_ORIENTATION_VALID)
            CHECK(rotation_error(r->t_ns, r->q_wb) <= angle * angle / 8 + 3e-7f);
#endif
#if FAIRLEAD_TAKES_VECTORS
        for (int a = 0; a < FAIRLEAD_COMPONENTS && (r->flags & FAIRLEAD_VECTOR_VALID); ++a)
            CHECK(axis_error(r->t_ns, 0, a, r->value[a]) <= 1.001f * params.tolerance.value[a]);
#endif
    }
    for (int i = 0; i < piece_count; ++i) {
        if (pieces[i].rotates) {
            CHECK(fairlead_piece_axis(&pieces[i], pieces[i].end_ns, &motion) ==
                  FAIRLEAD_BAD_ARGUMENT);
        } else if (pieces[i].start_ns < pieces[i].end_ns) {
            CHECK(fairlead_piece_axis(&pieces[i], pieces[i].end_ns, &motion) == FAIRLEAD_OK);
            CHECK(fairlead_piece_axis(&pieces[i], pieces[i].end_ns + 1, &motion) ==
                  FAIRLEAD_NOT_FOUND);
            CHECK(fairlead_piece_axis(&pieces[i], pieces[i].start_ns - 1, &motion) ==
                  FAIRLEAD_NOT_FOUND);
        }
    }
}

static void check_foreign_and_damaged_streams(void) {
    fairlead_decoder_statistics seen;
    fairlead_piece piece;
    CHECK(fairlead_decoder_init(&decoder, sizeof decoder, 4711) == FAIRLEAD_OK);
    for (size_t i = 0; i < stream_size; ++i)
        if (fairlead_decoder_push(&decoder, stream[i]))
            CHECK(!fairlead_decoder_next(&decoder, &piece));
    CHECK(fairlead_decoder_count(&decoder, &seen) == FAIRLEAD_OK);
    CHECK(seen.refused_headers > 0 && seen.last_refusal == FAIRLEAD_HEADER_FOREIGN);
    CHECK(fairlead_decoder_init(&decoder, sizeof decoder, FAIRLEAD_ANY_STREAM) == FAIRLEAD_OK);
    for (size_t i = 0; i < stream_size; ++i) {
        const bool damaged = i > stream_size / 3 && i % 97 == 0;
        const uint8_t byte = (uint8_t)(stream[i] ^ (damaged ? 0x10 : 0));
        if (fairlead_decoder_push(&decoder, byte))
            while (fairlead_decoder_next(&decoder, &piece)) continue;
    }
    CHECK(fairlead_decoder_count(&decoder, &seen) == FAIRLEAD_OK);
    CHECK(seen.losses > 0 && seen.good_bytes < stream_size);
}

static void check_live(void) {
    fairlead_decoder_statistics seen;
    fairlead_position_motion position;
    fairlead_rotation_motion rotation;
    fairlead_axis_motion axis;
    int64_t t_ns = 0;
    CHECK(fairlead_live_init(&live, sizeof live + 8) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_live_init(&live, sizeof live) == FAIRLEAD_OK);
    CHECK(fairlead_live_position_until(&live, &t_ns) == FAIRLEAD_NOT_FOUND);
    for (size_t i = 0; i < stream_size; ++i) (void)fairlead_live_push(&live, stream[i]);
    while (fairlead_live_finish(&live)) continue;
    CHECK(fairlead_live_count(&live, &seen) == FAIRLEAD_OK && seen.good_bytes == stream_size);
#if FAIRLEAD_SENDS_POSITION
    CHECK(fairlead_live_position_until(&live, &t_ns) == FAIRLEAD_OK);
    CHECK(fairlead_live_position(&live, t_ns, &position) == FAIRLEAD_OK);
    for (int a = 0; a < 3; ++a) CHECK(axis_error(t_ns, 0, a, position.p_w_m[a]) < 1e-6f);
    CHECK(fairlead_live_position(&live, t_ns + 1, &position) == FAIRLEAD_NOT_FOUND);
    CHECK(fairlead_live_position(&live, t_ns, NULL) == FAIRLEAD_BAD_ARGUMENT);
#else
    CHECK(fairlead_live_position(&live, 0, &position) == FAIRLEAD_NOT_FOUND);
#endif
#if FAIRLEAD_SENDS_ORIENTATION
    CHECK(fairlead_live_orientation_until(&live, &t_ns) == FAIRLEAD_OK);
    CHECK(fairlead_live_orientation(&live, t_ns, &rotation) == FAIRLEAD_OK);
    CHECK(rotation_error(t_ns, rotation.q_wb) < 1e-6f);
#else
    CHECK(fairlead_live_orientation(&live, t_ns, &rotation) == FAIRLEAD_NOT_FOUND);
#endif
#if FAIRLEAD_TAKES_VECTORS
    t_ns = kept[kept_count - 1].t_ns;
    CHECK(fairlead_live_axis(&live, 0, FAIRLEAD_COMPONENTS - 1, t_ns, &axis) == FAIRLEAD_OK);
    CHECK(axis_error(t_ns, 0, FAIRLEAD_COMPONENTS - 1, axis.value) < 1e-6f);
#endif
    CHECK(fairlead_live_axis(&live, 9, 0, t_ns, &axis) == FAIRLEAD_NOT_FOUND);
    CHECK(fairlead_live_axis(&live, 0, 9, t_ns, &axis) == FAIRLEAD_NOT_FOUND);
}

static fairlead_sample level(int i) {
    fairlead_sample s;
    memset(&s, 0, sizeof s);
    s.t_ns = INT64_C(10000000) * (i + 1);
    s.gyro_rad_s[0] = 0.005f + 0.0003f * (float)(i % 5 - 2);
    s.gyro_rad_s[1] = 0.0003f * (float)(i % 7 - 3);
    s.gyro_rad_s[2] = 0.0003f * (float)(i % 3 - 1);
    s.accel_m_s2[0] = 0.002f * (float)(i % 3 - 1);
    s.accel_m_s2[1] = 0.002f * (float)(i % 5 - 2);
    s.accel_m_s2[2] = 9.80665f + 0.002f * (float)(i % 7 - 3);
    s.mag_uT[1] = 20;
    s.mag_uT[2] = -40 + 0.02f * (float)(i % 5);
    s.flags = FAIRLEAD_GYRO_VALID | FAIRLEAD_ACCEL_VALID | FAIRLEAD_MAG_VALID;
    return s;
}

static void check_attitude(void) {
    static uint8_t saved[FAIRLEAD_SAVED_BYTES];
    fairlead_attitude_params params;
    fairlead_attitude_estimate now, again;
    fairlead_fault_counts faults;
    fairlead_pose pose;
    fairlead_sample s;
    fairlead_attitude_defaults(&params);
    memset(params.calibration.gyro.offset, 0, sizeof params.calibration.gyro.offset);
    params.intake.gyro_max_rad_s = -1;
    CHECK(fairlead_attitude_init(&attitude, sizeof attitude, &params) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(strcmp(fairlead_attitude_refused_field(&attitude), "gyro_max_rad_s") == 0);
    s = level(0);
    CHECK(fairlead_attitude_push(&attitude, &s, &pose) == FAIRLEAD_BAD_ARGUMENT);
    params.intake.gyro_max_rad_s = 10;
    CHECK(fairlead_attitude_init(&attitude, 4, &params) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_attitude_init(&attitude, sizeof attitude, &params) == FAIRLEAD_OK);
    for (int i = 0; i < 2000; ++i) {
        s = level(i);
        CHECK(fairlead_attitude_push(&attitude, &s, &pose) == FAIRLEAD_OK && pose.t_ns == s.t_ns);
    }
    CHECK(fairlead_attitude_push(&attitude, &s, &pose) == FAIRLEAD_REFUSED); /* the same time */
    CHECK((pose.flags & FAIRLEAD_ORIENTATION_VALID) != 0 && pose.q_wb[0] * pose.q_wb[0] > 0.3f);
    CHECK((pose.flags & FAIRLEAD_REST) != 0);
    CHECK(fairlead_attitude_count(&attitude, &faults) == FAIRLEAD_OK && faults.repeated_time == 1);
    CHECK(fairlead_attitude_now(&attitude, &now) == FAIRLEAD_OK);
    CHECK(now.bias_rad_s[0] > 0.004f && now.bias_rad_s[0] < 0.006f);
    CHECK((now.inclination_sigma_rad > 0) == (FAIRLEAD_ATTITUDE_SENSORS >= 2));
    CHECK((now.heading_sigma_rad > 0) == (FAIRLEAD_ATTITUDE_SENSORS == 3));
    CHECK(fairlead_attitude_save(&attitude, saved, sizeof saved - 1) == FAIRLEAD_BAD_ARGUMENT);
    CHECK(fairlead_attitude_save(&attitude, saved, sizeof saved) == FAIRLEAD_OK);
    CHECK(fairlead_attitude_reset(&attitude) == FAIRLEAD_OK);
    CHECK(fairlead_attitude_now(&attitude, &again) == FAIRLEAD_OK && again.bias_rad_s[0] < 0.001f);
    saved[40] ^= 1;
    CHECK(fairlead_attitude_restore(&attitude, saved, sizeof saved) == FAIRLEAD_BAD_DATA);
    saved[40] ^= 1;
    CHECK(fairlead_attitude_restore(&attitude, saved, sizeof saved) == FAIRLEAD_OK);
    CHECK(fairlead_attitude_now(&attitude, &again) == FAIRLEAD_OK);
    CHECK(again.bias_rad_s[0] >= now.bias_rad_s[0] && again.bias_rad_s[0] <= now.bias_rad_s[0]);
}

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    check_memory_without_object();
    check_texts();
    check_parameters();
    check_stream(argv[1]);
    check_curves();
    check_foreign_and_damaged_streams();
    check_live();
    check_attitude();
    printf("%d checks, %d failed\n", checks, failures);
    return failures == 0 ? 0 : 1;
}
