#pragma once
// What a fuzz target makes of its bytes: numbers, times and records, and how it says that something
// is wrong. When the bytes are used up, everything is zero: short inputs are good inputs.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "fairlead/base/types.hpp"

/// Ends the run with the place and the text where a property does not hold.
#define FUZZ_EXPECT(condition)                                                                  \
    do {                                                                                        \
        if (!(condition)) {                                                                     \
            std::fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition); \
            std::abort();                                                                       \
        }                                                                                       \
    } while (false)

namespace fairlead::fuzz {

class Input {
  public:
    Input(const std::uint8_t* data, std::size_t size) : data_{data}, left_{size} {}

    bool empty() const { return left_ == 0; }
    std::size_t left() const { return left_; }
    const std::uint8_t* data() const { return data_; }

    template <class T>
    T raw() {
        std::array<std::uint8_t, sizeof(T)> bytes{};
        const std::size_t n = left_ < sizeof(T) ? left_ : sizeof(T);
        if (n > 0) std::memcpy(bytes.data(), data_, n);
        data_ += n;
        left_ -= n;
        T out;
        std::memcpy(&out, bytes.data(), sizeof(T));
        return out;
    }
    std::uint8_t byte() { return raw<std::uint8_t>(); }
    bool flag() { return (byte() & 1) != 0; }
    /// 0 ... n - 1.
    std::size_t below(std::size_t n) { return raw<std::uint16_t>() % n; }

    /// Mostly sizes up to `usual`, in coarse steps that meet often; sometimes any float at all.
    float number(float usual) {
        const auto k = static_cast<std::int8_t>(byte());
        if (k == -128) return raw<float>();
        if (k == 127) return special();
        return usual * static_cast<float>(k) / 100;
    }
    Vec3 vector(float usual) { return {number(usual), number(usual), number(usual)}; }

    /// The time after t_ns: mostly a step of up to eight periods, sometimes back, or anything.
    std::int64_t time_after(std::int64_t t_ns, std::int64_t period_ns) {
        const std::uint8_t k = byte();
        const auto wrapped = static_cast<std::uint64_t>(t_ns);
        const auto p = static_cast<std::uint64_t>(period_ns);
        if (k < 160) return static_cast<std::int64_t>(wrapped + p);
        if (k < 216) return static_cast<std::int64_t>(wrapped + p * (k - 159u) / 7);
        if (k < 232) return static_cast<std::int64_t>(wrapped - p * (k - 215u));
        if (k < 248)
            return static_cast<std::int64_t>(wrapped + p * (std::uint64_t{1} << (k - 228u)));
        if (k < 254) return raw<std::int64_t>();
        return k == 254 ? std::numeric_limits<std::int64_t>::max()
                        : std::numeric_limits<std::int64_t>::min();
    }

  private:
    float special() {
        constexpr float values[] = {0.0f,
                                    -0.0f,
                                    std::numeric_limits<float>::infinity(),
                                    -std::numeric_limits<float>::infinity(),
                                    std::numeric_limits<float>::quiet_NaN(),
                                    std::numeric_limits<float>::max(),
                                    std::numeric_limits<float>::min(),
                                    std::numeric_limits<float>::denorm_min()};
        return values[byte() % 8];
    }

    const std::uint8_t* data_;
    std::size_t left_;
};

/// A sample of an IMU with any flags; its time is the caller's.
inline Sample sample(Input& in) {
    Sample s;
    const std::uint8_t kind = in.byte();
    s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid | flag::temperature_valid;
    if (kind >= 192) s.flags = in.raw<std::uint32_t>();
    if (kind & 1) s.gyro_rad_s = in.vector(5);
    s.accel_m_s2 = kind & 2 ? in.vector(20) : Vec3{0, 0, 9.81f};
    s.mag_uT = kind & 4 ? in.vector(60) : Vec3{0, 20, -40};
    if (kind & 8) s.temperature_c = in.number(80);
    return s;
}

}  // namespace fairlead::fuzz
