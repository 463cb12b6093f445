#include "port/linux/modbus_tcp.hpp"

#include <modbus/modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace fairlead::port {
namespace {

constexpr int accepts_per_turn = 8;                    // a connection flood gets its share only
constexpr std::int64_t accept_pause_ns = 100'000'000;  // when the system is out of descriptors
constexpr int send_buffer_bytes = 16 * 1024;           // kernel memory that a slow reader can hold
constexpr std::int64_t second_ns = 1'000'000'000;

/// Closes with a reset: the peer learns at once, and no socket lingers in TIME_WAIT.
void close_hard(int fd) noexcept {
    const linger now{1, 0};
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close(fd);
}

}  // namespace

ModbusTcpServer::~ModbusTcpServer() {
    for (Client& client : slots_) {
        if (client.fd >= 0) close(client.fd);
    }
    for (std::size_t i = 0; i < listeners_used_; ++i) close(listeners_[i].fd);
}

Status ModbusTcpServer::open(const ModbusTcpLimits& limits) noexcept {
    if (limits.clients == 0 || limits.clients > slots_max) return Status::bad_argument;
    limits_ = limits;
    // the address is never used: sockets are set per answer
    return reply_.adopt(modbus_new_tcp("127.0.0.1", 502)) ? Status::ok : Status::io_error;
}

Status ModbusTcpServer::allow(const Network& network) noexcept {
    if (networks_used_ == networks_max) return Status::overrun;
    networks_[networks_used_++] = network;
    return Status::ok;
}

Result<std::uint16_t> ModbusTcpServer::listen(const Endpoint& where, int* errno_out) noexcept {
    if (listeners_used_ == listeners_max) return Status::overrun;
    const auto fd = listen_on(where, errno_out);
    if (!fd) return fd.status();
    listeners_[listeners_used_++] = {*fd, where};
    return bound_port(*fd);
}

std::uint16_t ModbusTcpServer::port(std::size_t listener) const noexcept {
    return listener < listeners_used_ ? bound_port(listeners_[listener].fd) : 0;
}

/// The listener for `where`: one that is there already, or a new one. An old one on the same port
/// that is about to go makes room, and comes back when even that does not help.
ModbusTcpServer::Listener ModbusTcpServer::take_listener(const Endpoint& where,
                                                         const ModbusTcpSettings& wanted,
                                                         int* errno_out) noexcept {
    for (std::size_t i = 0; i < listeners_used_; ++i)
        if (listeners_[i].where == where && listeners_[i].fd >= 0) return {listeners_[i].fd, where};
    auto fd = listen_on(where, errno_out);
    if (fd) return {*fd, where};
    if (*errno_out != EADDRINUSE) return {};
    for (std::size_t i = 0; i < listeners_used_; ++i) {
        Listener& old = listeners_[i];
        const bool stays = std::any_of(wanted.endpoints, wanted.endpoints + wanted.endpoints_used,
                                       [&](const Endpoint& e) { return e == old.where; });
        if (stays || old.fd < 0 || old.where.port != where.port) continue;
        close(old.fd);
        old.fd = -1;
        fd = listen_on(where, errno_out);
        if (fd) return {*fd, where};
        int ignored = 0;
        const auto again = listen_on(old.where, &ignored);
        old.fd = again ? *again : -1;
        return {};
    }
    return {};
}

