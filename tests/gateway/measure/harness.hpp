#pragma once
// What the measurements share: the gateway as a child process, boards on pseudo-terminals, clients.
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "examples/gateway/reader.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/board.hpp"

struct _modbus;

namespace fairlead::gateway::measure {

/// Runs build/fairlead-gateway with these arguments until it goes out of scope.
class GatewayProcess {
  public:
    GatewayProcess(const std::string& program, std::vector<std::string> arguments);
    ~GatewayProcess();
    GatewayProcess(const GatewayProcess&) = delete;
    GatewayProcess& operator=(const GatewayProcess&) = delete;

    int port() const noexcept { return port_; }
    void kill_hard();
    long resident_kib() const;

  private:
    void end(int signal);

    int pid_{-1};
    int log_fd_{-1};
    int port_{};
};

struct MeasuredBoard {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, fairlead::Orientation>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::medium;
    static constexpr std::size_t events_max = 0;
};

/// A board: motion through the pipeline, its frames into one end of a pseudo-terminal in real time.
class BoardOnLine {
  public:
    struct Settings {
        double rate_hz{400};
        unsigned seed{1};
        double damaged_share{};  // of all bytes
        double restart_s{2};     // between restart frames
    };
    explicit BoardOnLine(const Settings& settings);
    ~BoardOnLine();
    BoardOnLine(const BoardOnLine&) = delete;
    BoardOnLine& operator=(const BoardOnLine&) = delete;

    const std::string& device() const noexcept { return device_; }
    void start();
    void stop();
    /// After stop(): the poses that went into the pipeline.
    const std::vector<Pose>& poses() const noexcept { return poses_; }
    std::uint64_t bytes() const noexcept { return bytes_; }
    std::uint64_t damaged() const noexcept { return damaged_; }

    static constexpr float tolerance_m = 0.001f;
    static constexpr float tolerance_rad = 0.0043633f;

  private:
    void run();
    std::int64_t period_ns() const noexcept {
        return static_cast<std::int64_t>(1e9 / settings_.rate_hz);
    }

    Settings settings_;
    int line_{-1};
    int held_{-1};  // the device's end, so that the line stays when the gateway is away
    std::string device_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
    std::vector<Pose> poses_;
    std::atomic<std::uint64_t> bytes_{0};
    std::uint64_t damaged_{};
};

/// Swings, turns and rests, another motion for every seed; its own clock begins at one hour.
Pose motion_of(const BoardOnLine::Settings& settings, std::uint64_t i);

/// What damage on the line costs, as a table. @return 1 when a wrong value was published.
int noise_table(double seconds);

/// libmodbus's own client.
class Client {
  public:
    Client(int port, int unit);
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;
    bool read(std::uint16_t address, std::uint16_t count, std::uint16_t* out);

  private:
    _modbus* context_;
    bool connected_{};
};

struct Latencies {
    std::vector<float> us;
    std::uint64_t failed{};

    void add(const Latencies& other);
    float at(double share);  // sorts
};

/// 32 clients, 44 registers, 50 times a second each.
Latencies poll_all(int port, int units, int clients, double rate_hz, double seconds);

/// A client that floods with wrong quantities, sends half headers, dribbles and floods connections.
class Hostile {
  public:
    explicit Hostile(int port, bool connections);
    ~Hostile();

  private:
    std::atomic<bool> stop_{false};
    std::vector<std::thread> threads_;
};

struct Deviation {
    std::size_t covered{};
    std::size_t samples{};
    double worst_m{};
    double worst_rad{};
};
/// The reader's curve against the samples that went into the board's pipeline.
Deviation compare(const CurveReader& reader, const std::vector<Pose>& poses);

}  // namespace fairlead::gateway::measure
