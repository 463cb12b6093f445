#include "host_sim/replay/timing.hpp"

#include <algorithm>
#include <cstdio>
#include <deque>
#include <random>
#include <sstream>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {
namespace {

std::string grouped(std::uint64_t n) {
    std::string digits = std::to_string(n);
    for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), ",");
    return digits;
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
    char text[256];
    std::snprintf(text, sizeof text, pattern, values...);
    return text;
}

/// Sums of times round; what is over by that alone is in time.
bool over(double seconds, double budget_s) { return seconds > budget_s * (1 + 1e-12); }

class Player {
  public:
    explicit Player(const TimingModel& model) : model_{model}, random_{model.seed} {}

    TimingReport play(const std::vector<TimedPush>& pushes) {
        report_.pushes = pushes.size();
        for (std::size_t i = 0; i < pushes.size(); ++i) step(i, pushes[i], pushes[0].t_ns);
        if (pushes.size() > 1) {
            const double span_s =
                1e-9 * static_cast<double>(pushes.back().t_ns - pushes.front().t_ns);
            report_.core_load = busy_s_ / span_s;
            report_.wire_load = static_cast<double>(sent_) / (model_.wire_bytes_per_s * span_s);
        }
        return report_;
    }

  private:
    void step(std::size_t i, const TimedPush& push, std::int64_t origin_ns) {
        const double stamped_s = 1e-9 * static_cast<double>(push.t_ns - origin_ns);
        // interrupts do not overtake each other
        const double draw = std::uniform_real_distribution<double>{0, 1}(random_);
        queued_s_ = std::max(queued_s_, stamped_s + draw * model_.interrupt_jitter_s);
        while (!starts_s_.empty() && starts_s_.front() <= queued_s_) starts_s_.pop_front();
        const double begin_s = std::max(queued_s_, core_free_s_);
        if (begin_s > queued_s_) starts_s_.push_back(begin_s);
        report_.queue_max = std::max(report_.queue_max, starts_s_.size());
        const double least_s = seconds(push.instructions, model_.cycles_per_instruction_min);
        const double most_s = seconds(push.instructions, model_.cycles_per_instruction_max);
        core_free_s_ = begin_s + most_s;
        busy_s_ += most_s;
        note_push(i, push, least_s, most_s, core_free_s_ - stamped_s);
        send(i, push.bytes);
    }

    void note_push(std::size_t i, const TimedPush& push, double least_s, double most_s,
                   double response_s) {
        if (i == 0 || least_s < report_.push_min_s) report_.push_min_s = least_s;
        if (most_s > report_.push_max_s) {
            report_.push_max_s = most_s;
            report_.dearest_push = i;
        }
        report_.response_max_s = std::max(report_.response_max_s, response_s);
        if (over(most_s, model_.push_budget_s)) {
            fail(i, grouped(push.instructions) + " instructions = " +
                        format("%.0f us at %.0f MHz, budget %.0f us", 1e6 * most_s,
                               1e-6 * model_.core_hz, 1e6 * model_.push_budget_s));
        }
        if (over(response_s, model_.response_budget_s)) {
            fail(i, format("done %.0f us after its record was stamped, budget %.0f us",
                           1e6 * response_s, 1e6 * model_.response_budget_s));
        }
        if (starts_s_.size() > model_.queue_capacity) {
            fail(i, format("%zu records wait, the queue holds %zu", starts_s_.size(),
                           model_.queue_capacity));
        }
    }

    void send(std::size_t i, std::size_t bytes) {
        if (bytes == 0) return;
        sent_ += bytes;
        const double now_s = core_free_s_;
        wire_free_s_ =
            std::max(wire_free_s_, now_s) + static_cast<double>(bytes) / model_.wire_bytes_per_s;
        const double delay_s = wire_free_s_ - now_s;
        const auto waiting = static_cast<std::size_t>(delay_s * model_.wire_bytes_per_s + 0.5);
        report_.wire_delay_max_s = std::max(report_.wire_delay_max_s, delay_s);
        report_.wire_max = std::max(report_.wire_max, waiting);
        if (waiting > model_.wire_capacity) {
            fail(i, format("%zu bytes wait for the wire, its buffer holds %zu", waiting,
                           model_.wire_capacity));
        }
    }

    void fail(std::size_t i, const std::string& what) {
        if (++report_.failures <= model_.messages_max)
            report_.messages.push_back("push " + std::to_string(i) + ": " + what);
    }

    double seconds(std::uint64_t instructions, double cycles_per_instruction) const {
        return static_cast<double>(instructions) * cycles_per_instruction / model_.core_hz;
    }

    const TimingModel& model_;
    std::mt19937 random_;
    TimingReport report_;
    std::deque<double> starts_s_;  // of the pushes whose records still wait
    double queued_s_{0}, core_free_s_{0}, wire_free_s_{0}, busy_s_{0};
    std::size_t sent_{0};
};

}  // namespace

std::string TimingReport::text() const {
    if (ok()) {
        return format(
            "%zu pushes: %.1f to %.1f us each (dearest: push %zu), response %.1f us at most, %zu "
            "records and %zu bytes waiting at most, core %.1f %%, wire %.1f %% busy",
            pushes, 1e6 * push_min_s, 1e6 * push_max_s, dearest_push, 1e6 * response_max_s,
            queue_max, wire_max, 100 * core_load, 100 * wire_load);
    }
    std::string all = std::to_string(failures) + " deadlines or limits broken";
    for (const std::string& message : messages) all += "\n" + message;
    return all;
}

TimingReport play(const TimingModel& model, const std::vector<TimedPush>& pushes) {
    return Player{model}.play(pushes);
}

std::map<std::string, StageBound> read_bounds(const std::string& path, const std::string& core) {
    std::map<std::string, StageBound> bounds;
    std::istringstream lines{read_bytes(path)};
    std::string line;
    for (bool inside = false; std::getline(lines, line);) {
        if (line.rfind("## ", 0) == 0) inside = line == "## " + core;
        if (!inside || line.rfind("| ", 0) != 0) continue;
        line.erase(std::remove(line.begin(), line.end(), ','), line.end());
        std::replace(line.begin(), line.end(), '|', ' ');
        std::istringstream cells{line};
        std::string name;
        StageBound b;
        if (cells >> name >> b.flash >> b.ram >> b.stack_used >> b.stack_bound >> b.min >> b.mean >>
            b.worst_found >> b.bound >> b.any_operands >> b.flush_worst)
            bounds[name] = b;
    }
    if (bounds.empty()) throw BadData(path + ": no bounds of a core '" + core + "'");
    return bounds;
}

std::vector<std::uint32_t> read_counts(const std::string& path) {
    const std::string bytes = read_bytes(path);
    if (bytes.size() % 4 != 0) throw BadData(path + ": not a whole number of counts");
    std::vector<std::uint32_t> counts(bytes.size() / 4);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        counts[i / 4] |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i]))
                         << (8 * (i % 4));
    return counts;
}

}  // namespace fairlead::sim
