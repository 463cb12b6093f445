/* All that a board has to supply for firmware.c: four functions. board_mps2.cpp has them for an
 * emulated Cortex-M4F; on your own board write them in C. */
#ifndef BOARD_H
#define BOARD_H

#include <fairlead.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Clocks, sensor, interrupt and UART on. The interrupt stamps and queues each record. */
void board_start(void);
/* Sleeps until there is a record and reads it. false: the board is to stop. */
bool board_next(fairlead_pose* pose);
/* Sends bytes; returns when the buffer may be used again. */
void board_send(const uint8_t* bytes, size_t size);
/* Ends the program, on boards that can. Does not return. */
void board_stop(void);

#ifdef __cplusplus
}
#endif
#endif
