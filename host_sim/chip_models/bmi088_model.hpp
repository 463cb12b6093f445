#pragma once
// BMI088: two chips in one package, each with its own address, clock, power and FIFO. This model is
// the gyroscope; other_half() is the accelerometer. Modelled: the data-ready and watermark lines of
// the gyroscope, both FIFOs in stream mode, resets and how long each is deaf, sleep and the pause
// between writes that it wants, both self tests. Not modelled: the accelerometer's own interrupts,
// tags, sensor time, data synchronisation, low power.
#include <vector>

#include "host_sim/chip_models/chip_model.hpp"

namespace fairlead::sim {

class Bmi088Accel final : public ChipModel {
  public:
    explicit Bmi088Accel(Motion motion) : ChipModel{0x18, std::move(motion)} {
        reset();
        start_up_ns = 1000000;
    }
    bool present() const override { return now() >= reset_done_ns_; }
    bool defective{false};
    bool foreign_frame{false};  // the next frame that is read has the header of another kind

  private:
    static constexpr std::size_t frame = 7, frames = 1024 / frame;

    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == 0x26 ? reg : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override;
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;
    double m_s2_per_count() const { return (3 << (regs_[0x41] & 3)) / 32768.0 * g_m_s2; }
    std::uint8_t pop();

    std::array<std::uint8_t, 128> regs_{};
    std::array<std::int16_t, 3> accel_{};
    int temperature_{-1024};
    bool fresh_{false};
    std::deque<std::array<std::uint8_t, frame>> fifo_;
    std::size_t fifo_at_{0};
    unsigned skipped_{0};
    std::int64_t reset_done_ns_{INT64_MIN}, written_ns_{INT64_MIN / 2};
};

class Bmi088Model final : public ChipModel {
  public:
    explicit Bmi088Model(Motion motion) : ChipModel{0x68, motion}, accel{std::move(motion)} {
        clear();
        start_up_ns = 30000000;
    }
    ChipModel* other_half() override { return &accel; }
    bool present() const override { return now() >= reset_done_ns_; }

    Bmi088Accel accel;
    bool defective{false};  // of both halves

  private:
    static constexpr std::size_t frame = 6, frames = 100;

    std::uint8_t get(std::uint8_t reg) override;
    void set(std::uint8_t reg, std::uint8_t value) override;
    std::uint8_t after(std::uint8_t reg) const override {
        return reg == 0x3F ? reg : static_cast<std::uint8_t>(reg + 1);
    }
    void reset() override {  // the supply failed, for both
        clear();
        accel.power_cycle();
    }
    void clear();
    void empty();
    double period_ns() const override;
    void sample(const Truth& truth, std::int64_t t_ns) override;
    void update_line(std::int64_t t_ns);

    std::array<std::uint8_t, 128> regs_{};
    std::array<std::int16_t, 3> gyro_{};
    std::int64_t sampled_ns_{INT64_MIN / 2};
    std::deque<std::array<std::uint8_t, frame>> fifo_;
    std::size_t fifo_at_{0};
    bool overrun_{false};
    std::int64_t reset_done_ns_{INT64_MIN};
};

}  // namespace fairlead::sim
