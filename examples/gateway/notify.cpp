#include "examples/gateway/notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cinttypes>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace fairlead::gateway {

void notify(const char* state) noexcept {
    const char* const path = std::getenv("NOTIFY_SOCKET");
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    if (path == nullptr || (path[0] != '/' && path[0] != '@')) return;
    const std::size_t length = std::strlen(path);
    if (length >= sizeof to.sun_path) return;
    std::memcpy(to.sun_path, path, length);
    if (path[0] == '@') to.sun_path[0] = 0;  // the abstract namespace
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0) return;
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + length);
    // a receiver that does not read loses a beat, which is for it to notice
    static_cast<void>(sendto(fd, state, std::strlen(state), MSG_DONTWAIT | MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&to), size));
    close(fd);
}

void notify_reloading(std::int64_t monotonic_ns) noexcept {
    char text[64] = {};
    std::snprintf(text, sizeof text, "RELOADING=1\nMONOTONIC_USEC=%" PRId64, monotonic_ns / 1000);
    notify(text);
}

std::int64_t watchdog_period_ns() noexcept {
    const char* const period = std::getenv("WATCHDOG_USEC");
    const char* const pid = std::getenv("WATCHDOG_PID");
    if (period == nullptr) return 0;
    if (pid != nullptr && std::strtoll(pid, nullptr, 10) != static_cast<long long>(getpid()))
        return 0;
    const long long us = std::strtoll(period, nullptr, 10);
    return us > 0 && us < INT64_MAX / 1000 ? us * 1000 : 0;
}

}  // namespace fairlead::gateway
