#include "host_sim/progress.hpp"

#include <unistd.h>

#include <chrono>
#include <cmath>

namespace fairlead::sim {
namespace {

constexpr double patience_s = 2, every_s = 0.2;

double steady_now_s() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(now).count();
}

const double program_begun_s = steady_now_s();

/// "850", "12.4 k", "3.1 M".
void rate_text(double rate, char* out, std::size_t size) {
    if (rate < 1e3)
        std::snprintf(out, size, rate < 10 ? "%.1f" : "%.0f", rate);
    else if (rate < 1e6)
        std::snprintf(out, size, "%.1f k", rate * 1e-3);
    else
        std::snprintf(out, size, "%.1f M", rate * 1e-6);
}

/// "8 s", "3 min 20 s", "2 h 5 min".
void time_text(double seconds, char* out, std::size_t size) {
    const auto s = static_cast<long long>(std::ceil(std::fmin(seconds, 1e9)));
    if (s < 60)
        std::snprintf(out, size, "%lld s", s);
    else if (s < 3600)
        std::snprintf(out, size, "%lld min %lld s", s / 60, s % 60);
    else
        std::snprintf(out, size, "%lld h %lld min", s / 3600, s / 60 % 60);
}

}  // namespace

ProgressPlace ProgressPlace::standard() {
    return {stderr, isatty(STDERR_FILENO) != 0, steady_now_s, program_begun_s};
}

Progress::Progress(const char* label, std::size_t total, const char* unit,
                   const ProgressPlace& place)
    : label_{label}, unit_{unit}, total_{total}, place_{place} {
    if (!place_.terminal) return;
    start_s_ = place_.now_s();
    const double begun_s = place_.begun_s < 0 ? start_s_ : place_.begun_s;
    next_s_ = std::fmax(begun_s + patience_s, start_s_ + every_s);
}

Progress::~Progress() {
    if (!shown_) return;
    std::fputs("\r\033[K", place_.file);
    std::fflush(place_.file);
}

void Progress::show(std::size_t done) {
    if (!place_.terminal) return;
    const double now = place_.now_s();
    if (now < next_s_) return;
    next_s_ = now + every_s;
    print(done, now - start_s_);
}

void Progress::print(std::size_t done, double seconds) {
    char rate[32], left[48];
    const double speed = static_cast<double>(done) / seconds;
    rate_text(speed, rate, sizeof rate);
    std::fprintf(place_.file, "\r\033[K%s: ", label_);
    if (total_ > 0 && done > 0) {
        const std::size_t rest = total_ > done ? total_ - done : 0;
        time_text(static_cast<double>(rest) / speed, left, sizeof left);
        std::fprintf(place_.file, "%3.0f %%, %s %s/s, %s left",
                     100 * static_cast<double>(done) / static_cast<double>(total_), rate, unit_,
                     left);
    } else {
        std::fprintf(place_.file, "%s %s/s", rate, unit_);
    }
    std::fflush(place_.file);
    shown_ = true;
}

}  // namespace fairlead::sim
