#pragma once
// Appends samples to a .imu (version 2) or .csv file so that a cut at any byte, by power or by
// kill, costs at most the record that is being written. Both keep nanoseconds, the validity of each
// sensor, temperature, gaps and clipped readings. The header of a .imu says "up to the end of the
// file" until it is closed in peace.
#include <cstdint>
#include <string>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::record {

class Writer {
  public:
    Writer() = default;
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    ~Writer() { static_cast<void>(close()); }

    /// .imu or .csv by the path's end; refuses to overwrite. `fields`: the sensors of the device,
    /// as bits of sim::imu_field; others are not written. False: error() says why.
    bool open(const std::string& path, const std::string& name, double period_s,
              std::uint32_t fields);
    bool append(const std::vector<Sample>& samples);
    /// Down to the disk.
    bool sync();
    bool close();
    const std::string& error() const { return error_; }
    std::uint64_t count() const { return count_; }
    /// Of the file so far.
    std::uint64_t bytes() const { return bytes_; }

  private:
    bool fail(const char* what);
    bool put(const std::string& bytes);

    int fd_{-1};
    bool binary_{false};
    std::uint32_t fields_{0};
    std::uint64_t count_{0};
    std::uint64_t bytes_{0};
    std::string path_, error_;
};

}  // namespace fairlead::record
