#pragma once
// The register map: the only copy. The tables that the gateway serves, the reader of the other
// side, docs/registers.md and every client's configuration come from these rows.
//
// Every unit has the same map. Words are big-endian and in order (ABCD), addresses count from 0,
// functions 3 and 4 read the same registers. One request is answered from one moment: what stands
// within 125 registers is never torn. The live block is 44 registers, history comes in pages of
// 125, each of which says by itself to which run and where in the curve it belongs.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "fairlead/base/status.hpp"

namespace fairlead::port::registers {

enum class Type : std::uint8_t { u16, u32, u64, i64, f32, text };

/// Registers that a field takes; a text's is in its row.
constexpr std::uint16_t width_of(Type type) noexcept {
    switch (type) {
        case Type::u16: return 1;
        case Type::u32:
        case Type::f32: return 2;
        case Type::u64:
        case Type::i64: return 4;
        case Type::text: return 8;  // 16 characters, padded with NUL
    }
    return 0;
}

struct Field {
    std::uint16_t address;
    Type type;
    const char* name;
    const char* unit;
    const char* text;
};

/// As many rows as are listed.
template <std::size_t N>
constexpr std::array<Field, N> rows(const Field (&list)[N]) noexcept {
    std::array<Field, N> out{};
    for (std::size_t i = 0; i < N; ++i) out[i] = list[i];
    return out;
}

inline constexpr std::uint32_t magic = 0x464C'4431;   // "FLD1"
inline constexpr std::uint16_t map_version = 0x0101;  // major, minor

inline constexpr std::uint16_t page_size = 125;  // one request
inline constexpr std::uint16_t page_header = 8;  // registers before a page's records
inline constexpr std::uint16_t span_size = 39;   // registers
inline constexpr std::uint16_t spans_per_page = 3;
inline constexpr std::uint16_t history_pages = 128;  // per channel
inline constexpr std::uint16_t event_size = 6;
inline constexpr std::uint16_t events_per_page = 19;
inline constexpr std::uint16_t event_pages = 4;

inline constexpr std::uint16_t live_begin = 32;
inline constexpr std::uint16_t live_size = 44;
inline constexpr std::uint16_t state_size = 64;  // the live and the stream block in one request
inline constexpr std::uint16_t events_begin = 256;
inline constexpr std::uint16_t orientation_begin = 1000;
inline constexpr std::uint16_t position_begin = orientation_begin + history_pages * page_size;
inline constexpr std::uint16_t map_length = position_begin + history_pages * page_size;

/// Bits of live.status.
namespace status_bit {
enum : std::uint16_t {
    valid_orientation = 1u << 0,
    valid_position = 1u << 1,
    stale = 1u << 2,    // nothing new for longer than the unit's stale time
    no_data = 1u << 3,  // nothing at all since this run began
    gap = 1u << 4,      // the newest span began after a gap
    rest = 1u << 5,
    settling = 1u << 6,
    mag_rejected = 1u << 7,
    clipped = 1u << 8,
    source_lost = 1u << 9,   // the line, the sensor or the file is not there
    out_of_step = 1u << 10,  // waiting for the stream's next self-contained frame
    finished = 1u << 11,     // a replay came to its end
};
}  // namespace status_bit

inline constexpr auto fields = rows({
    {0, Type::u32, "magic", "", "0x464C4431, the letters FLD1"},
    {2, Type::u16, "map_version", "", "major in the high byte: other layout; minor: added fields"},
    {3, Type::u16, "map_length", "", "number of registers of this unit"},
    {4, Type::text, "version", "", "version of the program"},
    {12, Type::text, "unit.name", "", "name from the configuration"},
    {20, Type::f32, "probe.f32", "", "1.0: the registers are 3F80 0000"},
    {22, Type::u32, "probe.u32", "", "0x01020304"},
    {24, Type::u64, "probe.u64", "", "0x0102030405060708"},
    {28, Type::u16, "unit.id", "", "unit identifier"},
    {29, Type::u16, "unit.source", "", "1 replay, 2 serial line, 3 sensor on this machine"},
    {30, Type::u32, "unit.epoch", "", "another number in every run of the source; never 0"},

    {32, Type::u32, "live.seq_begin", "", "number of this publication in this run"},
    {34, Type::u32, "live.epoch", "", "as unit.epoch"},
    {36, Type::i64, "live.t_ns", "ns", "when the pose was true, on the gateway's monotonic clock"},
    {40, Type::f32, "live.q_w", "1", "orientation, body to world, scalar part"},
    {42, Type::f32, "live.q_x", "1", "orientation, x"},
    {44, Type::f32, "live.q_y", "1", "orientation, y"},
    {46, Type::f32, "live.q_z", "1", "orientation, z"},
    {48, Type::f32, "live.p_x", "m", "position in the world, x"},
    {50, Type::f32, "live.p_y", "m", "position in the world, y"},
    {52, Type::f32, "live.p_z", "m", "position in the world, z"},
    {54, Type::f32, "live.rate_x", "rad/s", "angular rate of the body, x"},
    {56, Type::f32, "live.rate_y", "rad/s", "angular rate of the body, y"},
    {58, Type::f32, "live.rate_z", "rad/s", "angular rate of the body, z"},
    {60, Type::f32, "live.v_x", "m/s", "velocity in the world, x"},
    {62, Type::f32, "live.v_y", "m/s", "velocity in the world, y"},
    {64, Type::f32, "live.v_z", "m/s", "velocity in the world, z"},
    {66, Type::f32, "live.roll_deg", "deg", "for displays: rotation about x, last"},
    {68, Type::f32, "live.pitch_deg", "deg", "for displays: rotation about y, second"},
    {70, Type::f32, "live.yaw_deg", "deg", "for displays: rotation about z, first"},
    {72, Type::u16, "live.status", "bits", "see the status bits"},
    {73, Type::u16, "live.age_ms", "ms", "age of the pose when asked; 65535: that or more"},
    {74, Type::u32, "live.seq_end", "", "equals live.seq_begin"},

    {76, Type::u32, "orientation.next", "", "spans of the orientation curve so far in this run"},
    {78, Type::u32, "position.next", "", "spans of the position curve so far in this run"},
    {80, Type::u32, "events.next", "", "events so far in this run"},
    {82, Type::i64, "clock.source_ns", "ns", "live.t_ns on the source's own clock"},
    {86, Type::i64, "clock.offset_ns", "ns", "gateway's clock minus source's clock"},
    {90, Type::u32, "clock.error_ns", "ns", "bound of the offset's error; 0xFFFFFFFF: none known"},
    {92, Type::u32, "history.dropped", "",
     "spans that were lost inside the gateway: 0 unless stalled"},
    {94, Type::u16, "history.pages", "", "pages per channel"},
    {95, Type::u16, "history.spans_per_page", "", "spans in a full page"},

    {96, Type::u32, "health.publications", "", "poses published"},
    {98, Type::u32, "health.samples", "", "samples taken in (replay, sensor)"},
    {100, Type::u32, "health.sample_faults", "", "samples refused or repaired at the intake"},
    {102, Type::u32, "health.gaps", "", "gaps in the motion"},
    {104, Type::u32, "health.bytes", "", "bytes received from the line"},
    {106, Type::u32, "health.frames", "", "good frames received"},
    {108, Type::u32, "health.frames_damaged", "",
     "losses of step: a frame with a wrong checksum or nonsense"},
    {110, Type::u32, "health.resyncs", "", "times that a curve was back in step"},
    {112, Type::u32, "health.source_opened", "", "times that the line or the sensor was opened"},
    {114, Type::u32, "health.source_lost", "", "times that it went away"},
    {116, Type::u32, "health.period_us", "us", "nominal time from sample to sample"},
    {118, Type::u32, "health.publish_us", "us", "arrival to publication, the latest"},
    {120, Type::u32, "health.publish_max_us", "us",
     "arrival to publication, the longest of this run"},
    {122, Type::u32, "health.deadline_misses", "",
     "publications later than two periods after arrival"},
    {124, Type::u32, "health.frames_lost", "", "frames missing by the stream's sequence numbers"},
    {126, Type::u32, "health.bytes_skipped", "", "bytes passed over while out of step"},

    {128, Type::u32, "server.uptime_s", "s", "since the program started"},
    {130, Type::u32, "server.clients", "", "TCP connections now"},
    {132, Type::u32, "server.requests", "", "requests answered or refused"},
    {134, Type::u32, "server.illegal_function", "", "exception 01; every write is among them"},
    {136, Type::u32, "server.illegal_address", "", "exception 02"},
    {138, Type::u32, "server.illegal_value", "", "exception 03: wrong quantity or length"},
    {140, Type::u32, "server.unknown_unit", "", "exception 0B"},
    {142, Type::u32, "server.accepted", "", "connections accepted"},
    {144, Type::u32, "server.refused_network", "", "connections from networks not allowed"},
    {146, Type::u32, "server.refused_full", "", "connections beyond the limits"},
    {148, Type::u32, "server.closed_protocol", "", "connections closed: not Modbus"},
    {150, Type::u32, "server.closed_deadline", "",
     "connections closed: frame not finished in time"},
    {152, Type::u32, "server.closed_idle", "", "connections closed: no request for too long"},
    {154, Type::u32, "server.closed_slow_reader", "", "connections closed: answers not taken"},
    {156, Type::u32, "server.rtu_damaged", "", "RTU frames with a wrong checksum, cut or overlong"},
    {158, Type::u32, "server.rtu_foreign", "", "RTU frames for other units"},
    {160, Type::u32, "server.rtu_lost_line", "", "times that the RTU line went away"},
    {162, Type::u32, "server.turn_max_us", "us", "longest turn of the server's loop"},
    {164, Type::u32, "events.lost", "", "events that are missing from this run"},
    {166, Type::u32, "sensor.lost", "", "samples that the sensor took and nobody read"},
    {168, Type::u32, "sensor.missed_edges", "", "data-ready edges that were waited for in vain"},
    {170, Type::u32, "sensor.bus_errors", "", "failed transfers"},
    {172, Type::u32, "sensor.overruns", "", "overruns of the sensor's FIFO"},
    {174, Type::u32, "sensor.resets", "", "resets of the sensor that nobody ordered"},
    {176, Type::u32, "sensor.clock_jumps", "", "edges with times that were not believed"},

    {256, Type::u32, "events.epoch", "", "first event page (4 pages of 125): header as in history"},
    {258, Type::u32, "events.first", "", "number of the page's first event"},
    {260, Type::u16, "events.count", "", "events in this page, at most 19"},
    {1000, Type::u32, "orientation.epoch", "", "first orientation page (128 pages of 125)"},
    {1002, Type::u32, "orientation.first", "", "number of the page's first span"},
    {1004, Type::u16, "orientation.count", "", "spans in this page, at most 3"},
    {17000, Type::u32, "position.epoch", "", "first position page (128 pages of 125)"},
    {17002, Type::u32, "position.first", "", "number of the page's first span"},
    {17004, Type::u16, "position.count", "", "spans in this page, at most 3"},
});

// ---- pages: a header, then records. Page k of a channel stands at its begin + 125 k, and span n
// in page (n / 3) mod 128. A page is read in one request and says itself where it belongs.
inline constexpr auto page_fields = rows({
    {0, Type::u32, "epoch", "", "as unit.epoch; 0: the page was never written"},
    {2, Type::u32, "first", "", "number of its first record, a multiple of the records per page"},
    {4, Type::u16, "count", "", "records in it; fewer than full: the newest page"},
    {5, Type::u16, "channel", "", "0 orientation, 1 position, 2 events"},
    {6, Type::u32, "tick_ns", "ns", "unit of time of the polynomials"},
});

/// With u = (t - t0_ns) / tick_ns and y = c0 + c1 u + c2 u^2 + c3 u^3:
/// position: x y z of y; orientation: y at unit length.
inline constexpr auto span_fields = rows({
    {0, Type::i64, "t0_ns", "ns", "its knot, on the source's clock"},
    {4, Type::u32, "cover_ticks", "",
     "valid for 0 <= u < cover_ticks; grows while it is the newest"},
    {6, Type::f32, "c0_w", "m or 1", "value at the knot; 0 for a position"},
    {8, Type::f32, "c0_x", "m or 1", ""},
    {10, Type::f32, "c0_y", "m or 1", ""},
    {12, Type::f32, "c0_z", "m or 1", ""},
    {14, Type::f32, "c1_w", "per tick", "first Taylor coefficient; 0 for a position"},
    {16, Type::f32, "c1_x", "per tick", ""},
    {18, Type::f32, "c1_y", "per tick", ""},
    {20, Type::f32, "c1_z", "per tick", ""},
    {22, Type::f32, "c2_w", "per tick^2", "second Taylor coefficient; 0 for a position"},
    {24, Type::f32, "c2_x", "per tick^2", ""},
    {26, Type::f32, "c2_y", "per tick^2", ""},
    {28, Type::f32, "c2_z", "per tick^2", ""},
    {30, Type::f32, "c3_w", "per tick^3", "third Taylor coefficient; 0 for a position"},
    {32, Type::f32, "c3_x", "per tick^3", ""},
    {34, Type::f32, "c3_y", "per tick^3", ""},
    {36, Type::f32, "c3_z", "per tick^3", ""},
    {38, Type::u16, "flags", "bits", "1: joins no span before it"},
});

inline constexpr auto event_fields = rows({
    {0, Type::i64, "t_ns", "ns", "when it happened, on the source's clock"},
    {4, Type::u16, "channel", "", "which button, trigger or contact"},
    {5, Type::u16, "value", "", "its new value"},
});

// ---- the rows hold together
template <std::size_t N>
constexpr bool in_order(const std::array<Field, N>& rows, std::uint32_t size) noexcept {
    std::uint32_t next = 0;
    for (const Field& row : rows) {
        if (row.address < next) return false;
        next = row.address + std::uint32_t{width_of(row.type)};
    }
    return next <= size;
}
static_assert(in_order(fields, map_length));
static_assert(in_order(page_fields, page_header));
static_assert(in_order(span_fields, span_size) && in_order(event_fields, event_size));
static_assert(page_header + spans_per_page * span_size == page_size);
static_assert(page_header + events_per_page * event_size <= page_size);
static_assert(events_begin + event_pages * page_size <= orientation_begin);

/// The row of that name. A name that does not exist does not compile where the result is constexpr.
constexpr const Field& field(std::string_view name) noexcept {
    for (const Field& row : fields) {
        if (name == row.name) return row;
    }
    __builtin_trap();
}
static_assert(field("live.seq_begin").address == live_begin);
static_assert(field("live.seq_end").address + 2 == live_begin + live_size);
static_assert(field("history.spans_per_page").address + 1 == live_begin + state_size);
static_assert(field("events.epoch").address == events_begin);
static_assert(field("orientation.epoch").address == orientation_begin);
static_assert(field("position.epoch").address == position_begin);

// ---- words. Packed here, because what libmodbus's float helpers write depends on its version.
constexpr void put(std::uint16_t* at, std::uint64_t value, unsigned width) noexcept {
    for (unsigned i = width; i-- > 0; value >>= 16) at[i] = static_cast<std::uint16_t>(value);
}
constexpr std::uint64_t get(const std::uint16_t* at, unsigned width) noexcept {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < width; ++i) value = value << 16 | at[i];
    return value;
}

