#pragma once
// AK8963: power-down, both continuous modes, single and self test, fuse ROM, 16-bit data with lock
// until ST2 is read, 14-bit data where bit 4 of CNTL1 is 0. The motion is given in the chip's own
// axes. Not modelled: SPI.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Ak8963Model final : public ChipModel {
  public:
    static constexpr std::array<std::uint8_t, 3> asa{176, 150, 128};

    explicit Ak8963Model(
        Motion motion, std::function<bool()> gate = [] { return true; })
        : ChipModel{0x0C, std::move(motion)}, gate_{std::move(gate)} {
        reset();
    }
    bool present() const override { return gate_(); }
    bool defective{false};

  private:
    std::uint8_t get(std::uint8_t reg) override {
        if (reg >= 0x03 && reg <= 0x08) {
            locked_ = true;
            const int v = field_[(reg - 0x03u) / 2];
            return (reg & 1) ? low_byte(v) : high_byte(v);
        }
        if (reg == 0x09) {
            locked_ = false;
            regs_[0x02] = 0;
            return static_cast<std::uint8_t>((overflow_ ? 0x08 : 0) | (regs_[0x0A] & 0x10));
        }
        if (reg >= 0x10 && reg <= 0x12)  // only in the mode that opens the fuse ROM
            return (regs_[0x0A] & 0x0F) == 0x0F ? asa[reg - 0x10u] : 0;
        return reg < regs_.size() ? regs_[reg] : 0;
    }
    void set(std::uint8_t reg, std::uint8_t value) override {
        if (reg == 0x0B && (value & 1)) {
            reset();
        } else if (reg == 0x0A) {
            // modes change through power-down only: anything else is not taken
            const bool from_power_down = (regs_[0x0A] & 0x0F) == 0;
            if (from_power_down || (value & 0x0F) == 0) regs_[0x0A] = value & 0x1F;
            regs_[0x02] = 0;
            locked_ = false;
        } else if (reg == 0x0C) {
            regs_[0x0C] = value & 0x40;
        }
        reschedule();
    }
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == 0x09 ? 0x00 : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override {
        regs_ = {};
        regs_[0x00] = 0x48;
        regs_[0x01] = 0x9A;
        field_ = {};
        overflow_ = locked_ = false;
    }
    double period_ns() const override {
        switch (regs_[0x0A] & 0x0F) {
            case 0x01:
            case 0x08: return 7.3e6;
            case 0x02: return 125e6;
            case 0x06: return 10e6;
            default: return 0;
        }
    }
    void sample(const Truth& truth, std::int64_t) override {
        if (locked_) return;
        const int mode = regs_[0x0A] & 0x0F;
        if (regs_[0x02] & 0x01) regs_[0x02] |= 0x02;
        regs_[0x02] |= 0x01;
        const float m[3] = {truth.mag_uT.x, truth.mag_uT.y, truth.mag_uT.z};
        const double count_uT = (regs_[0x0A] & 0x10) ? 0.15 : 0.6;
        for (std::size_t i = 0; i < 3; ++i)
            field_[i] = counts(m[i], count_uT * ((asa[i] - 128) / 256.0 + 1));
        overflow_ = std::abs(m[0]) + std::abs(m[1]) + std::abs(m[2]) >= 4912.0f;
        if (mode == 0x08 && (regs_[0x0C] & 0x40))
            field_ = defective ? std::array<std::int16_t, 3>{0, 0, 0}
                               : std::array<std::int16_t, 3>{40, -60, -2000};
        if (mode == 0x01 || mode == 0x08) {
            regs_[0x0A] &= 0x10;
            reschedule();
        }
    }

    std::function<bool()> gate_;
    std::array<std::uint8_t, 32> regs_{};
    std::array<std::int16_t, 3> field_{};
    bool overflow_{false};
    bool locked_{false};  // between the first byte of data and ST2 nothing changes
};

}  // namespace fairlead::sim
