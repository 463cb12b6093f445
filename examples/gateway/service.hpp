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
    struct Unit;

  public:
    /// What a configuration needs beside what is running already. Made in any thread, since it
    /// reads whole recordings; the server goes on meanwhile.
    class Plan {
      public:
        Plan();
        Plan(Plan&&) noexcept;
        Plan& operator=(Plan&&) noexcept;
        ~Plan();

      private:
        friend Service;
        Config config_;
        std::vector<std::unique_ptr<Unit>> fresh_;
    };
    /// Units that no longer serve and units whose sources have not started.
    class Change {
      public:
        Change();
        Change(Change&&) noexcept;
        Change& operator=(Change&&) noexcept;
        ~Change();
        /// Ends the old sources, which can take a tenth of a second, then starts the new ones. Call
        /// it in any thread, while the service exists and before the next commit().
        void finish();

      private:
        friend Service;
        std::vector<std::unique_ptr<Unit>> retired_;
        std::vector<Unit*> fresh_;
    };

    explicit Service(std::int64_t now_ns) noexcept { server_state_.started_ns = now_ns; }
    ~Service();

    /// Throws StartError when a recording cannot be used. `running`: units that need not be opened.
    static Plan plan(const Config& config, const std::vector<UnitConfig>& running);
    std::vector<UnitConfig> running_units() const;
    /// Takes a plan over, in the serving thread. Keeps every connection that may stay and every
    /// unit that has not changed. Throws StartError when an address cannot be had; then nothing has
    /// changed.
    Change commit(Plan plan);
    /// The three in one, for the start of a program.
    void apply(const Config& config);

    /// Serves until one of the descriptors is readable, or until_ns. No allocation.
    static constexpr std::size_t wake_max = 2;
    void serve(const std::array<int, wake_max>& wake_fds, std::int64_t until_ns) noexcept;

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
        std::uint32_t epoch{};
        std::unique_ptr<Source> source;  // last: its thread ends before the feed goes
    };

    static std::unique_ptr<Unit> open_unit(const UnitConfig& config);
    void change_server(const Config& config);
    void change_rtu(const Config& config);
    void collect() noexcept;

    Config config_;
    std::vector<std::unique_ptr<Unit>> units_;
    std::array<Unit*, 256> by_id_{};
    port::ModbusCounters counters_{};
    ServerState server_state_{};
    std::unique_ptr<port::ModbusTcpServer> tcp_;
    std::unique_ptr<port::ModbusRtuServer> rtu_;
    std::string rtu_device_;  // the RTU server keeps a pointer to it
    std::vector<std::uint16_t> ports_;
};

}  // namespace fairlead::gateway
