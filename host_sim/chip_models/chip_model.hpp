#pragma once
// A sensor chip as its bus sees it: registers with their side effects, a sample clock with its own
// error, a FIFO, an interrupt line. Written from the data sheets, apart from the drivers: each of
// the two checks the other, and Linux's own drivers check the models.
//
// Motion comes from a function of time, so a recording or a generator can play on the chip. The
// model knows no clock: advance() tells it the time, and it produces whatever samples have become
// due.
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>

#include "fairlead/base/types.hpp"

namespace fairlead::sim {

/// What the chip feels.
struct Truth {
    Vec3 gyro_rad_s{};
    Vec3 accel_m_s2{0, 0, 9.80665f};
    Vec3 mag_uT{};
    float temperature_c{25};
};
using Motion = std::function<Truth(std::int64_t t_ns)>;

class ChipModel {
  public:
    ChipModel(std::uint8_t address, Motion motion)
        : address_{address}, motion_{std::move(motion)} {}
    virtual ~ChipModel() = default;
    ChipModel(const ChipModel&) = delete;
    ChipModel& operator=(const ChipModel&) = delete;

    // -- the bus
    std::uint8_t address() const { return address_; }
    virtual bool present() const { return true; }
    /// A second chip in the same package, on the same bus and supply.
    virtual ChipModel* other_half() { return nullptr; }
    /// Does it acknowledge its address now? Not while it starts.
    bool answers() const { return present() && now_ns_ >= up_ns_; }
    void begin_write() { pointer_set_ = false; }
    void write(std::uint8_t byte);
    std::uint8_t read();

    // -- the world
    /// Produces the samples that are due by now.
    void advance(std::int64_t now_ns);
    /// When the next sample is due, or INT64_MAX.
    std::int64_t next_ns() const { return running_ ? due_ns() : INT64_MAX; }
    /// The supply fails for an instant: every register returns to its reset value, and the chip is
    /// deaf until it has started.
    void power_cycle() {
        reset();
        reschedule();
        up_ns_ = now_ns_ + start_up_ns;
    }
    std::int64_t start_up_ns{10000000};  // from power to registers, by the data sheet
    bool line() const { return line_; }
    std::deque<std::int64_t> edges;  // times of the interrupt line's rising edges, oldest first
    double oscillator_ppm{0};        // the chip's clock is fast by so much
    std::uint64_t produced{0};       // samples since the beginning

  protected:
    virtual std::uint8_t get(std::uint8_t reg) = 0;
    virtual void set(std::uint8_t reg, std::uint8_t value) = 0;
    virtual std::uint8_t after(std::uint8_t reg) const {
        return static_cast<std::uint8_t>(reg + 1);
    }
    virtual std::uint8_t pointer_of(std::uint8_t first_byte) { return first_byte; }
    virtual void reset() = 0;
    /// Nominal; 0 while the chip sleeps.
    virtual double period_ns() const = 0;
    /// One sample falls due at t_ns.
    virtual void sample(const Truth& truth, std::int64_t t_ns) = 0;

    /// To be called whenever the rate or the power state may have changed.
    void reschedule();
    void set_line(bool level, std::int64_t t_ns) {
        if (level && !line_) edges.push_back(t_ns);
        line_ = level;
    }
    void pulse(std::int64_t t_ns) {
        set_line(true, t_ns);
        set_line(false, t_ns);
    }
    std::int64_t now() const { return now_ns_; }
    /// The chip's own seconds since it was made, in ns: what its time stamp counter counts.
    double chip_time_ns(std::int64_t t_ns) const {
        return static_cast<double>(t_ns) * (1.0 + oscillator_ppm * 1e-6);
    }

  private:
    std::int64_t due_ns() const {
        return origin_ns_ + std::llround(static_cast<double>(ticks_ + 1) * step_ns_);
    }

    std::uint8_t address_;
    Motion motion_;
    std::uint8_t pointer_{0};
    bool pointer_set_{false};
    bool line_{false};
    bool running_{false};
    double step_ns_{0};
    std::int64_t origin_ns_{0};
    std::int64_t ticks_{0};
    std::int64_t now_ns_{0};
    std::int64_t up_ns_{INT64_MIN};
};

/// A physical value as the converter outputs it.
inline std::int16_t counts(float value, double scale) {
    const double c = std::round(static_cast<double>(value) / scale);
    return static_cast<std::int16_t>(c > 32767 ? 32767 : c < -32768 ? -32768 : c);
}
inline std::array<std::int16_t, 3> counts(const Vec3& v, double scale) {
    return {counts(v.x, scale), counts(v.y, scale), counts(v.z, scale)};
}
inline std::uint8_t low_byte(int v) { return static_cast<std::uint8_t>(v & 0xFF); }
inline std::uint8_t high_byte(int v) { return static_cast<std::uint8_t>(v >> 8 & 0xFF); }

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double g_m_s2 = 9.80665;

}  // namespace fairlead::sim
