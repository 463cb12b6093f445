/* The records that the C program and the C++ program of this test both push: 900 of them, with two
 * wrong times, a pause, and a stretch without valid values. Arithmetic that rounds alike in both
 * languages. */
#ifndef RECORDS_H
#define RECORDS_H

#include <stdint.h>

enum { record_count = 900 };

static int64_t record_time(int i) {
    if (i == 300) return INT64_C(10000000) * 299; /* the time before once more: refused at once */
    if (i == 400)
        return INT64_C(10000000) * 250; /* a lone stamp of the past: waits, then refused */
    return INT64_C(10000000) * i + (i > 500 ? INT64_C(2000000000) : 0);
}
static int record_is_valid(int i) { return i < 600 || i >= 640; }

/* A triangular wave with a period of 128 records, smoothed; within +-1. */
static float record_wave(int i) {
    const int phase = i % 128, rise = phase < 64 ? phase : 128 - phase;
    const float x = (float)(rise - 32) / 32.0f;
    return x * (1.5f - 0.5f * x * x);
}
#endif
