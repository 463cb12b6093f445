#pragma once
// Modbus TCP: listeners, client slots, deadlines. See port/linux/modbus.hpp for the reasons.
#include <poll.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "port/linux/modbus.hpp"
#include "port/linux/modbus_adu.hpp"
#include "port/linux/modbus_net.hpp"

namespace fairlead::port {

struct ModbusTcpLimits {
    std::size_t clients{64};                  // at most ModbusTcpServer::slots_max
    std::size_t clients_per_host{48};         // so that no host can take every slot
    std::int64_t frame_ns{2'000'000'000};     // from a frame's first byte to its last
    std::int64_t first_ns{5'000'000'000};     // from the connection to the first request
    std::int64_t idle_ns{120'000'000'000};    // from one request to the next
    std::uint32_t requests_per_second{2000};  // per client; faster ones wait. 0: no limit
    std::uint32_t burst{50};                  // requests that may come at once before that
};

/// Everything that a running server can be told anew. The arrays stay the caller's.
struct ModbusTcpSettings {
    ModbusTcpLimits limits{};
    const Network* networks{};
    std::size_t networks_used{};
    const Endpoint* endpoints{};
    std::size_t endpoints_used{};
};

class ModbusTcpServer {
  public:
    static constexpr std::size_t slots_max = 128;
    static constexpr std::size_t listeners_max = 4;
    static constexpr std::size_t networks_max = 32;
    static constexpr std::size_t poll_max = slots_max + listeners_max;

    ModbusTcpServer(RegisterBank& bank, ModbusCounters& counters) noexcept
        : bank_{bank}, counters_{counters} {}
    ~ModbusTcpServer();
    ModbusTcpServer(const ModbusTcpServer&) = delete;
    ModbusTcpServer& operator=(const ModbusTcpServer&) = delete;

    Status open(const ModbusTcpLimits& limits) noexcept;
    /// Clients from elsewhere are turned away. Nothing allowed: nobody is let in.
    Status allow(const Network& network) noexcept;
    /// The bound port: the system's choice when where.port is 0. errno_out: why it failed.
    Result<std::uint16_t> listen(const Endpoint& where, int* errno_out) noexcept;
    /// Other limits, networks and listeners, all of them or none: on failure everything is as it
    /// was, *failed names the endpoint and *errno_out says why. Listeners that stay are not closed;
    /// of the clients only those are, whose network is no longer allowed. New limits hold for the
    /// next connection and the next request.
    Status change(const ModbusTcpSettings& wanted, int* errno_out, std::size_t* failed) noexcept;
    /// The port that listener i is bound to, in the order of the settings; 0: there is none.
    std::uint16_t port(std::size_t listener) const noexcept;

    /// Writes what to wait for; lowers *wake_ns to the next deadline. Returns the number written.
    std::size_t prepare(pollfd* out, std::int64_t now_ns, std::int64_t* wake_ns) noexcept;
    /// Serves what poll() found; `polled` is what the last prepare() wrote.
    void serve(const pollfd* polled, std::int64_t now_ns) noexcept;

    std::size_t clients() const noexcept { return clients_; }

  private:
    struct Client {
        int fd{-1};
        int poll_index{-1};
        HostAddress host{};
        std::array<std::uint8_t, modbus::tcp_adu_max> buffer{};
        std::size_t used{};
        std::int64_t frame_since_ns{};  // when the frame in the buffer began
        std::int64_t last_ns{};         // connection, or the last complete request
        std::int64_t paced_ns{};        // when the requests so far would be due at the agreed rate
        bool greeted{};                 // has sent a complete request
    };

    struct Listener {
        int fd{-1};
        Endpoint where{};
    };

    Listener take_listener(const Endpoint& where, const ModbusTcpSettings& wanted,
                           int* errno_out) noexcept;
    void restore_listeners() noexcept;
    bool is_allowed(const HostAddress& host) const noexcept;
    void accept_from(int listener, std::int64_t now_ns) noexcept;
    bool admit(int fd, const HostAddress& host, std::int64_t now_ns) noexcept;
    void read_from(Client& client, std::int64_t now_ns) noexcept;
    void answer_one(Client& client, std::int64_t now_ns) noexcept;
    void drop_expired(Client& client, std::int64_t now_ns) noexcept;
    std::int64_t deadline_of(const Client& client) const noexcept;
    std::int64_t pace_ns(const Client& client) const noexcept;
    void drop(Client& client, std::uint64_t& counter) noexcept;

    RegisterBank& bank_;
    ModbusCounters& counters_;
    ModbusReply reply_{};
    ModbusTcpLimits limits_{};
    std::array<Network, networks_max> networks_{};
    std::size_t networks_used_{};
    std::array<Listener, listeners_max> listeners_{};
    std::size_t listeners_used_{};
    std::int64_t accept_again_ns_{};  // out of descriptors: no accepting before this
    std::array<Client, slots_max> slots_{};
    std::size_t clients_{};
};

}  // namespace fairlead::port
