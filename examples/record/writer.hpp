#pragma once
// Appends samples to a .imu or EuRoC CSV file so that a cut at any byte, by power or by kill, costs
// at most the record that is being written. A .imu file says 4294967295 records until it is closed
// in peace: readers that salvage take every complete record before the cut. Times are rounded to
// microseconds in .imu, as that format has them; .csv keeps nanoseconds.
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

    /// .imu or .csv by the path's end; refuses to overwrite. False: error() says why.
    bool open(const std::string& path, const std::string& name, double period_s);
    bool append(const std::vector<Sample>& samples);
    /// Down to the disk.
    bool sync();
    bool close();
    const std::string& error() const { return error_; }
    std::uint32_t count() const { return count_; }

  private:
    bool fail(const char* what);
    bool put(const std::string& bytes, std::size_t from);

    int fd_{-1};
    bool binary_{false};
    std::uint32_t count_{0};
    double period_s_{0};
    std::string path_, name_, error_;
};

}  // namespace fairlead::record
