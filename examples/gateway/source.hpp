#pragma once
// Where a unit's motion comes from: a thread of its own that fills the unit's feed.
#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>

#include "examples/gateway/config.hpp"
#include "examples/gateway/feed.hpp"

namespace fairlead::gateway {

class Source {
  public:
    virtual ~Source() = default;
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    void start(UnitFeed& feed, std::uint32_t epoch);
    /// The thread ends soon; stop() then hardly waits.
    void request_stop() noexcept { stop_ = true; }
    /// Ends within a tenth of a second. Every derived class's destructor must have called it.
    void stop();
    /// False when the thread has not come round for ten seconds; true before start().
    bool is_alive(std::int64_t now_ns) const noexcept;

  protected:
    Source() = default;

    virtual void run(UnitFeed& feed, UnitState& state) = 0;

    bool stopping() noexcept;
    /// Sleeps in slices, so that stop() is heard. @return false when it is time to stop.
    bool sleep_until(std::int64_t t_ns) noexcept;
    /// Publishes the pose that arrived at state.arrival_ns.
    static void publish(UnitFeed& feed, UnitState& state) noexcept;

  private:
    std::atomic<bool> stop_{false};
    std::atomic<std::int64_t> heartbeat_ns_{0};
    std::thread thread_;
};

/// Throws sim::BadData when a recording cannot be used.
std::unique_ptr<Source> make_replay(const UnitConfig& unit);
std::unique_ptr<Source> make_board(const UnitConfig& unit);
std::unique_ptr<Source> make_sensor(const UnitConfig& unit);

}  // namespace fairlead::gateway
