#pragma once
// MMC5983MA: single and continuous measurements of 18 bits, SET and RESET of the bridge, whose
// offset is part of every reading. Control registers read as zero, as in the part. Not modelled:
// temperature measurements, SPI.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Mmc5983maModel final : public ChipModel {
  public:
    explicit Mmc5983maModel(Motion motion) : ChipModel{0x30, std::move(motion)} {
        reset();
        start_up_ns = 10000000;
    }
    bool defective{false};  // the bridge does not turn
    float offset_uT{0};     // of the bridge; SET and RESET turn the field, not this

  private:
    std::uint8_t get(std::uint8_t reg) override {
        if (reg <= 0x06) {
            if (reg == 0x06) status_ &= static_cast<std::uint8_t>(~0x01);
            if (reg < 0x06)
                return static_cast<std::uint8_t>(field_[reg / 2u] >> ((reg & 1) ? 2 : 10) & 0xFF);
            return static_cast<std::uint8_t>((field_[0] & 3) << 6 | (field_[1] & 3) << 4 |
                                             (field_[2] & 3) << 2);
        }
        if (reg == 0x08) return status_;
        return reg == 0x2F ? 0x30 : 0;
    }
    void set(std::uint8_t reg, std::uint8_t value) override {
        if (reg == 0x08) {
            status_ &= static_cast<std::uint8_t>(~(value & 0x03));  // a 1 clears
        } else if (reg == 0x0A && (value & 0x80)) {
            reset();
        } else if (reg >= 0x09 && reg <= 0x0B) {
            control_[reg - 0x09u] = value;
            if (reg == 0x09 && (value & 0x08)) turned_ = false;
            if (reg == 0x09 && (value & 0x10) && !defective) turned_ = true;
        }
        reschedule();
    }
    void reset() override {
        control_ = {};
        field_ = {131072, 131072, 131072};
        status_ = 0x10;
        turned_ = false;
    }
    double period_ns() const override {
        const double hz[8] = {0, 1, 10, 20, 50, 100, 200, 1000};
        if (control_[0] & 0x01) return 8e6;  // one measurement
        const int code = control_[2] & 7;
        return (control_[2] & 0x08) && code > 0 ? 1e9 / hz[code] : 0;
    }
    void sample(const Truth& truth, std::int64_t) override {
        const float m[3] = {truth.mag_uT.x, truth.mag_uT.y, truth.mag_uT.z};
        for (std::size_t i = 0; i < 3; ++i) {
            const double uT = static_cast<double>((turned_ ? -m[i] : m[i]) + offset_uT);
            const double count = std::round(uT / 100 * 16384) + 131072;
            field_[i] = static_cast<std::int32_t>(count < 0 ? 0 : count > 262143 ? 262143 : count);
        }
        status_ |= 0x01;
        if (control_[0] & 0x01) {
            control_[0] &= static_cast<std::uint8_t>(~0x01);
            reschedule();
        }
    }

    std::array<std::uint8_t, 3> control_{};
    std::array<std::int32_t, 3> field_{};
    std::uint8_t status_{0};
    bool turned_{false};
};

}  // namespace fairlead::sim
