/* The whole way in C: poses in, bytes out, and the reader at the other end of the line.
 * docs/c.md has the commands that build it. */
#include <fairlead.h>
#include <math.h>
#include <stdio.h>

static fairlead_pipeline pipeline; /* static: RAM is what the linker says */
static fairlead_live reader;

/* A 120 Hz tracker: a waving hand. */
static fairlead_pose pose_at(int i) {
    const float t = (float)i / 120, angle = 0.4f * sinf(2 * t);
    fairlead_pose pose = {0};
    pose.t_ns = i * INT64_C(8333333);
    pose.p_w_m[0] = 0.3f * sinf(3 * t);
    pose.p_w_m[1] = 0.1f * t;
    pose.p_w_m[2] = 1;
    pose.q_wb[0] = cosf(angle / 2);
    pose.q_wb[3] = sinf(angle / 2);
    pose.flags = FAIRLEAD_POSITION_VALID | FAIRLEAD_ORIENTATION_VALID;
    return pose;
}

/* The line: here the reader is in the same program. Returns the number of bytes. */
static size_t send(const fairlead_bytes bytes) {
    for (size_t i = 0; i < bytes.size; ++i) (void)fairlead_live_push(&reader, bytes.data[i]);
    return bytes.size;
}

static void print_end(void) {
    int64_t t_ns;
    fairlead_position_motion motion;
    if (fairlead_live_position_until(&reader, &t_ns) != FAIRLEAD_OK) return;
    if (fairlead_live_position(&reader, t_ns, &motion) != FAIRLEAD_OK) return;
    printf("%.3f s  %.4f %.4f %.4f m  %.3f %.3f %.3f m/s\n", (double)t_ns * 1e-9,
           (double)motion.p_w_m[0], (double)motion.p_w_m[1], (double)motion.p_w_m[2],
           (double)motion.velocity_m_s[0], (double)motion.velocity_m_s[1],
           (double)motion.velocity_m_s[2]);
}

int main(void) {
    fairlead_pipeline_params params;
    fairlead_pipeline_defaults(&params);
    params.stream_id = 7;
    if (fairlead_pipeline_init(&pipeline, sizeof pipeline, &params) != FAIRLEAD_OK) {
        fprintf(stderr, "the pipeline refuses %s\n", fairlead_pipeline_refused_field(&pipeline));
        return 1;
    }
    if (fairlead_live_init(&reader, sizeof reader) != FAIRLEAD_OK) return 1;

    size_t bytes = 0;
    for (int i = 0; i < 1200; ++i) {
        const fairlead_pose pose = pose_at(i);
        bytes += send(fairlead_pipeline_push_pose(&pipeline, &pose));
        if (i % 120 == 119) print_end();
    }
    fairlead_bytes rest;
    do {
        rest = fairlead_pipeline_flush(&pipeline);
        bytes += send(rest);
    } while (rest.status == FAIRLEAD_OK);
    while (fairlead_live_finish(&reader)) continue;
    print_end();

    fairlead_pipeline_statistics sent;
    fairlead_decoder_statistics seen;
    if (fairlead_pipeline_count(&pipeline, &sent) != FAIRLEAD_OK) return 1;
    if (fairlead_live_count(&reader, &seen) != FAIRLEAD_OK) return 1;
    printf("1200 poses became %u bytes in %u frames; the reader took %u frames\n", (unsigned)bytes,
           (unsigned)sent.frames, (unsigned)seen.frames);
    return seen.frames == sent.frames ? 0 : 1;
}
