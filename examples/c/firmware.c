/* A complete firmware in C: records from an interrupt, through the pipeline, out of the UART as
 * frames. `make c-firmware-run` runs it under QEMU beside the firmware in C++ and compares their
 * frames. */
#include "board.h"

static fairlead_pipeline pipeline; /* static: RAM is what the linker says */

static void send(const fairlead_bytes frames) {
    if (frames.size > 0) board_send(frames.data, frames.size);
}

int main(void) {
    fairlead_pose pose;
    fairlead_bytes rest;
    board_start();
    /* a refused parameter has a name: fairlead_pipeline_refused_field() */
    if (fairlead_pipeline_init(&pipeline, sizeof pipeline, NULL) != FAIRLEAD_OK) board_stop();
    while (board_next(&pose)) send(fairlead_pipeline_push_pose(&pipeline, &pose));
    do {
        rest = fairlead_pipeline_flush(&pipeline);
        send(rest);
    } while (rest.status == FAIRLEAD_OK);
    board_stop();
    return 0;
}
