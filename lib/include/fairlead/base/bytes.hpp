#pragma once
// What a stage gives to the wire: whole frames, and what became of the record that was pushed.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"

namespace fairlead {

/// Bytes of complete frames, possibly none. The memory belongs to the stage and holds until its
/// next call. status says what became of the input of this call; it never depends on the bytes.
struct Bytes {
    const std::uint8_t* data{nullptr};
    std::size_t size{0};
    Status status{Status::ok};

    constexpr bool empty() const noexcept { return size == 0; }
    constexpr const std::uint8_t* begin() const noexcept { return data; }
    constexpr const std::uint8_t* end() const noexcept { return data + size; }
};

}  // namespace fairlead
