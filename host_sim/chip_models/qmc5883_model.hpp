#pragma once
// QMC5883L and QMC5883P: suspend and continuous mode, rates, ranges, data-ready, overflow, skipped
// data (L), self test (P). Not modelled: the interrupt pin of the L, single mode of the P.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Qmc5883Model final : public ChipModel {
  public:
    enum class Kind : std::uint8_t { l, p };
    explicit Qmc5883Model(Kind kind, Motion motion)
        : ChipModel{static_cast<std::uint8_t>(kind == Kind::l ? 0x0D : 0x2C), std::move(motion)},
          kind_{kind} {
        reset();
        start_up_ns = 350000;
    }
    bool defective{false};

  private:
    bool is_l() const { return kind_ == Kind::l; }
    std::uint8_t control() const { return regs_[is_l() ? 0x09 : 0x0A]; }
    double uT_per_count() const {
        if (is_l()) return 100.0 / ((control() >> 4 & 1) ? 3000 : 12000);
        const double counts_per_gauss[4] = {1000, 2500, 3750, 15000};
        return 100 / counts_per_gauss[regs_[0x0B] >> 2 & 3];
    }
    std::uint8_t get(std::uint8_t reg) override {
        const std::uint8_t first = is_l() ? 0x00 : 0x01;
        if (reg >= first && reg < first + 6) {
            const unsigned at = static_cast<unsigned>(reg - first);
            if (at == 5) drdy_read_ = true;
            return (at & 1) ? high_byte(field_[at / 2]) : low_byte(field_[at / 2]);
        }
        if (reg == (is_l() ? 0x06 : 0x09)) {
            const std::uint8_t value = status_;
            if (drdy_read_) status_ = 0;  // data first, then the status: now both have been read
            drdy_read_ = false;
            return value;
        }
        if (reg == 0x0D && is_l()) return 0xFF;
        if (reg == 0x00 && !is_l()) return 0x80;
        return reg < regs_.size() ? regs_[reg] : 0;
    }
    void set(std::uint8_t reg, std::uint8_t value) override {
        if (reg == (is_l() ? 0x0A : 0x0B) && (value & 0x80)) {
            reset();
        } else if (reg >= 0x09 && reg < regs_.size()) {
            regs_[reg] = value;
            if (!is_l() && reg == 0x0B && (value & 0x40)) testing_ = true;
        }
        reschedule();
    }
    std::uint8_t after(std::uint8_t reg) const override {
        return static_cast<std::uint8_t>((reg + 1) & 0x3F);
    }
    void reset() override {
        regs_ = {};
        field_ = {};
        status_ = 0;
        drdy_read_ = false;
        testing_ = false;
    }
    double period_ns() const override {
        const double ms[4] = {100, 20, 10, 5};
        const int mode = control() & 3;
        const bool on = is_l() ? mode == 1 : mode == 3;
        return on ? ms[control() >> 2 & 3] * 1e6 : 0;
    }
    void sample(const Truth& truth, std::int64_t) override {
        const double scale = uT_per_count();
        field_ = counts(truth.mag_uT, scale);
        if (testing_ && !defective)
            for (auto& v : field_) v = static_cast<std::int16_t>(v + 120 / scale);
        bool over = false;
        for (const int v : field_) over = over || v == 32767 || v == -32768;
        const bool unread = (status_ & 0x01) != 0;
        status_ = static_cast<std::uint8_t>(0x01 | (over ? 0x02 : 0));
        if (is_l() && unread) status_ |= 0x04;
        drdy_read_ = false;
    }

    Kind kind_;
    std::array<std::uint8_t, 64> regs_{};
    std::array<std::int16_t, 3> field_{};
    std::uint8_t status_{0};
    bool drdy_read_{false};
    bool testing_{false};
};

}  // namespace fairlead::sim
