#pragma once
// Reads a configuration again without stopping the server: a thread of its own parses the file,
// opens recordings, ends old sources and starts new ones; the serving thread only exchanges what is
// ready.
//
//   begin() -> [thread: load, plan] -> fd() readable -> take() -> Service::commit() -> finish()
#include <sys/types.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "examples/gateway/config.hpp"
#include "examples/gateway/service.hpp"

namespace fairlead::gateway {

class Reloader {
  public:
    /// What begin() has come to: a plan, or why there is none.
    struct Loaded {
        std::optional<Service::Plan> plan;
        Config config;
        std::string error;
    };

    /// Throws std::system_error when the system has no descriptor or thread left.
    explicit Reloader(std::function<ConfigResult()> load);
    /// Waits for what the thread is doing. While is_busy() that can be the time of a large
    /// recording.
    ~Reloader();
    Reloader(const Reloader&) = delete;
    Reloader& operator=(const Reloader&) = delete;

    /// Starts a reload; while one runs, another follows it.
    void begin(std::vector<UnitConfig> running);
    /// Readable once a reload has come so far that take() has something.
    int fd() const noexcept { return fd_; }
    std::optional<Loaded> take();
    /// Hands over what is left to do after a commit (an empty change after a failed one) and the
    /// units that run now. A reload that was asked for meanwhile then begins.
    void finish(Service::Change change, std::vector<UnitConfig> running);

    /// The thread reads files, and nobody knows for how long.
    bool is_busy() const;

  private:
    enum class State : std::uint8_t { idle, wanted, loading, loaded, finishing, ended };
    void run();
    void load_once(std::unique_lock<std::mutex>& lock);

    std::function<ConfigResult()> load_;
    int fd_{-1};
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    State state_{State::idle};
    bool again_{};
    std::vector<UnitConfig> running_;
    Loaded loaded_;
    Service::Change change_;
    std::thread thread_;
};

}  // namespace fairlead::gateway