/// Writes values into consecutive rows. A value of another type than its row's is a mistake in the
/// program: asserted.
class Writer {
  public:
    template <std::size_t N>
    Writer(std::uint16_t* table, const std::array<Field, N>& rows, const char* from) noexcept
        : table_{table}, row_{rows.data()}, end_{rows.data() + N} {
        while (row_ != end_ && std::string_view{row_->name} != from) ++row_;
    }
    template <std::size_t N>
    Writer(std::uint16_t* table, const std::array<Field, N>& rows) noexcept
        : table_{table}, row_{rows.data()}, end_{rows.data() + N} {}

    Writer& u16(std::uint64_t v) noexcept { return word(Type::u16, v & 0xFFFF); }
    Writer& u32(std::uint64_t v) noexcept { return word(Type::u32, v & 0xFFFF'FFFF); }
    Writer& u64(std::uint64_t v) noexcept { return word(Type::u64, v); }
    Writer& i64(std::int64_t v) noexcept { return word(Type::i64, static_cast<std::uint64_t>(v)); }
    Writer& f32(float v) noexcept {
        std::uint32_t bits = 0;
        std::memcpy(&bits, &v, sizeof bits);
        return word(Type::f32, bits);
    }
    Writer& text(std::string_view v) noexcept {
        FAIRLEAD_ASSERT(row_ != end_ && row_->type == Type::text);
        for (std::size_t i = 0; i < width_of(Type::text); ++i) {
            const auto letter = [&](std::size_t k) {
                return k < v.size() ? static_cast<unsigned char>(v[k]) : 0u;
            };
            table_[row_->address + i] =
                static_cast<std::uint16_t>(letter(2 * i) << 8 | letter(2 * i + 1));
        }
        ++row_;
        return *this;
    }

  private:
    Writer& word(Type type, std::uint64_t v) noexcept {
        FAIRLEAD_ASSERT(row_ != end_ && row_->type == type);
        put(table_ + row_->address, v, width_of(type));
        ++row_;
        return *this;
    }

    std::uint16_t* table_;
    const Field* row_;
    const Field* end_;
};

/// Reads one field; `table` is register 0 of the map, or of the record that the row describes.
inline std::uint64_t get_word(const std::uint16_t* table, const Field& row) noexcept {
    return get(table + row.address, width_of(row.type));
}
inline float get_f32(const std::uint16_t* at) noexcept {
    const auto bits = static_cast<std::uint32_t>(get(at, 2));
    float v = 0;
    std::memcpy(&v, &bits, sizeof v);
    return v;
}

}  // namespace fairlead::port::registers
