// What a damaged line costs, over damage, restart interval and delay, in virtual time: a board's
// pipeline, a line that spoils bytes, the gateway's follower and registers, a reader that polls
// once a second.
//
// A frame of n bytes arrives whole with p = (1 - e)^n. Out of step, a decoder waits for a restart
// frame that does: a geometric law over the restart frames, one every T, the last of which may be
// held back by a byte that looks like a frame's beginning for as long as the longest frame takes.
// So with the longest restart frame for n, B bytes a second and frames of at most m bytes
//   mean wait <= T / p + m / B,   and 99 % wait less than T (1 + ln(0.01) / ln(1 - p)) + m / B.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <vector>

#include "examples/gateway/follower.hpp"
#include "examples/gateway/unit_table.hpp"
#include "fairlead/pipeline.hpp"
#include "tests/gateway/measure/harness.hpp"

namespace fairlead::gateway::measure {
namespace {

struct Case {
    double damaged;  // share of bytes
    int burst;       // bytes spoilt in a row
    double restart_s;
    std::uint32_t delay;  // records
};

struct Outcome {
    double bytes_per_s{}, restart_bytes{}, restart_bytes_most{};
    double covered{};                   // share of the samples
    double wait_mean_s{}, wait_99_s{};  // out of step
    std::size_t waits{};
    bool wrong{};
};

class SpoilingLine {
  public:
    SpoilingLine(const Case& c, unsigned seed) : case_{c}, random_{seed} {}
    void pass(std::vector<std::uint8_t>& bytes) {
        for (std::uint8_t& byte : bytes) {
            if (left_ == 0 && chance_(random_) < case_.damaged / case_.burst) left_ = case_.burst;
            if (left_ == 0) continue;
            --left_;
            byte ^= static_cast<std::uint8_t>(1 + random_() % 255);
        }
    }

  private:
    const Case& case_;
    std::mt19937 random_;
    std::uniform_real_distribution<double> chance_;
    int left_{0};
};

/// The length of a restart frame, by its first two bytes; 0 for other frames.
std::size_t restart_size(const Bytes& bytes) {
    for (std::size_t at = 0; at + 1 < bytes.size;) {
        const std::uint8_t first = bytes.data[at];
        const bool two = first >= 0x80;
        const std::size_t n = two ? (first & 0x1Fu) * 256u + bytes.data[at + 1] : first;
        const std::size_t whole = (two ? 2 : 1) + n + 2;
        if (first >= 0xC0 && first < 0xE0) return whole;
        at += whole;
    }
    return 0;
}

struct NoiseConfig : PipelineConfig {
    static constexpr std::size_t window = 120;
};

Outcome run(const Case& c, double seconds) {
    const BoardOnLine::Settings settings;
    Pipeline<NoiseConfig>::Params params;
    params.encoder.tol_position_m.fill(BoardOnLine::tolerance_m);
    params.encoder.tol_orientation_rad = BoardOnLine::tolerance_rad;
    params.encoder.tick_ns = static_cast<std::uint32_t>(1e9 / settings.rate_hz);
    params.encoder.restart_interval_ns = static_cast<std::int64_t>(c.restart_s * 1e9);
    params.encoder.delay_max = c.delay;
    const auto board = std::make_unique<Pipeline<NoiseConfig>>(params);
    UnitState state;
    state.epoch = 1;
    const auto feed = std::make_unique<UnitFeed>();
    const auto table = std::make_unique<UnitTable>();
    table->begin(1, "noise", SourceKind::serial, 1, 2'000'000'000);
    const auto follower =
        std::make_unique<CurveFollower>(*feed, state, CurveFollower::WhenFull::drop);
    port::ModbusCounters counters;
    ServerState server;
    server.counters = &counters;
    CurveReader reader{[&](std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
        table->refresh(server, 0);
        std::copy_n(table->registers() + address, count, out);
        return true;
    }};
    SpoilingLine line{c, 7};
    std::vector<Pose> poses;
    std::vector<double> waits;
    Outcome out;
    double bytes = 0, restarts = 0, out_since_s = -1;
    const auto steps = static_cast<std::uint64_t>(seconds * settings.rate_hz);
    for (std::uint64_t i = 0; i < steps; ++i) {
        const double now_s = static_cast<double>(i) / settings.rate_hz;
        poses.push_back(motion_of(settings, i));
        const Bytes frames = board->push(poses.back());
        bytes += static_cast<double>(frames.size);
        if (const std::size_t n = restart_size(frames); n > 0) {
            out.restart_bytes += static_cast<double>(n);
            out.restart_bytes_most = std::max(out.restart_bytes_most, static_cast<double>(n));
            restarts += 1;
        }
        std::vector<std::uint8_t> sent{frames.data, frames.data + frames.size};
        line.pass(sent);
        follower->take(sent.data(), sent.size());
        feed->state.write(state);
        table->collect(*feed);
        const bool in_step = follower->decoder().in_step();
        if (!in_step && out_since_s < 0) out_since_s = now_s;
        if (in_step && out_since_s >= 0) {
            if (out_since_s > 0) waits.push_back(now_s - out_since_s);
            out_since_s = -1;
        }
        if (i % 400 == 399) out.wrong = reader.poll() != PollResult::ok || out.wrong;
    }
    const Deviation d = compare(reader, poses);
    out.wrong = out.wrong || d.worst_m > static_cast<double>(BoardOnLine::tolerance_m) ||
                d.worst_rad > static_cast<double>(BoardOnLine::tolerance_rad);
    out.bytes_per_s = bytes / seconds;
    out.restart_bytes /= restarts;
    out.covered = static_cast<double>(d.covered) / static_cast<double>(d.samples);
    out.waits = waits.size();
    if (waits.empty()) return out;
    for (const double w : waits) out.wait_mean_s += w / static_cast<double>(waits.size());
    std::sort(waits.begin(), waits.end());
    out.wait_99_s = waits[static_cast<std::size_t>(0.99 * static_cast<double>(waits.size() - 1))];
    return out;
}

}  // namespace

int noise_table(double seconds) {
    std::printf(
        "| damaged | bursts of | restart every | delay | bytes/s | restart frame, longest | "
        "covered "
        "| mean wait, bound | 99 %% within, bound |\n"
        "|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
    bool good = true;
    for (const double damaged : {0.0001, 0.001, 0.01}) {
        for (const int burst : {1, 16}) {
            for (const double restart_s : {2.0, 0.5, 0.1}) {
                for (const std::uint32_t delay : {60u, 20u}) {
                    const Case c{damaged, burst, restart_s, delay};
                    const Outcome o = run(c, seconds);
                    // a burst spoils a frame when it begins in it or reaches into it
                    const double whole =
                        std::pow(1 - damaged / burst, o.restart_bytes_most + burst - 1);
                    const double held_s = static_cast<double>(wire::max_frame) / o.bytes_per_s;
                    std::printf(
                        "| %.2f %% | %d | %.1f s | %u | %.0f | %.0f, %.0f | %.1f %% | %.2f s, %.2f "
                        "s | "
                        "%.2f s, %.2f s |%s\n",
                        100 * damaged, burst, restart_s, delay, o.bytes_per_s, o.restart_bytes,
                        o.restart_bytes_most, 100 * o.covered, o.wait_mean_s,
                        restart_s / whole + held_s, o.wait_99_s,
                        restart_s * (1 + std::log(0.01) / std::log(1 - whole)) + held_s,
                        o.wrong ? " WRONG" : "");
                    good = good && !o.wrong;
                }
            }
        }
    }
    return good ? 0 : 1;
}

}  // namespace fairlead::gateway::measure
