#pragma once
// What a source's thread hands to the server's thread, without either ever waiting for the other.
#include <cstdint>

#include "fairlead/base/types.hpp"
#include "fairlead/sense/calibrate.hpp"
#include "port/linux/handover.hpp"
#include "port/linux/registers_curve.hpp"

namespace fairlead::gateway {

enum class SourceKind : std::uint16_t { replay = 1, serial = 2, sensor = 3 };

/// Bits of CalibrationState::sensors and done.
namespace calibration_bit {
inline constexpr std::uint16_t gyro = 1, accel = 2, mag = 4;
}

/// How far the calibration of a unit's sensors has come (calibration_watch.hpp).
struct CalibrationState {
    std::uint16_t sensors{};  // whose readings are seen; 0: the source sends none
    std::uint16_t done{};     // what was found is below
    std::uint16_t gyro_percent{}, mag_percent{};
    std::uint16_t accel_faces{};  // bit i: face i is complete, +x, -x, +y, -y, +z, -z up
    Vec3 gyro_offset_rad_s{};
    Affine accel{}, mag{};
};

/// Everything that a source knows about itself, and the newest pose. One copy, published whole.
struct UnitState {
    std::uint32_t epoch{};      // of the run that it belongs to
    std::uint32_t sequence{};   // of the pose; 0: none yet
    std::int64_t t_ns{};        // when it was true, gateway's clock
    std::int64_t source_ns{};   // the same, source's clock
    std::int64_t arrival_ns{};  // when its bytes or samples arrived, gateway's clock
    Quat q_wb{};
    Vec3 p_w_m{};
    Vec3 rate_rad_s{};
    Vec3 v_w_m_s{};
    std::uint16_t status{};  // port::registers::status_bit
    std::uint32_t clock_error_ns{0xFFFF'FFFF};
    std::uint32_t period_us{};

    // health: since this run began
    std::uint32_t publications{};
    std::uint32_t samples{};
    std::uint32_t sample_faults{};
    std::uint32_t gaps{};
    std::uint32_t bytes{};
    std::uint32_t frames{};
    std::uint32_t frames_damaged{};
    std::uint32_t breaks{};
    std::uint32_t headers_refused{};
    std::uint16_t stream_id{};
    std::uint32_t bytes_skipped{};
    std::uint32_t resyncs{};
    std::uint32_t opened{};
    std::uint32_t lost{};
    std::uint32_t publish_us{};
    std::uint32_t publish_max_us{};
    std::uint32_t deadline_misses{};
    std::uint32_t spans_dropped{};
    struct Sensor {
        std::uint32_t lost{}, missed_edges{}, bus_errors{}, overruns{}, resets{}, clock_jumps{};
    } sensor;  // on this machine
    std::uint32_t events_dropped{};
    std::uint32_t events_lost{};  // those among them
    CalibrationState calibration{};
};

enum class SpanKind : std::uint8_t {
    append,
    restart,  // a new run begins: only `epoch` counts
};
struct SpanItem {
    port::CurveSpan span{};
    SpanKind kind{};
    std::uint32_t epoch{};
};

struct FeedEvent {
    std::int64_t t_ns{};
    std::uint16_t channel{};
    std::uint16_t value{};
};

/// One unit's link from its source to the server.
struct UnitFeed {
    port::TripleBuffer<UnitState> state;
    port::Queue<SpanItem, 1024> spans;  // some frames
    port::Queue<FeedEvent, 64> events;
};

}  // namespace fairlead::gateway
