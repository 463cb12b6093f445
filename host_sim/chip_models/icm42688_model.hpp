#pragma once
// ICM-42688-P: banks, soft reset, both sensors, data-ready, the 2 KiB FIFO of 16-byte packets with
// watermark and overrun, time stamps, self test. Not modelled: low-power modes, APEX,
// high-resolution packets, frame sync, SPI.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Icm42688Model final : public ChipModel {
  public:
    explicit Icm42688Model(Motion motion, std::uint8_t address = 0x68, std::uint8_t id = 0x47)
        : ChipModel{address, std::move(motion)}, id_{id} {
        reset();
        start_up_ns = 1000000;
    }
    bool defective{false};  // the self test finds nothing moving

  private:
    static constexpr std::size_t packet = 16, fifo_packets = 2048 / packet;

    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == 0x30 && bank_ == 0 ? reg : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;

    std::uint8_t fifo_byte();
    int fifo_count() const;
    void push_packet(std::int64_t t_ns);
    bool gyro_on() const { return (bank0_[0x4E] & 0x0C) == 0x0C; }
    bool accel_on() const { return (bank0_[0x4E] & 0x02) != 0; }
    bool fifo_on() const { return (bank0_[0x16] & 0xC0) != 0; }

    std::uint8_t id_;
    std::uint8_t bank_{0};
    std::array<std::uint8_t, 256> bank0_{};
    std::array<std::int16_t, 3> gyro_{}, accel_{};
    std::int16_t temperature_{0};
    std::uint8_t status_{0};
    std::deque<std::array<std::uint8_t, packet>> fifo_;
    std::size_t fifo_at_{0};  // bytes of the oldest packet that have been read
};

}  // namespace fairlead::sim
