#pragma once
// BMI160 and BMI270: suspend and normal mode, both sensors at one rate, data-ready, watermark and
// the headerless FIFO, soft reset, self test; of the BMI270 also the upload of its configuration
// file, without which it measures nothing. Not modelled: FIFO headers, sensor time, features, low
// power, different rates of the two sensors, SPI's wake-up (tests/port/model_spi.hpp asks for it).
#include <vector>

#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class BmiModel final : public ChipModel {
  public:
    enum class Kind : std::uint8_t { bmi160, bmi270 };
    /// `blob`: what the chip takes for its configuration file; only a BMI270 asks.
    explicit BmiModel(Kind kind, Motion motion, std::vector<std::uint8_t> blob = {})
        : ChipModel{0x68, std::move(motion)}, kind_{kind}, blob_{std::move(blob)} {
        reset();
        start_up_ns = 1000000;
    }
    bool defective{false};  // neither self test moves anything

  private:
    static constexpr std::size_t frame = 12;

    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == fifo_reg() || reg == 0x5E ? reg : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;

    bool is_160() const { return kind_ == Kind::bmi160; }
    std::uint8_t fifo_reg() const { return is_160() ? 0x24 : 0x26; }
    std::size_t fifo_frames() const { return (is_160() ? 1024 : 2048) / frame; }
    bool fifo_on() const { return (regs_[is_160() ? 0x47 : 0x49] & 0xC0) == 0xC0; }
    std::size_t watermark_bytes() const {
        return is_160() ? regs_[0x46] * 4u : (regs_[0x46] | (regs_[0x47] & 0x1Fu) << 8);
    }
    bool on() const;
    int accel_g() const;
    void run_command(std::uint8_t value);
    void update_line(std::int64_t t_ns);
    void self_test();
    std::uint8_t internal_status() const;

    Kind kind_;
    std::vector<std::uint8_t> blob_;
    std::array<std::uint8_t, 128> regs_{};
    std::array<std::uint8_t, 8192> memory_{};
    std::size_t uploaded_{0};
    std::int64_t init_ns_{INT64_MAX};
    bool blob_good_{false};
    std::uint8_t pmu_{0};  // BMI160: power of accelerometer (5:4) and gyroscope (3:2)
    bool gyro_ok_{false};
    std::array<std::int16_t, 3> gyro_{}, accel_{};
    std::int16_t temperature_{0};
    bool fresh_{false};
    std::deque<std::array<std::uint8_t, frame>> fifo_;
    std::size_t fifo_at_{0};
};

}  // namespace fairlead::sim
