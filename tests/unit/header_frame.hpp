#pragma once
// A header frame as its bytes, for tests that hold a header of their own.
#include <cstddef>
#include <cstdint>

#include "fairlead/wire/header.hpp"

namespace fairlead::wire {

/// Writes the header frame to `out`, header_frame_max bytes, and sets its digest. @return its size.
inline std::size_t write_header(Header& header, std::uint8_t* out) noexcept {
    HeaderWriter<header_frame_max> writer;
    writer.begin(header.shape);
    header.digest = writer.digest();
    return writer.write(header.end, header.starts, out);
}

}  // namespace fairlead::wire
