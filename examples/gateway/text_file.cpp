#include "examples/gateway/text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace fairlead::gateway {

bool read_small_file(const std::string& path, std::size_t size_max, std::string& text,
                     std::string& why) {
    // O_NONBLOCK: a pipe without a writer must not hold the program
    const int fd = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd < 0) {
        why = std::string{"cannot be read: "} + std::strerror(errno);
        return false;
    }
    struct stat info {};
    bool good = fstat(fd, &info) == 0;
    if (!good) {
        why = std::string{"cannot be read: "} + std::strerror(errno);
    } else if (!S_ISREG(info.st_mode)) {
        why = "is not a regular file";
        good = false;
    }
    text.clear();
    while (good) {
        char part[4096];
        const ssize_t got = ::read(fd, part, sizeof part);
        if (got == 0) break;
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            why = std::string{"cannot be read: "} + std::strerror(errno);
            good = false;
        } else if (text.size() + static_cast<std::size_t>(got) > size_max) {
            why = "is longer than " + std::to_string(size_max) + " bytes";
            good = false;
        } else {
            text.append(part, static_cast<std::size_t>(got));
        }
    }
    ::close(fd);
    return good;
}

bool is_regular_file(const std::string& path) noexcept {
    struct stat info {};
    return ::stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode);
}

}  // namespace fairlead::gateway
