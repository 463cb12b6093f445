#pragma once
// LIS3MDL and AK09916, and the little of an ICM-20948 that stands before the latter: the bypass.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

/// Not modelled: single conversion, the interrupt thresholds, SPI.
class Lis3mdlModel final : public ChipModel {
  public:
    explicit Lis3mdlModel(Motion motion, std::uint8_t address = 0x1C)
        : ChipModel{address, std::move(motion)} {
        reset();
    }
    bool defective{false};

  private:
    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t pointer_of(std::uint8_t first) override {
        increment_ = (first & 0x80) != 0;
        return first & 0x7F;
    }
    std::uint8_t after(std::uint8_t reg) const override {
        return increment_ ? static_cast<std::uint8_t>((reg + 1) & 0x7F) : reg;
    }
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;

    std::array<std::uint8_t, 128> regs_{};
    std::array<std::int16_t, 3> field_{};
    std::int16_t temperature_{0};
    std::uint8_t status_{0};
    bool increment_{false};
};

/// Not modelled: SPI, the daisy chain. `gate`: whether anything connects it to the bus.
class Ak09916Model final : public ChipModel {
  public:
    explicit Ak09916Model(
        Motion motion, std::function<bool()> gate = [] { return true; })
        : ChipModel{0x0C, std::move(motion)}, gate_{std::move(gate)} {
        reset();
    }
    bool present() const override { return gate_(); }
    bool defective{false};

  private:
    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    /// Reading wraps from ST2 to ST1, as from 0x18 to 0x10.
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == 0x18 ? 0x10 : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;

    std::function<bool()> gate_;
    std::array<std::uint8_t, 128> regs_{};
    std::array<std::int16_t, 3> field_{};
    bool overflow_{false};
    bool locked_{false};  // between the first byte of data and ST2 nothing changes
};

/// Identity, banks, power, bypass: what a driver passes on its way to the magnetometer.
class Icm20948Gate final : public ChipModel {
  public:
    explicit Icm20948Gate(std::uint8_t address = 0x68)
        : ChipModel{address, [](std::int64_t) { return Truth{}; }} {
        reset();
    }
    bool bypass() const {
        return (regs_[0x0F] & 0x02) != 0 && (regs_[0x03] & 0x20) == 0 && (regs_[0x06] & 0x40) == 0;
    }

  private:
    std::uint8_t get(std::uint8_t reg) override {
        if (reg == 0x7F) return static_cast<std::uint8_t>(bank_ << 4);
        return bank_ == 0 ? regs_[reg & 0x7F] : 0;
    }
    void set(std::uint8_t reg, std::uint8_t value) override {
        if (reg == 0x7F)
            bank_ = value >> 4 & 3;
        else if (bank_ == 0 && reg == 0x06 && (value & 0x80))
            reset();
        else if (bank_ == 0 && reg != 0)
            regs_[reg & 0x7F] = value;
    }
    void reset() override {
        regs_ = {};
        regs_[0x00] = 0xEA;
        regs_[0x06] = 0x41;  // asleep
        bank_ = 0;
    }
    double period_ns() const override { return 0; }
    void sample(const Truth&, std::int64_t) override {}

    std::array<std::uint8_t, 128> regs_{};
    int bank_{0};
};

}  // namespace fairlead::sim
