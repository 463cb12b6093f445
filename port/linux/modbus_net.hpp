#pragma once
// Networks of clients, and listening sockets, IPv4 and IPv6 alike.
#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "fairlead/base/status.hpp"

namespace fairlead::port {

/// An address of either family in 16 bytes; IPv4 as ::ffff:a.b.c.d.
using HostAddress = std::array<std::uint8_t, 16>;

struct Network {
    HostAddress address{};
    int prefix{128};  // leading bits that must agree, of 128

    bool contains(const HostAddress& host) const noexcept;
};
inline bool operator==(const Network& a, const Network& b) noexcept {
    return a.address == b.address && a.prefix == b.prefix;
}

/// "192.168.1.0/24", "10.0.0.7", "fd00::/8"; empty when it is not a network.
std::optional<Network> parse_network(std::string_view text) noexcept;

struct Endpoint {
    HostAddress address{};
    std::uint16_t port{};

    bool is_loopback() const noexcept;
};
inline bool operator==(const Endpoint& a, const Endpoint& b) noexcept {
    return a.address == b.address && a.port == b.port;
}

/// "127.0.0.1:1502", "[::1]:1502"; empty when it is not a numeric address with a port.
std::optional<Endpoint> parse_endpoint(std::string_view text) noexcept;

/// As parse_endpoint() reads it. Allocates.
std::string to_text(const Endpoint& endpoint);

HostAddress host_of(const sockaddr_storage& from) noexcept;

/// A non-blocking listening socket. Port 0: the system chooses. *errno_out says why it failed.
Result<int> listen_on(const Endpoint& where, int* errno_out) noexcept;
std::uint16_t bound_port(int listener) noexcept;

}  // namespace fairlead::port
