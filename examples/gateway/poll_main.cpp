// build/fairlead-poll: asks a gateway once a second, rebuilds the motion of one unit and writes it
// as a TUM trajectory. A run that ends (the gateway or its source began anew) ends the file, too.
//
// Exit codes: 0 all of the run was read, 1 spans were lost or a sample is beyond --tolerance-*,
// 64 wrong flags, 66 the --like recording cannot be read, 69 no answer, 73 the file cannot be
// written.
#include <modbus/modbus.h>
#include <sysexits.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <memory>

#include "examples/gateway/reader.hpp"
#include "fairlead/math/quat.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/recording.hpp"
#include "port/linux/clock.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::gateway;
using port::CurveChannel;
using port::CurveSpan;
namespace status_bit = port::registers::status_bit;

constexpr int patience = 10;  // polls without an answer before giving up

struct Options {
    std::string host{"127.0.0.1"};
    int port{1502};
    int unit{1};
    std::string out;
    double every_s{1};
    double seconds{};
    double rate_hz{100};
    std::string events;
    std::string like;
    double tolerance_m{};
    double tolerance_deg{};
};

volatile std::sig_atomic_t interrupted = 0;

class Link {
  public:
    explicit Link(const Options& options)
        : context_{modbus_new_tcp_pi(options.host.c_str(), std::to_string(options.port).c_str())},
          unit_{options.unit} {
        modbus_set_slave(context_, unit_);
        modbus_set_response_timeout(context_, 2, 0);
    }
    ~Link() {
        close();
        modbus_free(context_);
    }
    Link(const Link&) = delete;
    Link& operator=(const Link&) = delete;

    bool read(std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
        if (!connected_) connected_ = modbus_connect(context_) == 0;
        if (!connected_) return false;
        if (modbus_read_registers(context_, address, count, out) == count) return true;
        close();
        return false;
    }

  private:
    void close() {
        if (connected_) modbus_close(context_);
        connected_ = false;
    }

    modbus_t* context_;
    int unit_;
    bool connected_{};
};

/// Writes poses at the wanted times as soon as both curves are final there.
class Trajectory {
  public:
    Trajectory(const Options& options, const std::vector<Pose>& like)
        : options_{options}, like_{like} {}

    bool open(int run) {
        std::string path = options_.out;
        if (path.empty()) return true;
        if (run > 1) {
            const std::size_t dot = path.rfind('.');
            path.insert(dot == std::string::npos ? path.size() : dot, "-" + std::to_string(run));
        }
        file_.reset(std::fopen(path.c_str(), "w"));
        started_ = false;
        next_ = 0;
        return file_ != nullptr;
    }

    /// @param all the run is over: what one channel never covered is not waited for.
    void write(CurveReader& reader, bool all) {
        const auto& orientation = reader.spans(CurveChannel::orientation);
        const auto& position = reader.spans(CurveChannel::position);
        if (orientation.empty() && position.empty()) return;
        const std::int64_t o = reader.covered_until_ns(CurveChannel::orientation);
        const std::int64_t p = reader.covered_until_ns(CurveChannel::position);
        const bool both = !orientation.empty() && !position.empty();
        const std::int64_t until_ns = both && !all ? std::min(o, p) : std::max(o, p);
        if (!started_) {
            started_ = true;
            first_ns_ = orientation.empty() ? position.begin()->second.t0_ns
                                            : orientation.begin()->second.t0_ns;
        }
        std::int64_t t_ns = 0;
        while (next_time(t_ns) && t_ns <= until_ns) {
            row(reader, t_ns);
            ++next_;
        }
        reader.drop_before(std::min(t_ns, until_ns));
        if (file_) std::fflush(file_.get());
    }

    std::size_t rows() const { return rows_; }
    double worst_m() const { return worst_m_; }
    double worst_deg() const { return worst_deg_; }

  private:
    bool next_time(std::int64_t& t_ns) const {
        if (!like_.empty()) {
            if (next_ >= like_.size()) return false;
            t_ns = like_[next_].t_ns;
            return true;
        }
        t_ns = first_ns_ +
               static_cast<std::int64_t>(static_cast<double>(next_) * 1e9 / options_.rate_hz);
        return true;
    }

    void row(const CurveReader& reader, std::int64_t t_ns) {
        const CurveSpan* o = reader.covering(CurveChannel::orientation, t_ns);
        const CurveSpan* p = reader.covering(CurveChannel::position, t_ns);
        if (o == nullptr && p == nullptr) return;  // a gap
        const Quat q = o != nullptr ? port::curve::orientation(*o, t_ns) : Quat{};
        const Vec3 at = p != nullptr ? port::curve::position(*p, t_ns) : Vec3{};
        if (!like_.empty())
            compare(like_[next_], o != nullptr ? &q : nullptr, p != nullptr ? &at : nullptr);
        ++rows_;
        if (!file_) return;
        std::fprintf(file_.get(), "%" PRId64 ".%09" PRId64 " %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n",
                     t_ns / port::second, t_ns % port::second, static_cast<double>(at.x),
                     static_cast<double>(at.y), static_cast<double>(at.z), static_cast<double>(q.x),
                     static_cast<double>(q.y), static_cast<double>(q.z), static_cast<double>(q.w));
    }

    void compare(const Pose& pose, const Quat* q, const Vec3* at) {
        if (q != nullptr && (pose.flags & flag::orientation_valid) != 0) {
            const double angle = static_cast<double>(rotation_angle(*q, normalised(pose.q_wb)));
            worst_deg_ = std::max(worst_deg_, angle * 57.29577951308232);
        }
        if (at != nullptr && (pose.flags & flag::position_valid) != 0) {
            const Vec3 d = *at - pose.p_w_m;
            for (const float e : {d.x, d.y, d.z}) {
                worst_m_ = std::max(worst_m_, static_cast<double>(e < 0 ? -e : e));
            }
        }
    }

    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };

    const Options& options_;
    const std::vector<Pose>& like_;
    std::unique_ptr<std::FILE, Close> file_;
    bool started_{};
    std::int64_t first_ns_{};
    std::size_t next_{};
    std::size_t rows_{};
    double worst_m_{};
    double worst_deg_{};
};

