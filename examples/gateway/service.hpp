#pragma once
// The gateway as one object: units with their sources, the server in front of them, one loop.
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "examples/gateway/config.hpp"
#include "examples/gateway/source.hpp"
#include "examples/gateway/unit_table.hpp"
#include "port/linux/modbus_rtu.hpp"
#include "port/linux/modbus_tcp.hpp"

namespace fairlead::gateway {

/// What stops the gateway before it serves; `code` is the program's exit code.
struct StartError {
    int code;
    std::string text;
};

class Service : public port::RegisterBank {
  public:
    explicit Service(std::int64_t now_ns) noexcept { server_state_.started_ns = now_ns; }
    ~Service();

    /// Opens what the configuration says; keeps what it already has and what has not changed.
    /// Throws StartError; what was running before then still is, but for the server's sockets.
    void apply(const Config& config);

    /// Serves until wake_fd is readable or until_ns. No allocation.
    void serve(int wake_fd, std::int64_t until_ns) noexcept;

    /// False when a source hangs.
    bool is_alive(std::int64_t now_ns) const noexcept;

    port::RegisterTable prepare(std::uint8_t unit, std::uint16_t address,
                                std::uint16_t quantity) noexcept override;

    const std::vector<std::uint16_t>& ports() const noexcept { return ports_; }
    const port::ModbusCounters& counters() const noexcept { return counters_; }

  private:
    struct Unit {
        UnitConfig config;
        UnitFeed feed;
        UnitTable table;
        std::unique_ptr<Source> source;  // last: its thread ends before the feed goes
    };

    static std::unique_ptr<Unit> open_unit(const UnitConfig& config);
    void open_server(const Config& config);
    void collect() noexcept;

    Config config_;
    bool running_{};
    std::vector<std::unique_ptr<Unit>> units_;
    std::array<Unit*, 256> by_id_{};
    port::ModbusCounters counters_{};
    ServerState server_state_{};
    std::unique_ptr<port::ModbusTcpServer> tcp_;
    std::unique_ptr<port::ModbusRtuServer> rtu_;
    std::vector<std::uint16_t> ports_;
};

}  // namespace fairlead::gateway
