#pragma once
// How values stand in registers, and what a table of them is made of. The gateway's map itself is
// examples/gateway/register_map.hpp; pages of the curve are registers_curve.hpp.
//
// Every unit has the same map. Words are big-endian and in order (ABCD), addresses count from 0,
// functions 3 and 4 read the same registers. One request is answered from one moment: what stands
// within 125 registers is never torn. The live block is 44 registers, history comes in pages of
// 125, each of which says by itself to which run and where in the curve it belongs.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string_view>
#include <type_traits>

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

// ---- words. Packed here, because what libmodbus's float helpers write depends on its version.
constexpr void put(std::uint16_t* at, std::uint64_t value, unsigned width) noexcept {
    for (unsigned i = width; i-- > 0; value >>= 16) at[i] = static_cast<std::uint16_t>(value);
}
constexpr std::uint64_t get(const std::uint16_t* at, unsigned width) noexcept {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < width; ++i) value = value << 16 | at[i];
    return value;
}

/// One row of a table of registers that a Record is written into. The row names the member, or the
/// function of the Record, that it shows: there is no order that two places must agree on.
template <class Record>
struct Row : Field {
    void (*put)(const Record&, std::uint16_t* at);  // null: shown in the map, written elsewhere
};

namespace detail {

template <class T>
struct RecordOf;
template <class Value, class Record>
struct RecordOf<Value Record::*> {
    using type = Record;
};
template <class Value, class Record>
struct RecordOf<Value (*)(const Record&)> {
    using type = Record;
};
template <class Value, class Record>
struct RecordOf<Value (*)(const Record&) noexcept> {
    using type = Record;
};

/// The value at the end of a path of members and functions.
template <auto First, auto... Rest, class Record>
decltype(auto) follow(const Record& record) noexcept {
    if constexpr (sizeof...(Rest) == 0)
        return std::invoke(First, record);
    else
        return follow<Rest...>(std::invoke(First, record));
}

inline void put_text(std::string_view text, std::uint16_t* at) noexcept {
    const auto letter = [&](std::size_t k) {
        return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u;
    };
    for (std::size_t i = 0; i < width_of(Type::text); ++i)
        at[i] = static_cast<std::uint16_t>(letter(2 * i) << 8 | letter(2 * i + 1));
}

/// Counters of 64 bits are shown with their lower 32 where the row says u32.
template <Type type, class Record, auto... Path>
void put_value(const Record& record, std::uint16_t* at) noexcept {
    using Value = std::decay_t<decltype(follow<Path...>(record))>;
    static_assert((type == Type::text) == std::is_same_v<Value, std::string_view>);
    static_assert((type == Type::f32) == std::is_same_v<Value, float>);
    static_assert((type == Type::i64) == std::is_same_v<Value, std::int64_t>);
    static_assert(type != Type::u16 || std::is_same_v<Value, std::uint16_t>);
    if constexpr (type == Type::text) {
        put_text(follow<Path...>(record), at);
    } else if constexpr (type == Type::f32) {
        const float value = follow<Path...>(record);
        std::uint32_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        put(at, bits, 2);
    } else {
        put(at, static_cast<std::uint64_t>(follow<Path...>(record)), width_of(type));
    }
}

}  // namespace detail

/// A row that shows what the path First, Rest... leads to.
template <Type type, auto First, auto... Rest>
constexpr auto row(std::uint16_t address, const char* name, const char* unit,
                   const char* text) noexcept {
    using Record = typename detail::RecordOf<decltype(First)>::type;
    return Row<Record>{{address, type, name, unit, text},
                       detail::put_value<type, Record, First, Rest...>};
}

/// As many rows as are listed.
template <class Record, std::size_t N>
constexpr std::array<Row<Record>, N> rows(const Row<Record> (&list)[N]) noexcept {
    std::array<Row<Record>, N> out{};
    for (std::size_t i = 0; i < N; ++i) out[i] = list[i];
    return out;
}

/// Writes every row into its place; `table` is register 0 of the map or of the record.
template <class Record, std::size_t N>
void put_rows(const std::array<Row<Record>, N>& rows, const Record& record,
              std::uint16_t* table) noexcept {
    for (const Row<Record>& row : rows)
        if (row.put != nullptr) row.put(record, table + row.address);
}

/// The rows hold together: addresses rise, and nothing overlaps.
template <class Record, std::size_t N>
constexpr bool in_order(const std::array<Row<Record>, N>& rows, std::uint32_t size) noexcept {
    std::uint32_t next = 0;
    for (const Field& row : rows) {
        if (row.address < next) return false;
        next = row.address + std::uint32_t{width_of(row.type)};
    }
    return next <= size;
}

/// The row of that name. A name that does not exist does not compile where the result is constexpr.
template <class Record, std::size_t N>
constexpr const Field& find(const std::array<Row<Record>, N>& rows,
                            std::string_view name) noexcept {
    for (const Field& row : rows)
        if (name == row.name) return row;
    __builtin_trap();
}

inline constexpr std::uint32_t magic = 0x464C'4431;   // "FLD1"
inline constexpr std::uint16_t map_version = 0x0201;  // major, minor

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

static_assert(page_header + spans_per_page * span_size == page_size);
static_assert(page_header + events_per_page * event_size <= page_size);
static_assert(events_begin + event_pages * page_size <= orientation_begin);

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
