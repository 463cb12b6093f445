#pragma once
// All that a board has to supply: four functions. board_mps2.cpp does it for an emulated
// Cortex-M4F; for your own board write these four and keep main.cpp. Nothing here allocates.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/types.hpp"

namespace board {

/// Clocks, sensor, interrupt and UART on. The interrupt stamps each record by a monotonic clock and
/// queues the stamp (or the record, where the sensor has no FIFO of its own).
void start();

/// Sleeps until there is a record and reads it. False: the board is to stop.
bool next(fairlead::Pose& record);
/// The same of a board with a bare IMU (main_imu.cpp): SI units, body frame, valid bits set.
bool next(fairlead::Sample& sample);

/// Sends bytes; returns when the buffer may be used again (a board with DMA copies or swaps).
void send(const std::uint8_t* bytes, std::size_t size);

/// Ends the program, on boards that can.
[[noreturn]] void stop();

}  // namespace board
