#pragma once
// A line of progress on stderr for commands that last longer than two seconds: share, rate and time
// left, rewritten a few times a second. On a terminal only: none in a pipe or a file.
#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace fairlead::sim {

/// Where the line goes, and what time it is. The default is stderr and the real clock.
struct ProgressPlace {
    std::FILE* file{stderr};
    bool terminal{};
    double (*now_s)(){};  // of a clock that never goes back
    double begun_s{-1};   // the command's start: the two seconds count from there; -1: from here

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

  private:
    void print(std::size_t done, double seconds);

    const char *label_, *unit_;
    std::size_t total_;
    ProgressPlace place_;
    double start_s_{}, next_s_{};
    bool shown_{false};
};

}  // namespace fairlead::sim
