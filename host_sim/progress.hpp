#pragma once
// A line of progress on stderr for work that lasts: on a terminal a few times a second, elsewhere
// every few seconds, nothing for short work.
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace fairlead::sim {

class Progress {
  public:
    Progress(const char* label, std::size_t total) : label_{label}, total_{total} {}
    ~Progress() {
        if (shown_ && terminal_) std::fprintf(stderr, "\r\033[K");
    }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::size_t done) {
        if ((++calls_ & 63u) != 0) return;
        const auto now = Clock::now();
        if (now < next_) return;
        next_ = now + (terminal_ ? std::chrono::milliseconds(200) : std::chrono::seconds(5));
        shown_ = true;
        const double share =
            total_ > 0 ? static_cast<double>(done) / static_cast<double>(total_) : 1;
        std::fprintf(stderr, terminal_ ? "\r%s: %3.0f %%" : "%s: %3.0f %%\n", label_, 100 * share);
    }

  private:
    using Clock = std::chrono::steady_clock;
    const char* label_;
    std::size_t total_, calls_{0};
    bool terminal_{isatty(STDERR_FILENO) != 0}, shown_{false};
    Clock::time_point next_{Clock::now() + std::chrono::milliseconds(terminal_ ? 500 : 5000)};
};

}  // namespace fairlead::sim
