#pragma once
// The register map of a unit: the only copy. The tables that the gateway serves, the reader of the
// other side, docs/registers.md and every client's configuration come from these rows.
//
// A row is address, name, unit, meaning, and what it shows: a member of UnitState, of ServerState
// or of View. To add a register, add a row (and raise the minor number of map_version); nothing
// else has to be told.
#include <cstdint>
#include <string_view>

#include "examples/gateway/feed.hpp"
#include "port/linux/modbus.hpp"
#include "port/linux/registers.hpp"
#include "port/linux/registers_curve.hpp"

namespace fairlead::gateway {

/// What the health block says of the server; the same for every unit.
struct ServerState {
    std::int64_t started_ns{};
    std::uint32_t clients{};
    std::uint32_t turn_max_us{};
    std::uint32_t log_dropped{};
    const port::ModbusCounters* counters{};
};

/// Everything that a unit's rows can show. The pointers are never null once it is shown.
struct View {
    std::string_view version;
    std::string_view name;
    std::uint16_t id{};
    std::uint16_t source{};
    std::uint32_t epoch{};
    const UnitState* state{};
    const ServerState* server{};
    // made from those at the moment of the request
    std::uint16_t status{};
    std::uint16_t age_ms{};
    std::uint32_t uptime_s{};
    float roll_deg{}, pitch_deg{}, yaw_deg{};
    std::uint32_t orientation_next{}, position_next{}, events_next{};
};

namespace register_map {

using namespace port::registers;

namespace shown {
inline std::uint32_t magic(const View&) noexcept { return port::registers::magic; }
inline std::uint16_t map_version(const View&) noexcept { return port::registers::map_version; }
inline std::uint16_t map_length(const View&) noexcept { return port::registers::map_length; }
inline float probe_f32(const View&) noexcept { return 1; }
inline std::uint32_t probe_u32(const View&) noexcept { return 0x0102'0304; }
inline std::uint64_t probe_u64(const View&) noexcept { return 0x0102'0304'0506'0708; }
inline std::int64_t clock_offset_ns(const View& v) noexcept {
    return v.state->t_ns - v.state->source_ns;
}
inline std::uint16_t history_pages(const View&) noexcept { return port::registers::history_pages; }
inline std::uint16_t spans_per_page(const View&) noexcept {
    return port::registers::spans_per_page;
}
}  // namespace shown

/// A row that shows a member of the unit's state, or of the server's.
template <Type type, auto... Path>
constexpr Row<View> state(std::uint16_t address, const char* name, const char* unit,
                          const char* text) noexcept {
    return row<type, &View::state, Path...>(address, name, unit, text);
}
template <Type type, auto... Path>
constexpr Row<View> server(std::uint16_t address, const char* name, const char* unit,
                           const char* text) noexcept {
    return row<type, &View::server, Path...>(address, name, unit, text);
}
/// The beginning of a channel's first page: its pages are written as such.
constexpr Row<View> page(std::uint16_t address, Type type, const char* name,
                         const char* text) noexcept {
    return {{address, type, name, "", text}, nullptr};
}

inline constexpr auto fields = rows({
    row<Type::u32, shown::magic>(0, "magic", "", "0x464C4431, the letters FLD1"),
    row<Type::u16, shown::map_version>(2, "map_version", "",
                                       "major in the high byte: other layout; minor: added fields"),
    row<Type::u16, shown::map_length>(3, "map_length", "", "number of registers of this unit"),
    row<Type::text, &View::version>(4, "version", "", "version of the program"),
    row<Type::text, &View::name>(12, "unit.name", "", "name from the configuration"),
    row<Type::f32, shown::probe_f32>(20, "probe.f32", "", "1.0: the registers are 3F80 0000"),
    row<Type::u32, shown::probe_u32>(22, "probe.u32", "", "0x01020304"),
    row<Type::u64, shown::probe_u64>(24, "probe.u64", "", "0x0102030405060708"),
    row<Type::u16, &View::id>(28, "unit.id", "", "unit identifier"),
    row<Type::u16, &View::source>(29, "unit.source", "",
                                  "1 replay, 2 serial line, 3 sensor on this machine"),
    row<Type::u32, &View::epoch>(30, "unit.epoch", "",
                                 "another number in every run of the source; never 0"),

    state<Type::u32, &UnitState::sequence>(32, "live.seq_begin", "",
                                           "number of this publication in this run"),
    row<Type::u32, &View::epoch>(34, "live.epoch", "", "as unit.epoch"),
    state<Type::i64, &UnitState::t_ns>(36, "live.t_ns", "ns",
                                       "when the pose was true, on the gateway's monotonic clock"),
    state<Type::f32, &UnitState::q_wb, &Quat::w>(40, "live.q_w", "1",
                                                 "orientation, body to world, scalar part"),
    state<Type::f32, &UnitState::q_wb, &Quat::x>(42, "live.q_x", "1", "orientation, x"),
    state<Type::f32, &UnitState::q_wb, &Quat::y>(44, "live.q_y", "1", "orientation, y"),
    state<Type::f32, &UnitState::q_wb, &Quat::z>(46, "live.q_z", "1", "orientation, z"),
    state<Type::f32, &UnitState::p_w_m, &Vec3::x>(48, "live.p_x", "m", "position in the world, x"),
    state<Type::f32, &UnitState::p_w_m, &Vec3::y>(50, "live.p_y", "m", "position in the world, y"),
    state<Type::f32, &UnitState::p_w_m, &Vec3::z>(52, "live.p_z", "m", "position in the world, z"),
    state<Type::f32, &UnitState::rate_rad_s, &Vec3::x>(54, "live.rate_x", "rad/s",
                                                       "angular rate of the body, x"),
    state<Type::f32, &UnitState::rate_rad_s, &Vec3::y>(56, "live.rate_y", "rad/s",
                                                       "angular rate of the body, y"),
    state<Type::f32, &UnitState::rate_rad_s, &Vec3::z>(58, "live.rate_z", "rad/s",
                                                       "angular rate of the body, z"),
    state<Type::f32, &UnitState::v_w_m_s, &Vec3::x>(60, "live.v_x", "m/s",
                                                    "velocity in the world, x"),
    state<Type::f32, &UnitState::v_w_m_s, &Vec3::y>(62, "live.v_y", "m/s",
                                                    "velocity in the world, y"),
    state<Type::f32, &UnitState::v_w_m_s, &Vec3::z>(64, "live.v_z", "m/s",
                                                    "velocity in the world, z"),
    row<Type::f32, &View::roll_deg>(66, "live.roll_deg", "deg",
                                    "for displays: rotation about x, last"),
    row<Type::f32, &View::pitch_deg>(68, "live.pitch_deg", "deg",
                                     "for displays: rotation about y, second"),
    row<Type::f32, &View::yaw_deg>(70, "live.yaw_deg", "deg",
                                   "for displays: rotation about z, first"),
    row<Type::u16, &View::status>(72, "live.status", "bits", "see the status bits"),
    row<Type::u16, &View::age_ms>(73, "live.age_ms", "ms",
                                  "age of the pose when asked; 65535: that or more"),
    state<Type::u32, &UnitState::sequence>(74, "live.seq_end", "", "equals live.seq_begin"),

    row<Type::u32, &View::orientation_next>(76, "orientation.next", "",
                                            "spans of the orientation curve so far in this run"),
    row<Type::u32, &View::position_next>(78, "position.next", "",
                                         "spans of the position curve so far in this run"),
    row<Type::u32, &View::events_next>(80, "events.next", "", "events so far in this run"),
    state<Type::i64, &UnitState::source_ns>(82, "clock.source_ns", "ns",
                                            "live.t_ns on the source's own clock"),
    row<Type::i64, shown::clock_offset_ns>(86, "clock.offset_ns", "ns",
                                           "gateway's clock minus source's clock"),
    state<Type::u32, &UnitState::clock_error_ns>(
        90, "clock.error_ns", "ns", "bound of the offset's error; 0xFFFFFFFF: none known"),
    state<Type::u32, &UnitState::spans_dropped>(
        92, "history.dropped", "", "spans that were lost inside the gateway: 0 unless stalled"),
    row<Type::u16, shown::history_pages>(94, "history.pages", "", "pages per channel"),
    row<Type::u16, shown::spans_per_page>(95, "history.spans_per_page", "", "spans in a full page"),
    state<Type::u32, &UnitState::publications>(96, "health.publications", "", "poses published"),
    state<Type::u32, &UnitState::samples>(98, "health.samples", "",
                                          "samples taken in (replay, sensor)"),

    state<Type::u32, &UnitState::sample_faults>(100, "health.sample_faults", "",
                                                "samples refused or repaired at the intake"),
    state<Type::u32, &UnitState::gaps>(102, "health.gaps", "", "gaps in the motion"),
    state<Type::u32, &UnitState::bytes>(104, "health.bytes", "", "bytes received from the line"),
    state<Type::u32, &UnitState::frames>(106, "health.frames", "", "good frames received"),
    state<Type::u32, &UnitState::frames_damaged>(
        108, "health.frames_damaged", "", "losses of step: damaged, missing or foreign frames"),
    state<Type::u32, &UnitState::resyncs>(
        110, "health.resyncs", "", "times that the reader came into step by a restart frame"),
    state<Type::u32, &UnitState::opened>(112, "health.source_opened", "",
                                         "times that the line or the sensor was opened"),
    state<Type::u32, &UnitState::lost>(114, "health.source_lost", "", "times that it went away"),
    state<Type::u32, &UnitState::period_us>(116, "health.period_us", "us",
                                            "nominal time from sample to sample"),
    state<Type::u32, &UnitState::publish_us>(118, "health.publish_us", "us",
                                             "arrival to publication, the latest"),
    state<Type::u32, &UnitState::publish_max_us>(120, "health.publish_max_us", "us",
                                                 "arrival to publication, the longest of this run"),
    state<Type::u32, &UnitState::deadline_misses>(
        122, "health.deadline_misses", "", "publications later than two periods after arrival"),
    state<Type::u32, &UnitState::breaks>(
        124, "health.breaks", "", "jumps of a curve, where nothing else keeps the tolerance"),
    state<Type::u32, &UnitState::bytes_skipped>(126, "health.bytes_skipped", "",
                                                "bytes that belong to no frame that was believed"),

    row<Type::u32, &View::uptime_s>(128, "server.uptime_s", "s", "since the program started"),
    server<Type::u32, &ServerState::clients>(130, "server.clients", "", "TCP connections now"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::requests>(
        132, "server.requests", "", "requests answered or refused"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::illegal_function>(
        134, "server.illegal_function", "", "exception 01; every write is among them"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::illegal_address>(
        136, "server.illegal_address", "", "exception 02"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::illegal_value>(
        138, "server.illegal_value", "", "exception 03: wrong quantity or length"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::unknown_unit>(
        140, "server.unknown_unit", "", "exception 0B"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::accepted>(
        142, "server.accepted", "", "connections accepted"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::refused_network>(
        144, "server.refused_network", "", "connections from networks not allowed"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::refused_full>(
        146, "server.refused_full", "", "connections beyond the limits"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::closed_protocol>(
        148, "server.closed_protocol", "", "connections closed: not Modbus"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::closed_deadline>(
        150, "server.closed_deadline", "", "connections closed: frame not finished in time"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::closed_idle>(
        152, "server.closed_idle", "", "connections closed: no request for too long"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::closed_slow_reader>(
        154, "server.closed_slow_reader", "", "connections closed: answers not taken"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::rtu_damaged>(
        156, "server.rtu_damaged", "", "RTU frames with a wrong checksum, cut or overlong"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::rtu_foreign>(
        158, "server.rtu_foreign", "", "RTU frames for other units"),
    server<Type::u32, &ServerState::counters, &port::ModbusCounters::rtu_lost_line>(
        160, "server.rtu_lost_line", "", "times that the RTU line went away"),
    server<Type::u32, &ServerState::turn_max_us>(162, "server.turn_max_us", "us",
                                                 "longest turn of the server's loop"),

    state<Type::u32, &UnitState::events_lost>(164, "events.lost", "",
                                              "events that are missing from this run"),
    state<Type::u32, &UnitState::sensor, &UnitState::Sensor::lost>(
        166, "sensor.lost", "", "samples that the sensor took and nobody read"),
    state<Type::u32, &UnitState::sensor, &UnitState::Sensor::missed_edges>(
        168, "sensor.missed_edges", "", "data-ready edges that were waited for in vain"),
    state<Type::u32, &UnitState::sensor, &UnitState::Sensor::bus_errors>(170, "sensor.bus_errors",
                                                                         "", "failed transfers"),
    state<Type::u32, &UnitState::sensor, &UnitState::Sensor::overruns>(
        172, "sensor.overruns", "", "overruns of the sensor's FIFO"),
    state<Type::u32, &UnitState::sensor, &UnitState::Sensor::resets>(
        174, "sensor.resets", "", "resets of the sensor that nobody ordered"),
    state<Type::u32, &UnitState::sensor, &UnitState::Sensor::clock_jumps>(
        176, "sensor.clock_jumps", "", "edges with times that were not believed"),
    server<Type::u32, &ServerState::log_dropped>(178, "server.log_dropped", "",
                                                 "log lines that nobody took"),

    state<Type::u32, &UnitState::headers_refused>(180, "stream.refused", "",
                                                  "headers of streams of another version or shape"),
    state<Type::u16, &UnitState::stream_id>(182, "stream.id", "",
                                            "the stream that is followed, by its header"),

    state<Type::u16, &UnitState::calibration, &CalibrationState::sensors>(
        183, "calibration.sensors", "bits",
        "1 gyroscope, 2 accelerometer, 4 magnetometer: readings are seen; 0: the source sends "
        "none"),
    state<Type::u16, &UnitState::calibration, &CalibrationState::done>(
        184, "calibration.done", "bits", "the same: calibrated by what follows"),
    state<Type::u16, &UnitState::calibration, &CalibrationState::gyro_percent>(
        185, "calibration.gyro_percent", "%", "of the time that the board must lie still"),
    state<Type::u16, &UnitState::calibration, &CalibrationState::accel_faces>(
        186, "calibration.accel_faces", "bits",
        "faces on which the board has lain: +x, -x, +y, -y, +z, -z up"),
    state<Type::u16, &UnitState::calibration, &CalibrationState::mag_percent>(
        187, "calibration.mag_percent", "%",
        "of the directions through which the board must be turned"),
    state<Type::f32, &UnitState::calibration, &CalibrationState::gyro_offset_rad_s, &Vec3::x>(
        188, "calibration.gyro_offset_x", "rad/s", "truth = reading - offset"),
    state<Type::f32, &UnitState::calibration, &CalibrationState::gyro_offset_rad_s, &Vec3::y>(
        190, "calibration.gyro_offset_y", "rad/s", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::gyro_offset_rad_s, &Vec3::z>(
        192, "calibration.gyro_offset_z", "rad/s", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::offset, &Vec3::x>(
        194, "calibration.accel_offset_x", "m/s2", "truth = matrix * (reading - offset)"),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::offset, &Vec3::y>(
        196, "calibration.accel_offset_y", "m/s2", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::offset, &Vec3::z>(
        198, "calibration.accel_offset_z", "m/s2", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::x,
          &Vec3::x>(200, "calibration.accel_matrix_11", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::x,
          &Vec3::y>(202, "calibration.accel_matrix_12", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::x,
          &Vec3::z>(204, "calibration.accel_matrix_13", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::y,
          &Vec3::x>(206, "calibration.accel_matrix_21", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::y,
          &Vec3::y>(208, "calibration.accel_matrix_22", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::y,
          &Vec3::z>(210, "calibration.accel_matrix_23", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::z,
          &Vec3::x>(212, "calibration.accel_matrix_31", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::z,
          &Vec3::y>(214, "calibration.accel_matrix_32", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::accel, &Affine::matrix, &Mat3::z,
          &Vec3::z>(216, "calibration.accel_matrix_33", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::offset, &Vec3::x>(
        218, "calibration.mag_offset_x", "uT", "truth = matrix * (reading - offset)"),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::offset, &Vec3::y>(
        220, "calibration.mag_offset_y", "uT", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::offset, &Vec3::z>(
        222, "calibration.mag_offset_z", "uT", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::x,
          &Vec3::x>(224, "calibration.mag_matrix_11", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::x,
          &Vec3::y>(226, "calibration.mag_matrix_12", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::x,
          &Vec3::z>(228, "calibration.mag_matrix_13", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::y,
          &Vec3::x>(230, "calibration.mag_matrix_21", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::y,
          &Vec3::y>(232, "calibration.mag_matrix_22", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::y,
          &Vec3::z>(234, "calibration.mag_matrix_23", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::z,
          &Vec3::x>(236, "calibration.mag_matrix_31", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::z,
          &Vec3::y>(238, "calibration.mag_matrix_32", "1", ""),
    state<Type::f32, &UnitState::calibration, &CalibrationState::mag, &Affine::matrix, &Mat3::z,
          &Vec3::z>(240, "calibration.mag_matrix_33", "1", ""),

    page(256, Type::u32, "events.epoch", "first event page (4 pages of 125): header as in history"),
    page(258, Type::u32, "events.first", "number of the page's first event"),
    page(260, Type::u16, "events.count", "events in this page, at most 19"),
    page(1000, Type::u32, "orientation.epoch", "first orientation page (128 pages of 125)"),
    page(1002, Type::u32, "orientation.first", "number of the page's first span"),
    page(1004, Type::u16, "orientation.count", "spans in this page, at most 3"),
    page(17000, Type::u32, "position.epoch", "first position page (128 pages of 125)"),
    page(17002, Type::u32, "position.first", "number of the page's first span"),
    page(17004, Type::u16, "position.count", "spans in this page, at most 3"),
});

inline constexpr auto event_fields = rows({
    row<Type::i64, &FeedEvent::t_ns>(0, "t_ns", "ns", "when it happened, on the source's clock"),
    row<Type::u16, &FeedEvent::channel>(4, "channel", "", "which button, trigger or contact"),
    row<Type::u16, &FeedEvent::value>(5, "value", "", "its new value"),
});

static_assert(in_order(fields, map_length));
static_assert(in_order(event_fields, event_size));

constexpr const Field& field(std::string_view name) noexcept { return find(fields, name); }
static_assert(field("live.seq_begin").address == live_begin);
static_assert(field("live.seq_end").address + 2 == live_begin + live_size);
static_assert(field("history.spans_per_page").address + 1 == live_begin + state_size);
static_assert(field("events.epoch").address == events_begin);
static_assert(field("orientation.epoch").address == orientation_begin);
static_assert(field("position.epoch").address == position_begin);

}  // namespace register_map
}  // namespace fairlead::gateway
