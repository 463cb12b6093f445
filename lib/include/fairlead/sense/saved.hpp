#pragma once
// What a board stores and finds again after the next power-up: a plain struct with its version, its
// size and a CRC-32. Where the bytes are kept is the board's affair.
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "fairlead/base/crc32.hpp"
#include "fairlead/base/status.hpp"

namespace fairlead {

/// T carries `static constexpr std::uint32_t saved_version`, raised whenever its layout changes.
/// Bytes are the machine's own: a saved struct is read back by the kind of core that wrote it.
template <class T>
struct Saved {
    static_assert(std::is_trivially_copyable_v<T>);

    std::uint32_t version{};
    std::uint32_t size{};
    T value{};
    std::uint32_t crc{};
};

namespace detail {

template <class T>
std::uint32_t saved_crc(const Saved<T>& saved) noexcept {
    std::uint32_t crc = crc32(&saved.version, sizeof saved.version);
    crc = crc32(&saved.size, sizeof saved.size, crc);
    return crc32(&saved.value, sizeof saved.value, crc);
}

}  // namespace detail

template <class T>
inline Saved<T> save(const T& value) noexcept {
    Saved<T> out;
    std::memset(static_cast<void*>(&out), 0, sizeof out);  // padding too: equal values, equal bytes
    out.version = T::saved_version;
    out.size = static_cast<std::uint32_t>(sizeof(T));
    std::memcpy(static_cast<void*>(&out.value), &value, sizeof value);
    out.crc = detail::saved_crc(out);
    return out;
}

/// The value, or Status::bad_data for damage and for another version's layout.
template <class T>
inline Result<T> restore(const Saved<T>& saved) noexcept {
    if (saved.version != T::saved_version || saved.size != sizeof(T)) return Status::bad_data;
    if (saved.crc != detail::saved_crc(saved)) return Status::bad_data;
    return saved.value;
}

}  // namespace fairlead
