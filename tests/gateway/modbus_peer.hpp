#pragma once
// A Modbus TCP server under test, driven turn by turn with a clock of its own, and a raw peer that
// can send anything.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <vector>

#include "port/linux/modbus_tcp.hpp"

namespace fairlead::port {

using Bytes = std::vector<std::uint8_t>;

/// Unit 7 has 300 registers, register i holds 1000 + i. There is no other unit.
class CountingBank : public RegisterBank {
  public:
    CountingBank() {
        for (std::size_t i = 0; i < table_.size(); ++i) {
            table_[i] = static_cast<std::uint16_t>(1000 + i);
        }
    }
    RegisterTable prepare(std::uint8_t unit, std::uint16_t, std::uint16_t) noexcept override {
        if (unit != 7) return {};
        return {table_.data(), static_cast<std::uint16_t>(table_.size())};
    }

  private:
    std::array<std::uint16_t, 300> table_{};
};

inline Bytes request(std::uint8_t unit, const Bytes& pdu, std::uint16_t transaction = 0x1234) {
    const auto length = static_cast<std::uint16_t>(pdu.size() + 1);
    Bytes adu{static_cast<std::uint8_t>(transaction >> 8),
              static_cast<std::uint8_t>(transaction & 0xFF),
              0,
              0,
              static_cast<std::uint8_t>(length >> 8),
              static_cast<std::uint8_t>(length & 0xFF),
              unit};
    adu.insert(adu.end(), pdu.begin(), pdu.end());
    return adu;
}
inline Bytes read_pdu(int function, int address, int quantity) {
    return {static_cast<std::uint8_t>(function), static_cast<std::uint8_t>(address >> 8),
            static_cast<std::uint8_t>(address & 0xFF), static_cast<std::uint8_t>(quantity >> 8),
            static_cast<std::uint8_t>(quantity & 0xFF)};
}

class Peer {
  public:
    explicit Peer(std::uint16_t port) : fd_{socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)} {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(port);
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        EXPECT_EQ(connect(fd_, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    }
    ~Peer() {
        if (fd_ >= 0) close(fd_);
    }
    Peer(Peer&& other) noexcept : fd_{other.fd_} { other.fd_ = -1; }
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;

    int fd() const { return fd_; }
    void send(const Bytes& bytes) const {
        // a server that has closed may reset: the test then sees it in receive()
        static_cast<void>(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL));
    }
    /// What arrives until there are at least `least` bytes, or for two seconds; 0: what is there.
    Bytes receive(std::size_t least) const {
        Bytes all(65536);
        std::size_t used = 0;
        do {
            const ssize_t got = recv(fd_, all.data() + used, all.size() - used, MSG_DONTWAIT);
            if (got > 0) used += static_cast<std::size_t>(got);
        } while (used < least && wait());
        all.resize(used);
        return all;
    }
    /// Waits for the end of the connection; what arrives before it is dropped.
    bool closed_by_server() const {
        std::array<std::uint8_t, 4096> bytes{};
        for (;;) {
            const ssize_t got = recv(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT);
            if (got == 0 || (got < 0 && errno != EAGAIN)) return true;
            if (got < 0 && !wait()) return false;
        }
    }
    bool still_open() const {
        std::uint8_t byte{};
        return recv(fd_, &byte, 1, MSG_DONTWAIT | MSG_PEEK) != 0;
    }

  private:
    bool wait() const {
        pollfd readable{fd_, POLLIN, 0};
        return poll(&readable, 1, 2000) > 0;
    }

    int fd_{-1};
};

class ServerUnderTest {
  public:
    explicit ServerUnderTest(const ModbusTcpLimits& limits = {},
                             const char* endpoint = "127.0.0.1:0",
                             const char* allowed = "127.0.0.0/8") {
        EXPECT_EQ(server.open(limits), Status::ok);
        EXPECT_EQ(server.allow(*parse_network(allowed)), Status::ok);
        EXPECT_EQ(server.allow(*parse_network("::1")), Status::ok);
        int error = 0;
        const auto bound = server.listen(*parse_endpoint(endpoint), &error);
        EXPECT_TRUE(bound) << std::strerror(error);
        port = *bound;
    }
    void turn(int wait_ms = 0) {
        std::int64_t wake_ns = now_ns + 1'000'000'000'000;
        const std::size_t n = server.prepare(polled.data(), now_ns, &wake_ns);
        poll(polled.data(), n, wake_ns <= now_ns ? 0 : wait_ms);
        server.serve(polled.data(), now_ns);
    }
    /// Turns until it is so, for at most about two seconds: the loopback delivers when it likes.
    template <class Condition>
    void until(Condition condition) {
        for (int i = 0; i < 2000 && !condition(); ++i) turn(1);
        EXPECT_TRUE(condition());
    }
    void until_requests(std::uint64_t n) {
        until([&] { return counters.requests >= n; });
    }
    void until_clients(std::size_t n) {
        until([&] { return server.clients() == n; });
    }

    CountingBank bank;
    ModbusCounters counters;
    ModbusTcpServer server{bank, counters};
    std::array<pollfd, ModbusTcpServer::poll_max> polled{};
    std::uint16_t port{};
    std::int64_t now_ns{1'000'000'000'000};
};

}  // namespace fairlead::port
