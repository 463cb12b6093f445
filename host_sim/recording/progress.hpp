#pragma once
// A line of progress on stderr for commands that last longer than two seconds: share, rate and time
// left, rewritten a few times a second. On a terminal only: none in a pipe or a file.
#include <cstddef>
#include <cstdio>
#include <functional>

namespace fairlead::sim {

/// Where the line goes, and what time it is. The default is stderr and the real clock.
struct ProgressPlace {
    std::FILE* file{stderr};
    bool terminal{};
    double (*now_s)(){};   // of a clock that never goes back
    double begun_s{-1};    // the command's start: the patience counts from there; -1: from here
    double patience_s{2};  // before the first line; 0: at once (FAIRLEAD_PROGRESS_AFTER=0)

    static ProgressPlace standard();
};

class Progress {
  public:
    /// total: of `unit`s, 0: not known.
    Progress(const char* label, std::size_t total, const char* unit = "records",
             const ProgressPlace& place = ProgressPlace::standard());
    ~Progress();  // takes the line away
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(std::size_t done);
    /// share: of the whole work, 0 to 1, where the units do not tell it.
    void show(std::size_t done, double share);

  private:
    void print(std::size_t done, double share, double seconds);

    const char *label_, *unit_;
    std::size_t total_;
    ProgressPlace place_;
    double start_s_{}, next_s_{};
    bool shown_{false};
};

/// The same as the callback that readers and writers take; the line goes with the callback.
std::function<void(std::size_t done, std::size_t total)> progress_steps(
    const char* label, const char* unit = "records");

}  // namespace fairlead::sim