Status ModbusTcpServer::change(const ModbusTcpSettings& wanted, int* errno_out,
                               std::size_t* failed) noexcept {
    if (wanted.limits.clients == 0 || wanted.limits.clients > slots_max)
        return Status::bad_argument;
    if (wanted.networks_used > networks_max || wanted.endpoints_used > listeners_max)
        return Status::overrun;
    std::array<Listener, listeners_max> next{};
    const auto is_old = [&](int fd) {
        return std::any_of(listeners_.begin(), listeners_.begin() + listeners_used_,
                           [&](const Listener& l) { return l.fd == fd; });
    };
    for (std::size_t i = 0; i < wanted.endpoints_used; ++i) {
        next[i] = take_listener(wanted.endpoints[i], wanted, errno_out);
        if (next[i].fd >= 0) continue;
        *failed = i;
        for (std::size_t k = 0; k < i; ++k)
            if (!is_old(next[k].fd)) close(next[k].fd);
        restore_listeners();
        return Status::busy;
    }
    const auto stays = [&](int fd) {
        return std::any_of(next.begin(), next.begin() + wanted.endpoints_used,
                           [&](const Listener& l) { return l.fd == fd; });
    };
    for (std::size_t i = 0; i < listeners_used_; ++i)
        if (listeners_[i].fd >= 0 && !stays(listeners_[i].fd)) close(listeners_[i].fd);
    listeners_ = next;
    listeners_used_ = wanted.endpoints_used;
    std::copy_n(wanted.networks, wanted.networks_used, networks_.begin());
    networks_used_ = wanted.networks_used;
    limits_ = wanted.limits;
    for (Client& client : slots_) {
        client.poll_index = -1;  // the places of the last prepare() are gone
        if (client.fd >= 0 && !is_allowed(client.host)) drop(client, counters_.refused_network);
    }
    return Status::ok;
}

/// Listeners that made room for one that could not be had after all.
void ModbusTcpServer::restore_listeners() noexcept {
    for (std::size_t i = 0; i < listeners_used_; ++i) {
        if (listeners_[i].fd >= 0) continue;
        int ignored = 0;
        const auto again = listen_on(listeners_[i].where, &ignored);
        if (again) listeners_[i].fd = *again;
    }
}

bool ModbusTcpServer::is_allowed(const HostAddress& host) const noexcept {
    return std::any_of(networks_.begin(), networks_.begin() + networks_used_,
                       [&](const Network& n) { return n.contains(host); });
}

std::int64_t ModbusTcpServer::deadline_of(const Client& client) const noexcept {
    if (client.used > 0) return client.frame_since_ns + limits_.frame_ns;
    return client.last_ns + (client.greeted ? limits_.idle_ns : limits_.first_ns);
}

/// When the next request of this client may be served.
std::int64_t ModbusTcpServer::pace_ns(const Client& client) const noexcept {
    if (limits_.requests_per_second == 0) return 0;
    const std::int64_t interval_ns = second_ns / limits_.requests_per_second;
    return client.paced_ns - interval_ns * limits_.burst;
}

std::size_t ModbusTcpServer::prepare(pollfd* out, std::int64_t now_ns,
                                     std::int64_t* wake_ns) noexcept {
    std::size_t n = 0;
    const bool accepting = now_ns >= accept_again_ns_;
    if (!accepting) *wake_ns = std::min(*wake_ns, accept_again_ns_);
    for (std::size_t i = 0; i < listeners_used_; ++i) {
        out[n++] = {accepting ? listeners_[i].fd : -1, POLLIN, 0};
    }
    for (Client& client : slots_) {
        if (client.fd < 0) continue;
        client.poll_index = static_cast<int>(n);
        const std::int64_t pace = pace_ns(client);
        const bool held = pace > now_ns;
        out[n++] = {client.fd, static_cast<short>(held ? 0 : POLLIN), 0};
        const bool ready = modbus::find_tcp_frame(client.buffer.data(), client.used).state !=
                           modbus::Framing::incomplete;
        *wake_ns = std::min(*wake_ns, held ? pace : ready ? now_ns : deadline_of(client));
    }
    return n;
}

void ModbusTcpServer::serve(const pollfd* polled, std::int64_t now_ns) noexcept {
    for (Client& client : slots_) {
        if (client.fd < 0 || client.poll_index < 0) continue;
        const short events = polled[client.poll_index].revents;
        const bool held = pace_ns(client) > now_ns;
        if ((events & (POLLERR | POLLNVAL)) != 0 || (held && (events & POLLHUP) != 0)) {
            std::uint64_t gone = 0;  // the peer's own end is no fault
            drop(client, gone);
        }
        if (client.fd < 0 || held) continue;
        const bool waiting = modbus::find_tcp_frame(client.buffer.data(), client.used).state ==
                             modbus::Framing::incomplete;
        if (waiting && (events & (POLLIN | POLLHUP)) != 0) read_from(client, now_ns);
        if (client.used > 0) answer_one(client, now_ns);
        if (client.fd >= 0) drop_expired(client, now_ns);
    }
    for (std::size_t i = 0; i < listeners_used_; ++i) {
        if ((polled[i].revents & POLLIN) != 0) accept_from(listeners_[i].fd, now_ns);
    }
}

