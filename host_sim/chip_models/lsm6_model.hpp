#pragma once
// LSM6DSO(X) and LSM6DSV(16X): reset, both sensors, data-ready (pulsed or latched), the FIFO of
// 7-byte tagged words with 10- or 9-bit count, watermark, latched overrun, time stamps, trim, self
// test. Reset while INT1 is asserted, it leaves I2C. The pages of the sensor hub and of the
// embedded functions only remember. Not modelled: I3C, per-sensor rates that differ, power modes.
#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Lsm6Model final : public ChipModel {
  public:
    enum class Kind { dso, dsv };
    Lsm6Model(Kind kind, Motion motion, std::uint8_t address = 0x6A)
        : ChipModel{address, std::move(motion)}, kind_{kind} {
        reset();
    }
    bool defective{false};  // the self test finds nothing moving
    std::int8_t trim{0};    // what the trim register says; oscillator_ppm is what is true
    bool present() const override { return !i3c_only_; }
    bool corrupt_tag{false};  // the next word carries a tag that does not exist

  private:
    using Word = std::array<std::uint8_t, 7>;
    std::size_t fifo_words() const { return dso() ? 512 : 256; }
    bool dso() const { return kind_ == Kind::dso; }

    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t after(std::uint8_t reg) const override;
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;

    std::array<std::uint8_t, 256>* page();
    void self_test();
    void batch(std::int64_t t_ns);
    void push_word(int tag, const std::uint8_t* six);
    void update_line(std::int64_t t_ns);
    std::uint8_t fifo_byte(std::uint8_t reg);
    std::uint8_t fifo_status(bool high);
    std::uint32_t ticks(std::int64_t t_ns) const;

    Kind kind_;
    std::array<std::uint8_t, 256> regs_{};
    std::array<std::uint8_t, 256> hub_{}, embedded_{};  // the pages behind FUNC_CFG_ACCESS
    std::array<std::int16_t, 3> gyro_{}, accel_{};
    std::int16_t temperature_{0};
    bool fresh_gyro_{false}, fresh_accel_{false};
    std::deque<Word> fifo_;
    bool overrun_{false};
    bool overrun_latched_{false};
    unsigned slot_{0};
    std::int64_t tick_zero_ns_{0};
    bool i3c_only_{false};
};

}  // namespace fairlead::sim
