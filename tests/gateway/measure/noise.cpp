// What a damaged line costs, over damage, restart interval and delay, in virtual time: a board's
// pipeline, a line that spoils bytes, the gateway's follower and registers, a reader that polls
// once a second.
//
// A frame of n bytes arrives whole with p = (1 - e)^n. Out of step, a decoder waits for a restart
// frame that does, and for two frames behind it that confirm it, n bytes in all: a geometric law
// over the restart frames, one every T: the restart interval, at least two frames (no restart frame
// follows another), rounded up to whole frames. So with F from frame to frame
//   mean wait <= T / p + 2 F,   and 99 % wait less than T (1 + ln(0.01) / ln(1 - p)) + 2 F.
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
    double bytes_per_s{}, restart_bytes{}, restart_bytes_most{}, frame_bytes_most{};
    double frame_s{};                   // from frame to frame
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

/// The length of the data frame among these; 0: there is none.
std::size_t data_frame_size(const Bytes& bytes) {
    for (std::size_t at = 0; at + 1 < bytes.size;) {
        const std::uint8_t first = bytes.data[at];
        if (first <= wire::payload_max) return std::size_t{first} + 3;
        at += 2 + std::size_t{bytes.data[at + 1]} + wire::crc_size;  // a header or events
    }
    return 0;
}

Outcome run(const Case& c, double seconds) {
    const BoardOnLine::Settings settings;
    Pipeline<MeasuredBoard>::Params params;
    params.sample_period_ns = static_cast<std::int64_t>(1e9 / settings.rate_hz);
    params.tolerance.position_m = BoardOnLine::tolerance_m;
    params.tolerance.orientation_rad = BoardOnLine::tolerance_rad;
    params.restart_interval_ns = static_cast<std::int64_t>(c.restart_s * 1e9);
    params.delay_records = c.delay;
    const auto board = std::make_unique<Pipeline<MeasuredBoard>>(params);
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
    double bytes = 0, out_since_s = -1;
    std::uint32_t restarts = 0;
    const auto steps = static_cast<std::uint64_t>(seconds * settings.rate_hz);
    for (std::uint64_t i = 0; i < steps; ++i) {
        const double now_s = static_cast<double>(i) / settings.rate_hz;
        poses.push_back(motion_of(settings, i));
        const Bytes frames = board->push(poses.back());
        bytes += static_cast<double>(frames.size);
        const auto& sender = board->encoder().inner();
        if (const std::size_t n = data_frame_size(frames); n > 0) {
            out.frame_bytes_most = std::max(out.frame_bytes_most, static_cast<double>(n));
            if (sender.restarts() != restarts) {
                out.restart_bytes += static_cast<double>(n);
                out.restart_bytes_most = std::max(out.restart_bytes_most, static_cast<double>(n));
            }
            restarts = sender.restarts();
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
    out.restart_bytes /= std::max(1.0, static_cast<double>(restarts));
    out.frame_s = seconds / std::max(1.0, static_cast<double>(board->encoder().inner().frames()));
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
                        std::pow(1 - damaged / burst,
                                 o.restart_bytes_most + 2 * o.frame_bytes_most + 3 * (burst - 1));
                    const double held_s = 2 * o.frame_s;
                    const double every_s = std::max(restart_s, 2 * o.frame_s) + o.frame_s;
                    std::printf(
                        "| %.2f %% | %d | %.1f s | %u | %.0f | %.0f, %.0f | %.1f %% | %.2f s, %.2f "
                        "s | "
                        "%.2f s, %.2f s |%s\n",
                        100 * damaged, burst, restart_s, delay, o.bytes_per_s, o.restart_bytes,
                        o.restart_bytes_most, 100 * o.covered, o.wait_mean_s,
                        every_s / whole + held_s, o.wait_99_s,
                        every_s * (1 + std::log(0.01) / std::log(1 - whole)) + held_s,
                        o.wrong ? " WRONG" : "");
                    good = good && !o.wrong;
                }
            }
        }
    }
    return good ? 0 : 1;
}

}  // namespace fairlead::gateway::measure