void ModbusTcpServer::read_from(Client& client, std::int64_t now_ns) noexcept {
    const std::size_t room = client.buffer.size() - client.used;  // never 0: no frame is longer
    const ssize_t got = recv(client.fd, client.buffer.data() + client.used, room, MSG_DONTWAIT);
    if (got > 0) {
        if (client.used == 0) client.frame_since_ns = now_ns;
        client.used += static_cast<std::size_t>(got);
    } else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
        std::uint64_t gone = 0;  // the peer's own end is no fault
        drop(client, gone);
    }
}

void ModbusTcpServer::answer_one(Client& client, std::int64_t now_ns) noexcept {
    const modbus::TcpFrame frame = modbus::find_tcp_frame(client.buffer.data(), client.used);
    if (frame.state == modbus::Framing::incomplete) return;
    if (frame.state == modbus::Framing::broken) return drop(client, counters_.closed_protocol);
    client.greeted = true;
    client.last_ns = now_ns;
    if (limits_.requests_per_second != 0) {
        const std::int64_t interval_ns = second_ns / limits_.requests_per_second;
        client.paced_ns = std::max(client.paced_ns, now_ns) + interval_ns;
    }
    const std::uint8_t* adu = client.buffer.data();
    modbus_set_socket(reply_.context(), client.fd);
    const bool taken =
        reply_.answer(adu, frame.size, adu + modbus::mbap_size, frame.size - modbus::mbap_size,
                      adu[modbus::mbap_size - 1], bank_, counters_);
    modbus_set_socket(reply_.context(), -1);  // the socket stays ours
    if (!taken) return drop(client, counters_.closed_slow_reader);
    client.used -= frame.size;
    std::memmove(client.buffer.data(), client.buffer.data() + frame.size, client.used);
    client.frame_since_ns = now_ns;
}

void ModbusTcpServer::drop_expired(Client& client, std::int64_t now_ns) noexcept {
    if (now_ns < deadline_of(client)) return;
    drop(client, client.used > 0 ? counters_.closed_deadline : counters_.closed_idle);
}

void ModbusTcpServer::drop(Client& client, std::uint64_t& counter) noexcept {
    ++counter;
    close_hard(client.fd);
    client = Client{};
    --clients_;
}

void ModbusTcpServer::accept_from(int listener, std::int64_t now_ns) noexcept {
    for (int i = 0; i < accepts_per_turn; ++i) {
        sockaddr_storage from{};
        socklen_t size = sizeof from;
        const int fd = accept4(listener, reinterpret_cast<sockaddr*>(&from), &size,
                               SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (fd < 0) {
            const bool exhausted =
                errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM;
            if (exhausted) accept_again_ns_ = now_ns + accept_pause_ns;
            return;
        }
        if (!admit(fd, host_of(from), now_ns)) close_hard(fd);
    }
}

bool ModbusTcpServer::admit(int fd, const HostAddress& host, std::int64_t now_ns) noexcept {
    if (!is_allowed(host)) {
        ++counters_.refused_network;
        return false;
    }
    Client* free_slot = nullptr;
    std::size_t of_host = 0;
    for (Client& client : slots_) {
        if (client.fd < 0) {
            if (free_slot == nullptr) free_slot = &client;
        } else if (client.host == host) {
            ++of_host;
        }
    }
    if (clients_ >= limits_.clients || of_host >= limits_.clients_per_host) {
        ++counters_.refused_full;
        return false;
    }
    const int on = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &send_buffer_bytes, sizeof send_buffer_bytes);
    *free_slot = Client{};
    free_slot->fd = fd;
    free_slot->host = host;
    free_slot->last_ns = now_ns;
    ++clients_;
    ++counters_.accepted;
    return true;
}

}  // namespace fairlead::port
