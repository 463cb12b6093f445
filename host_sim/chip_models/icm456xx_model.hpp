#pragma once
// ICM-45686: soft reset, both sensors, data-ready, the 8 KiB FIFO of 16-byte packets with watermark
// and overrun, time stamps, indirect registers. Not modelled: low power, auxiliary data,
// high-resolution packets, self test, SPI, I3C.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Icm456xxModel final : public ChipModel {
  public:
    explicit Icm456xxModel(Motion motion, std::uint8_t id = 0xE9)
        : ChipModel{0x68, std::move(motion)}, id_{id} {
        reset();
        start_up_ns = 1000000;
    }

  private:
    static constexpr std::size_t packet = 16, fifo_packets = 8192 / packet;
    static constexpr std::uint16_t smc_control = 0xA258;

    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == 0x14 ? reg : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;
    void push_packet(std::int64_t t_ns);
    void update_line(std::int64_t t_ns);
    /// What codes of ranges begin with: the ICM-45605 family lacks the widest.
    int first() const { return id_ == 0xE9 || id_ == 0xE7 || id_ == 0x83 ? 0 : 1; }

    std::uint8_t id_;
    std::array<std::uint8_t, 128> regs_{};
    std::uint8_t smc_{0x60};
    std::uint16_t ireg_{0};
    std::uint8_t status_{0};
    std::array<std::int16_t, 3> gyro_{}, accel_{};
    std::int16_t temperature_{0};
    std::deque<std::array<std::uint8_t, packet>> fifo_;
    std::size_t fifo_at_{0};
};

}  // namespace fairlead::sim
