#include "examples/record/writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "host_sim/writers.hpp"

namespace fairlead::record {
namespace {

constexpr std::uint32_t unknown_count = 0xFFFFFFFF;
constexpr std::size_t header_size = 64;
constexpr off_t count_offset = 8;

bool ends_with(const std::string& s, const std::string& end) {
    return s.size() >= end.size() && s.compare(s.size() - end.size(), end.size(), end) == 0;
}

sim::Recording as_recording(const std::string& name, double period_s,
                            const std::vector<Sample>& samples) {
    sim::Recording r;
    r.name = name;
    r.period_s = period_s;
    r.samples = samples;
    return r;
}

}  // namespace

bool Writer::fail(const char* what) {
    error_ = path_ + ": " + what + ": " + std::strerror(errno);
    return false;
}

bool Writer::put(const std::string& bytes, std::size_t from) {
    while (from < bytes.size()) {
        const ssize_t n = ::write(fd_, bytes.data() + from, bytes.size() - from);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return fail("write");
        from += static_cast<std::size_t>(n);
    }
    return true;
}

bool Writer::open(const std::string& path, const std::string& name, double period_s) {
    static_cast<void>(close());
    path_ = path;
    name_ = name;
    period_s_ = period_s;
    count_ = 0;
    binary_ = ends_with(path, ".imu");
    if (!binary_ && !ends_with(path, ".csv")) {
        error_ = path + ": recordings are written as .imu or .csv";
        return false;
    }
    fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (fd_ < 0) return fail("create");
    if (!binary_) return put(sim::to_euroc_imu({}), 0);
    std::string header = sim::to_imu(as_recording(name, period_s, {}));
    std::memcpy(header.data() + count_offset, &unknown_count, sizeof unknown_count);
    return put(header, 0);
}

bool Writer::append(const std::vector<Sample>& samples) {
    if (fd_ < 0) return false;
    if (samples.empty()) return true;
    count_ += static_cast<std::uint32_t>(samples.size());
    // the records as the file format writes them, without the header that is there already
    if (binary_) {
        std::vector<Sample> whole = samples;  // .imu keeps whole microseconds
        for (Sample& s : whole) s.t_ns = (s.t_ns + 500) / 1000 * 1000;
        return put(sim::to_imu(as_recording(name_, period_s_, whole)), header_size);
    }
    const std::string text = sim::to_euroc_imu(samples);
    return put(text, sim::to_euroc_imu({}).size());
}

bool Writer::sync() { return fd_ < 0 || ::fdatasync(fd_) == 0 || fail("sync"); }

bool Writer::close() {
    if (fd_ < 0) return true;
    bool good = sync();
    if (binary_)
        good = ::pwrite(fd_, &count_, sizeof count_, count_offset) == sizeof count_ && good;
    good = sync() && good;
    good = ::close(fd_) == 0 && good;
    fd_ = -1;
    return good;
}

}  // namespace fairlead::record
