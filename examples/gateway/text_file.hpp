#pragma once
// A small text file, read in a way that cannot hang or exhaust the program: a regular file only, no
// pipe and no device, up to a size.
#include <cstddef>
#include <string>

namespace fairlead::gateway {

/// False: `why` says what is wrong, without the path.
bool read_small_file(const std::string& path, std::size_t size_max, std::string& text,
                     std::string& why);

/// True when the path names a regular file, which a reader cannot be made to wait for.
bool is_regular_file(const std::string& path) noexcept;

}  // namespace fairlead::gateway
