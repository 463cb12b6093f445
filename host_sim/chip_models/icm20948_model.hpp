#pragma once
// ICM-20948: banks, sleep, both sensors, data-ready pulses, the 512-byte FIFO without packet marks
// (overflow drops the oldest bytes), bypass, self test. Not modelled: DMP, the I2C master,
// low-power cycling, different rates of the two sensors, SPI.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Icm20948Model final : public ChipModel {
  public:
    explicit Icm20948Model(Motion motion) : ChipModel{0x68, std::move(motion)} {
        reset();
        start_up_ns = 11000000;
    }
    /// Is the magnetometer connected to the bus?
    bool bypass() const {
        return (bank0_[0x0F] & 0x02) != 0 && (bank0_[0x03] & 0x20) == 0 &&
               (bank0_[0x06] & 0x40) == 0;
    }
    bool defective{false};

  private:
    static constexpr std::size_t fifo_size = 512;

    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == 0x72 && bank_ == 0 ? reg : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;
    void self_test();
    void push(int v);

    int bank_{0};
    std::array<std::uint8_t, 128> bank0_{}, bank2_{};
    std::array<std::int16_t, 3> gyro_{}, accel_{};
    std::int16_t temperature_{0};
    std::uint8_t ready_{0}, overflow_{0};
    std::deque<std::uint8_t> fifo_;
};

}  // namespace fairlead::sim
