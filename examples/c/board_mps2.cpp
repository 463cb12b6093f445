// The board of firmware.c under QEMU: that of the firmware in C++
// (examples/firmware/board_mps2.cpp), so that both see the same motion.
#include "board.h"
#include "examples/firmware/retarget.hpp"

extern "C" {
void board_start() { board::start(); }
bool board_next(fairlead_pose* out) {
    fairlead::Pose pose;
    if (!board::next(pose)) return false;
    *out = {pose.t_ns,
            {pose.p_w_m.x, pose.p_w_m.y, pose.p_w_m.z},
            {pose.q_wb.w, pose.q_wb.x, pose.q_wb.y, pose.q_wb.z},
            pose.flags};
    return true;
}
void board_send(const uint8_t* bytes, size_t size) { board::send(bytes, size); }
void board_stop() { board::stop(); }
}
