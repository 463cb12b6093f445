#pragma once
// MPU-6050 and MPU-6500/9250: sleep, both sensors, data-ready pulses, the byte FIFO without packet
// marks (overflow drops the oldest bytes), auxiliary-bus bypass, self test. A reset takes as long
// as a start; meanwhile its bit stands and writes are lost. Not modelled: DMP, the I2C master,
// low-power cycling, wake-on-motion.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Mpu6xxxModel final : public ChipModel {
  public:
    explicit Mpu6xxxModel(Motion motion, std::uint8_t id = 0x68, std::uint8_t address = 0x68)
        : ChipModel{address, std::move(motion)}, id_{id} {
        reset();
        start_up_ns = 11000000;  // typical; at most 100 ms
    }
    /// Is the auxiliary bus connected?
    bool bypass() const { return (regs_[0x37] & 0x02) != 0 && (regs_[0x6A] & 0x20) == 0; }
    bool defective{false};

  private:
    bool second() const { return id_ != 0x68; }
    std::size_t fifo_size() const { return id_ == 0x68 ? 1024 : id_ == 0x78 ? 4096 : 512; }
    bool resetting() const { return now() < reset_done_ns_; }
    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == 0x74 ? reg : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;
    void self_test();
    void push(int v);

    std::uint8_t id_;
    std::array<std::uint8_t, 256> regs_{};
    std::array<std::int16_t, 3> gyro_{}, accel_{};
    std::int16_t temperature_{0};
    std::uint8_t status_{0};
    std::int64_t reset_done_ns_{INT64_MIN};
    std::deque<std::uint8_t> fifo_;
};

}  // namespace fairlead::sim
