#include "port/linux/modbus_net.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <string>

namespace fairlead::port {
namespace {

constexpr HostAddress mapped_ipv4{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
constexpr int backlog = 64;

bool is_ipv4(const HostAddress& a) noexcept {
    return std::memcmp(a.data(), mapped_ipv4.data(), 12) == 0;
}

std::optional<HostAddress> parse_host(std::string_view text) noexcept {
    std::array<char, INET6_ADDRSTRLEN> copy{};
    if (text.size() >= copy.size() || text.find(char{}) != text.npos) return std::nullopt;
    std::memcpy(copy.data(), text.data(), text.size());
    HostAddress host = mapped_ipv4;
    if (inet_pton(AF_INET, copy.data(), &host[12]) == 1) return host;
    if (inet_pton(AF_INET6, copy.data(), host.data()) == 1) return host;
    return std::nullopt;
}

std::optional<int> parse_number(std::string_view text, int max) noexcept {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    if (value < 0 || value > max) return std::nullopt;
    return value;
}

}  // namespace

bool Network::contains(const HostAddress& host) const noexcept {
    for (int bit = 0; bit < prefix; bit += 8) {
        const auto i = static_cast<std::size_t>(bit / 8);
        const int rest = prefix - bit;
        const int mask = rest >= 8 ? 0xFF : 0xFF & ~(0xFF >> rest);
        if (((address[i] ^ host[i]) & mask) != 0) return false;
    }
    return true;
}

std::optional<Network> parse_network(std::string_view text) noexcept {
    const std::size_t slash = text.find('/');
    const auto host = parse_host(text.substr(0, slash));
    if (!host) return std::nullopt;
    const int bits = is_ipv4(*host) ? 32 : 128;
    int prefix = bits;
    if (slash != std::string_view::npos) {
        const auto given = parse_number(text.substr(slash + 1), bits);
        if (!given) return std::nullopt;
        prefix = *given;
    }
    return Network{*host, prefix + 128 - bits};
}

bool Endpoint::is_loopback() const noexcept {
    if (is_ipv4(address)) return address[12] == 127;
    HostAddress loopback{};
    loopback[15] = 1;
    return address == loopback;
}

std::optional<Endpoint> parse_endpoint(std::string_view text) noexcept {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string_view::npos) return std::nullopt;
    std::string_view host = text.substr(0, colon);
    const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
    if (bracketed) host = host.substr(1, host.size() - 2);
    const auto address = parse_host(host);
    const auto port = parse_number(text.substr(colon + 1), 65535);
    if (!address || !port || bracketed == is_ipv4(*address)) return std::nullopt;
    return Endpoint{*address, static_cast<std::uint16_t>(*port)};
}

HostAddress host_of(const sockaddr_storage& from) noexcept {
    HostAddress host = mapped_ipv4;
    if (from.ss_family == AF_INET) {
        sockaddr_in v4{};
        std::memcpy(&v4, &from, sizeof v4);
        std::memcpy(&host[12], &v4.sin_addr, 4);
    } else {
        sockaddr_in6 v6{};
        std::memcpy(&v6, &from, sizeof v6);
        std::memcpy(host.data(), &v6.sin6_addr, 16);
    }
    return host;
}

std::string to_text(const Endpoint& endpoint) {
    char text[INET6_ADDRSTRLEN] = {};
    const bool v4 = is_ipv4(endpoint.address);
    inet_ntop(v4 ? AF_INET : AF_INET6, endpoint.address.data() + (v4 ? 12 : 0), text, sizeof text);
    const std::string host{text};
    return (v4 ? host : "[" + host + "]") + ":" + std::to_string(endpoint.port);
}

Result<int> listen_on(const Endpoint& where, int* errno_out) noexcept {
    sockaddr_storage to{};
    socklen_t size = 0;
    if (is_ipv4(where.address)) {
        sockaddr_in v4{};
        v4.sin_family = AF_INET;
        v4.sin_port = htons(where.port);
        std::memcpy(&v4.sin_addr, &where.address[12], 4);
        std::memcpy(&to, &v4, size = sizeof v4);
    } else {
        sockaddr_in6 v6{};
        v6.sin6_family = AF_INET6;
        v6.sin6_port = htons(where.port);
        std::memcpy(&v6.sin6_addr, where.address.data(), 16);
        std::memcpy(&to, &v6, size = sizeof v6);
    }
    const int fd = socket(to.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int on = 1;
    if (fd >= 0) {
        setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
        if (to.ss_family == AF_INET6) setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
        if (bind(fd, reinterpret_cast<const sockaddr*>(&to), size) == 0 &&
            listen(fd, backlog) == 0) {
            return fd;
        }
    }
    *errno_out = errno;
    if (fd >= 0) close(fd);
    switch (*errno_out) {
        case EACCES: return Status::no_permission;
        case EADDRINUSE: return Status::busy;
        case EADDRNOTAVAIL: return Status::not_found;
        case EAFNOSUPPORT: return Status::not_supported;
        default: return Status::io_error;
    }
}

std::uint16_t bound_port(int listener) noexcept {
    sockaddr_storage at{};
    socklen_t size = sizeof at;
    if (getsockname(listener, reinterpret_cast<sockaddr*>(&at), &size) != 0) return 0;
    sockaddr_in v4{};  // the port stands at the same place in both families
    std::memcpy(&v4, &at, sizeof v4);
    return ntohs(v4.sin_port);
}

}  // namespace fairlead::port
