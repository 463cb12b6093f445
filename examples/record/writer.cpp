#include "examples/record/writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "host_sim/recording/imu2.hpp"
#include "host_sim/recording/writers.hpp"

namespace fairlead::record {
namespace {

bool ends_with(const std::string& s, const std::string& end) {
    return s.size() >= end.size() && s.compare(s.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

bool Writer::fail(const char* what) {
    error_ = path_ + ": " + what + ": " + std::strerror(errno);
    return false;
}

bool Writer::put(const std::string& bytes) {
    std::size_t from = 0;
    while (from < bytes.size()) {
        const ssize_t n = ::write(fd_, bytes.data() + from, bytes.size() - from);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return fail("write");
        from += static_cast<std::size_t>(n);
        bytes_ += static_cast<std::uint64_t>(n);
    }
    return true;
}

bool Writer::open(const std::string& path, const std::string& name, double period_s,
                  std::uint32_t fields) {
    static_cast<void>(close());
    path_ = path;
    fields_ = fields;
    count_ = 0;
    bytes_ = 0;
    binary_ = ends_with(path, ".imu");
    if (!binary_ && !ends_with(path, ".csv")) {
        error_ = path + ": recordings are written as .imu or .csv";
        return false;
    }
    fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (fd_ < 0) return fail("create");
    if (!binary_) return put(sim::imu_csv_header(fields));
    sim::Imu2Header header;  // its count stays open until the recording is closed
    header.name = name;
    header.fields = fields;
    header.rate_hz = period_s > 0 ? 1 / period_s : 0;
    return put(sim::imu2_header(header));
}

bool Writer::append(const std::vector<Sample>& samples) {
    if (fd_ < 0) return false;
    std::string bytes;
    for (const Sample& s : samples) {
        if (binary_)
            sim::append_imu2(bytes, fields_, s);
        else
            sim::append_imu_csv(bytes, fields_, s);
    }
    count_ += samples.size();
    return put(bytes);
}

bool Writer::sync() { return fd_ < 0 || ::fdatasync(fd_) == 0 || fail("sync"); }

bool Writer::close() {
    if (fd_ < 0) return true;
    bool good = sync();
    if (binary_)
        good =
            ::pwrite(fd_, &count_, sizeof count_, sim::Imu2Header::count_offset) == sizeof count_ &&
            good;
    good = sync() && good;
    good = ::close(fd_) == 0 && good;
    fd_ = -1;
    return good;
}

}  // namespace fairlead::record
