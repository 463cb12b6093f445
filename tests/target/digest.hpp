#pragma once
// One number for all that a stage has said so far, the same on every machine when every bit is.
// NaN counts as NaN: its payload is the machine's own affair.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/types.hpp"
#include "fairlead/math/approx.hpp"

namespace fairlead::target {

class Digest {
  public:
    void word(std::uint32_t w) noexcept {
        value_ = (value_ ^ w) * 16777619u;  // FNV-1a over words,
        value_ ^= value_ >> 15;             // its high bits folded back
    }
    std::uint32_t value() const noexcept { return value_; }

  private:
    std::uint32_t value_{2166136261u};
};

inline void mix(Digest& d, std::uint32_t x) noexcept { d.word(x); }
inline void mix(Digest& d, float x) noexcept {
    std::uint32_t bits = 0x7FC00000;
    if (!approx::is_nan(x)) __builtin_memcpy(&bits, &x, sizeof bits);
    d.word(bits);
}
inline void mix(Digest& d, std::int64_t x) noexcept {
    d.word(static_cast<std::uint32_t>(x));
    d.word(static_cast<std::uint32_t>(x >> 32));
}
inline void mix(Digest& d, const Vec3& v) noexcept {
    mix(d, v.x);
    mix(d, v.y);
    mix(d, v.z);
}
inline void mix(Digest& d, const Quat& q) noexcept {
    mix(d, q.w);
    mix(d, q.x);
    mix(d, q.y);
    mix(d, q.z);
}
inline void mix(Digest& d, const Sample& s) noexcept {
    mix(d, s.t_ns);
    mix(d, s.gyro_rad_s);
    mix(d, s.accel_m_s2);
    mix(d, s.mag_uT);
    mix(d, s.flags);
}
inline void mix(Digest& d, const Pose& p) noexcept {
    mix(d, p.t_ns);
    mix(d, p.p_w_m);
    mix(d, p.q_wb);
    mix(d, p.flags);
}
template <class T, std::size_t N>
void mix(Digest& d, const std::array<T, N>& items) noexcept {
    for (const T& item : items) mix(d, item);
}
inline void mix_bytes(Digest& d, const std::uint8_t* bytes, std::size_t size) noexcept {
    for (std::size_t i = 0; i < size; ++i) d.word(bytes[i]);
}

}  // namespace fairlead::target