/// One line per event. @return false when the file cannot be written.
bool write_events(const std::string& path, const std::vector<FeedEvent>& events) {
    if (path.empty()) return true;
    std::FILE* const file = std::fopen(path.c_str(), "w");
    if (file == nullptr) return false;
    std::fputs("t_ns,channel,value\n", file);
    for (const FeedEvent& e : events)
        std::fprintf(file, "%" PRId64 ",%d,%d\n", e.t_ns, int{e.channel}, int{e.value});
    return std::fclose(file) == 0;
}

int run(const Options& options, const std::vector<Pose>& like) {
    Link link{options};
    CurveReader reader{[&](std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
        return link.read(address, count, out);
    }};
    Trajectory trajectory{options, like};
    int runs = 1;
    if (!trajectory.open(runs)) return EX_CANTCREAT;
    sim::Progress progress{"poll", 0, "spans"};
    const std::int64_t began_ns = port::now_ns();
    const auto every_ns = static_cast<std::int64_t>(options.every_s * 1e9);
    std::int64_t next_ns = began_ns;
    int silent = 0;
    bool identified = false;
    bool over = false;
    for (std::uint64_t polls = 1; !over; ++polls) {
        PollResult result = identified ? PollResult::ok : reader.identify();
        identified = identified || result == PollResult::ok;
        if (result == PollResult::ok) result = reader.poll();
        if (result == PollResult::not_a_gateway) {
            std::fputs("fairlead-poll: that is not this register map\n", stderr);
            return EX_PROTOCOL;
        }
        silent = result == PollResult::no_answer ? silent + 1 : 0;
        if (silent == 1) std::fprintf(stderr, "no answer: %s\n", modbus_strerror(errno));
        if (silent == patience) return EX_UNAVAILABLE;
        const double seconds_passed = static_cast<double>(port::now_ns() - began_ns) * 1e-9;
        const bool ended = options.seconds > 0 && seconds_passed > options.seconds;
        over = interrupted != 0 || ended ||
               (result == PollResult::ok && (reader.status() & status_bit::finished) != 0);
        progress.show(reader.counters().spans,
                      options.seconds > 0 ? seconds_passed / options.seconds : 0);
        trajectory.write(reader, over || result == PollResult::new_run);
        if (result == PollResult::new_run) {
            std::fprintf(stderr, "epoch %08" PRIx32 " ended: a new run begins\n", reader.epoch());
            reader.begin_run();
            if (!trajectory.open(++runs)) return EX_CANTCREAT;
            continue;
        }
        if (over) break;
        next_ns += every_ns;
        port::sleep_until(next_ns);
    }
    if (!write_events(options.events, reader.events())) return EX_CANTCREAT;
    const auto& c = reader.counters();
    std::printf("runs %d, rows %zu, spans %" PRIu64 ", lost spans %" PRIu64 ", requests %" PRIu64
                ", registers %" PRIu64 "\n",
                runs, trajectory.rows(), c.spans, c.lost_spans, c.requests, c.registers);
    if (!like.empty()) {
        std::printf("largest deviation: %.6f m, %.6f deg\n", trajectory.worst_m(),
                    trajectory.worst_deg());
    }
    const bool beyond =
        (options.tolerance_m > 0 && trajectory.worst_m() > options.tolerance_m) ||
        (options.tolerance_deg > 0 && trajectory.worst_deg() > options.tolerance_deg);
    return c.lost_spans > 0 || beyond ? 1 : EX_OK;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Rebuilds the motion of one unit of a gateway from its polled registers"};
    Options options;
    app.add_option("host", options.host, "numeric address or name of the gateway");
    app.add_option("-p,--port", options.port, "TCP port")->check(CLI::Range(1, 65535));
    app.add_option("-u,--unit", options.unit, "unit identifier")->check(CLI::Range(1, 247));
    app.add_option("-o,--out", options.out, "trajectory (TUM) to write");
    app.add_option("--events", options.events, "events of the last run (CSV) to write");
    app.add_option("--every", options.every_s, "seconds from poll to poll")
        ->check(CLI::Range(0.01, 3600.0));
    app.add_option("--seconds", options.seconds, "stop after so long; 0: when a replay has ended");
    app.add_option("--rate", options.rate_hz, "rows per second of motion")
        ->check(CLI::Range(0.01, 100000.0));
    app.add_option("--like", options.like, "rows at this recording's times, compared with it");
    app.add_option("--tolerance-m", options.tolerance_m, "with --like: largest deviation allowed");
    app.add_option("--tolerance-deg", options.tolerance_deg, "with --like: the same as an angle");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? EX_OK : EX_USAGE;
    }
    for (const int signal : {SIGINT, SIGTERM}) {
        struct sigaction action {};
        action.sa_handler = [](int) { interrupted = 1; };
        sigaction(signal, &action, nullptr);
    }
    std::vector<Pose> like;
    if (!options.like.empty()) {
        try {
            sim::ReadOptions how;
            how.progress = sim::progress_steps("read", "bytes");
            like = sim::poses_of(sim::read_recording(options.like, how));
        } catch (const sim::BadData& error) {
            std::fprintf(stderr, "fairlead-poll: %s\n", error.what());
            return EX_NOINPUT;
        }
    }
    return run(options, like);
}
