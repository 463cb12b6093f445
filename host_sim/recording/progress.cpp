#include "host_sim/recording/progress.hpp"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>

namespace fairlead::sim {
namespace {

constexpr double every_s = 0.2;

/// Seconds before the first line: 2, or what FAIRLEAD_PROGRESS_AFTER says.
double said_patience_s() {
    const char* said = std::getenv("FAIRLEAD_PROGRESS_AFTER");
    if (said == nullptr) return 2;
    char* end = nullptr;
    const double seconds = std::strtod(said, &end);
    return end != said && seconds >= 0 ? seconds : 2;
}

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
    return {stderr, isatty(STDERR_FILENO) != 0, steady_now_s, program_begun_s, said_patience_s()};
}

Progress::Progress(const char* label, std::size_t total, const char* unit,
                   const ProgressPlace& place)
    : label_{label}, unit_{unit}, total_{total}, place_{place} {
    if (!place_.terminal) return;
    start_s_ = place_.now_s();
    const double begun_s = place_.begun_s < 0 ? start_s_ : place_.begun_s;
    next_s_ =
        std::fmax(begun_s + place_.patience_s, start_s_ + std::fmin(every_s, place_.patience_s));
}

Progress::~Progress() {
    if (!shown_) return;
    std::fputs("\r\033[K", place_.file);
    std::fflush(place_.file);
}

void Progress::show(std::size_t done) {
    show(done, total_ > 0 ? static_cast<double>(done) / static_cast<double>(total_) : 0);
}

void Progress::show(std::size_t done, double share) {
    if (!place_.terminal) return;
    const double now = place_.now_s();
    if (now < next_s_) return;
    next_s_ = now + every_s;
    print(done, share, now - start_s_);
}

void Progress::print(std::size_t done, double share, double seconds) {
    char rate[32], left[48];
    const double speed = static_cast<double>(done) / seconds;
    rate_text(speed, rate, sizeof rate);
    std::fprintf(place_.file, "\r\033[K%s: ", label_);
    if (share > 0) {
        time_text(std::fmax(0, seconds / share - seconds), left, sizeof left);
        std::fprintf(place_.file, "%3.0f %%, %s %s/s, %s left", 100 * share, rate, unit_, left);
    } else {
        std::fprintf(place_.file, "%s %s/s", rate, unit_);
    }
    std::fflush(place_.file);
    shown_ = true;
}

std::function<void(std::size_t, std::size_t)> progress_steps(const char* label, const char* unit) {
    struct Line {
        std::optional<Progress> progress;
        std::size_t total{};
    };
    const auto line = std::make_shared<Line>();
    return [line, label, unit](std::size_t done, std::size_t total) {
        if (!line->progress || line->total != total) {  // the first, or that of another file
            line->total = total;
            line->progress.reset();
            line->progress.emplace(label, total, unit);
        }
        line->progress->show(done);
    };
}

}  // namespace fairlead::sim
