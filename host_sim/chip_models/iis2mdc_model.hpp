#pragma once
// IIS2MDC and LIS2MDL: idle and continuous mode, data-ready on the pin, overrun, self test,
// temperature. Not modelled: single mode, thresholds, SPI.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Iis2mdcModel final : public ChipModel {
  public:
    explicit Iis2mdcModel(Motion motion) : ChipModel{0x1E, std::move(motion)} { reset(); }
    bool defective{false};

  private:
    std::uint8_t get(std::uint8_t reg) override {
        if (reg >= 0x68 && reg <= 0x6D) {
            const int v = field_[(reg - 0x68u) / 2];
            if (reg == 0x6D) {
                status_ = 0;
                set_line(false, now());
            }
            return (reg & 1) ? high_byte(v) : low_byte(v);
        }
        if (reg == 0x67) return status_;
        if (reg == 0x6E) return low_byte(temperature_);
        if (reg == 0x6F) return high_byte(temperature_);
        return regs_[reg & 0x7F];
    }
    void set(std::uint8_t reg, std::uint8_t value) override {
        if (reg == 0x60 && (value & 0x20)) {
            reset();
        } else if (reg >= 0x45 && reg <= 0x65 && reg != 0x4F) {
            regs_[reg] = value;
        }
        reschedule();
    }
    void reset() override {
        regs_ = {};
        regs_[0x4F] = 0x40;
        regs_[0x60] = 0x03;
        field_ = {};
        status_ = 0;
        set_line(false, now());
    }
    double period_ns() const override {
        const double hz[4] = {10, 20, 50, 100};
        return (regs_[0x60] & 3) == 0 ? 1e9 / hz[regs_[0x60] >> 2 & 3] : 0;
    }
    void sample(const Truth& truth, std::int64_t t_ns) override {
        field_ = counts(truth.mag_uT, 0.15);
        temperature_ = counts(truth.temperature_c - 25.0f, 1.0 / 8);
        if ((regs_[0x62] & 0x02) && !defective)
            for (auto& v : field_) v = static_cast<std::int16_t>(v + 20 / 0.15);
        status_ = static_cast<std::uint8_t>((status_ & 0x08) ? 0xFF : 0x0F);
        if (regs_[0x62] & 0x01) {
            set_line(false, t_ns);
            set_line(true, t_ns);
        }
    }

    std::array<std::uint8_t, 128> regs_{};
    std::array<std::int16_t, 3> field_{};
    std::int16_t temperature_{0};
    std::uint8_t status_{0};
};

}  // namespace fairlead::sim
