#pragma once
// When a recording goes on in the next file, and what that file is called: motion.imu is followed
// by motion-0002.imu, motion-0003.imu and so on.
#include <cstdint>
#include <cstdio>
#include <string>

namespace fairlead::record {

struct Rotation {
    double seconds{0};    // of one file; 0: no limit
    double megabytes{0};  // of one file; 0: no limit

    bool is_due(double file_seconds, std::uint64_t file_bytes) const noexcept {
        return (seconds > 0 && file_seconds >= seconds) ||
               (megabytes > 0 && static_cast<double>(file_bytes) >= megabytes * 1e6);
    }
};

/// The n-th file of a recording, from 1.
inline std::string file_name(const std::string& first, unsigned n) {
    if (n <= 1) return first;
    char number[16] = {};
    std::snprintf(number, sizeof number, "-%04u", n);
    const std::size_t slash = first.find_last_of('/');
    const std::size_t dot = first.find_last_of('.');
    const bool has_end = dot != std::string::npos && (slash == std::string::npos || dot > slash);
    const std::size_t at = has_end ? dot : first.size();
    return first.substr(0, at) + number + first.substr(at);
}

}  // namespace fairlead::record
