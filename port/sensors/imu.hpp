#pragma once
// What all inertial drivers share: the report of a probe, of a self test, a batch out of a FIFO,
// and the way from raw counts to a Sample in SI units.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "fairlead/base/types.hpp"

namespace fairlead::port {

inline constexpr float rad_per_deg = 0.017453292519943295f;
inline constexpr float standard_gravity_m_s2 = 9.80665f;

/// What was asked, where, and what answered: "no IMU found" is never all that a user learns.
struct Probe {
    Status status{Status::not_found};  // ok, unexpected_id, or why the bus said nothing
    std::uint8_t address{};
    std::uint8_t reg{};
    std::uint8_t got{};
    std::uint8_t expected{};
    const char* part{"unknown"};
};

/// What to do about a part whose identity is not in the family's table.
enum class UnknownId : std::uint8_t { refuse, accept };

/// The part's own test. Responses in the unit that the driver's header names, gyro x y z first.
struct SelfTest {
    bool passed{};
    std::array<float, 6> response{};
};

enum class FifoState : std::uint8_t {
    streaming,  // nothing was lost since the last batch
    overrun,    // the chip dropped samples because nobody read in time
    resync,     // the place in the stream or in time was lost and has been found again
};

/// One reading of a FIFO: samples oldest first, each with its own time.
struct Batch {
    static constexpr std::size_t capacity = 64;
    std::array<Sample, capacity> samples{};
    std::size_t count{};
    FifoState state{FifoState::streaming};
    std::uint32_t lost{};  // samples missing before or within this batch; each hole has gap_before
    bool more{};           // the FIFO holds further samples now
    void clear() noexcept {
        count = 0;
        state = FifoState::streaming;
        lost = 0;
        more = false;
    }
};

/// Counts as the chip gave them, with its own time.
struct RawImu {
    std::array<std::int16_t, 3> gyro{};
    std::array<std::int16_t, 3> accel{};
    std::int16_t temperature{};
    std::uint32_t tick{};
};

/// Multiplier per count.
struct ImuScale {
    float gyro_rad_s{};
    float accel_m_s2{};
};

constexpr std::int16_t little_endian(const std::uint8_t* p) noexcept {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(p[0] | p[1] << 8));
}
constexpr std::int16_t big_endian(const std::uint8_t* p) noexcept {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(p[0] << 8 | p[1]));
}
template <std::int16_t (*Order)(const std::uint8_t*)>
constexpr std::array<std::int16_t, 3> triple(const std::uint8_t* p) noexcept {
    return {Order(p), Order(p + 2), Order(p + 4)};
}

/// A count that stands at the end of its range; both ends, and one below the top, which some parts
/// use as theirs.
constexpr bool at_end(const std::array<std::int16_t, 3>& v) noexcept {
    for (const int c : v)
        if (c >= 32766 || c <= -32767) return true;
    return false;
}

constexpr Vec3 scaled(const std::array<std::int16_t, 3>& v, float scale) noexcept {
    return {static_cast<float>(v[0]) * scale, static_cast<float>(v[1]) * scale,
            static_cast<float>(v[2]) * scale};
}

/// A count of -32768 on all axes marks "no data" in the InvenSense parts; others clip there.
constexpr Sample to_sample(const RawImu& raw, const ImuScale& scale, std::int64_t t_ns,
                           std::uint32_t flags) noexcept {
    Sample s;
    s.t_ns = t_ns;
    s.gyro_rad_s = scaled(raw.gyro, scale.gyro_rad_s);
    s.accel_m_s2 = scaled(raw.accel, scale.accel_m_s2);
    s.flags = flags | flag::gyro_valid | flag::accel_valid;
    if (at_end(raw.gyro)) s.flags |= flag::clipped | flag::gyro_clipped;
    if (at_end(raw.accel)) s.flags |= flag::clipped | flag::accel_clipped;
    return s;
}

}  // namespace fairlead::port
