#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

void ChipModel::write(std::uint8_t byte) {
    if (!pointer_set_) {
        pointer_ = pointer_of(byte);
        pointer_set_ = true;
        return;
    }
    set(pointer_, byte);
    pointer_ = after(pointer_);
}

std::uint8_t ChipModel::read() {
    const std::uint8_t value = get(pointer_);
    pointer_ = after(pointer_);
    return value;
}

void ChipModel::reschedule() {
    const double step = period_ns() / (1.0 + oscillator_ppm * 1e-6);
    if (running_ && step == step_ns_) return;
    running_ = step > 0;
    step_ns_ = step;
    origin_ns_ = now_ns_;
    ticks_ = 0;
}

void ChipModel::advance(std::int64_t now_ns) {
    while (running_ && due_ns() <= now_ns) {
        now_ns_ = due_ns();
        ++ticks_;
        ++produced;
        sample(motion_(now_ns_), now_ns_);
    }
    if (now_ns > now_ns_) now_ns_ = now_ns;
}

}  // namespace fairlead::sim
