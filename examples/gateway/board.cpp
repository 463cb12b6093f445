// A board on a serial line as a source. The line may come and go, lose bytes or add noise: whatever
// is not a good frame is counted and dropped, and the decoder is back in step behind the next
// restart frame.
#include <poll.h>

#include <algorithm>
#include <array>

#include "examples/gateway/clock_map.hpp"
#include "examples/gateway/follower.hpp"
#include "examples/gateway/source.hpp"
#include "port/linux/clock.hpp"
#include "port/linux/serial.hpp"

namespace fairlead::gateway {
namespace {

namespace status_bit = port::registers::status_bit;

constexpr std::int64_t reopen_ns = 500 * port::ms;
constexpr int listen_ms = 50;

class Board : public Source {
  public:
    explicit Board(const UnitConfig& unit) : unit_{unit} {}
    ~Board() override { stop(); }

  protected:
    void run(UnitFeed& feed, UnitState& state) override {
        const auto follower =
            std::make_unique<CurveFollower>(feed, state, CurveFollower::WhenFull::drop);
        while (!stopping()) {
            const Status status = line_.open(unit_.device.c_str(), unit_.line);
            if (status == Status::ok) {
                ++state.opened;
                LogLine{Level::info, "line opened"}
                    .add("unit", unit_.id)
                    .add("device", unit_.device);
                set_lost(feed, state, false);
                listen(*follower, feed, state);
                line_.close();
                if (stopping()) return;
                ++state.lost;
                LogLine{Level::warning, "line lost"}
                    .add("unit", unit_.id)
                    .add("device", unit_.device);
            } else if (state.opened == 0 && !told_) {
                told_ = true;
                LogLine{Level::warning, "line not there"}
                    .add("unit", unit_.id)
                    .add("device", unit_.device)
                    .add("why", to_string(status));
            }
            set_lost(feed, state, true);
            sleep_until(port::now_ns() + reopen_ns);
        }
    }

  private:
    static void set_lost(UnitFeed& feed, UnitState& state, bool lost) noexcept {
        state.status = static_cast<std::uint16_t>(state.status & ~status_bit::source_lost);
        if (lost) state.status |= status_bit::source_lost;
        feed.state.write(state);
    }

    void listen(CurveFollower& follower, UnitFeed& feed, UnitState& state) noexcept {
        std::array<std::uint8_t, 4096> bytes{};
        while (!stopping()) {
            pollfd readable{line_.fd(), POLLIN, 0};
            if (poll(&readable, 1, listen_ms) <= 0) continue;
            const std::int64_t arrival_ns = port::now_ns();
            const auto got = line_.read(bytes.data(), bytes.size());
            if (got.status() == Status::disconnected) return;
            if (!got) {
                if ((readable.revents & (POLLHUP | POLLERR)) != 0) return;
                continue;
            }
            const std::uint32_t epoch = state.epoch;
            const bool news = follower.take(bytes.data(), *got);
            if (state.epoch != epoch) clock_.reset();
            if (news) {
                const std::int64_t on_line_ns =
                    static_cast<std::int64_t>(*got) * 10 * port::second / unit_.line.baud;
                const auto& stream = follower.decoder();
                const std::int64_t tick_ns = stream.grid().tick_ns();
                const std::int64_t left_ns =
                    stream.grid().time_ns(stream.frame_end()) + unit_.latency * tick_ns;
                clock_.mark(left_ns, arrival_ns, on_line_ns, tick_ns);
            }
            if (news)
                show(arrival_ns, follower, feed, state);
            else
                feed.state.write(state);
        }
    }

    void show(std::int64_t arrival_ns, CurveFollower& follower, UnitFeed& feed,
              UnitState& state) noexcept {
        follower.evaluate();
        state.arrival_ns = arrival_ns;
        state.period_us =
            static_cast<std::uint32_t>(follower.decoder().grid().tick_ns() / port::us);
        if (clock_.known()) {
            state.t_ns = state.source_ns + clock_.offset_ns();
            state.clock_error_ns = static_cast<std::uint32_t>(
                std::min<std::int64_t>(clock_.error_ns(arrival_ns), UINT32_MAX));
        }
        publish(feed, state);
    }

    UnitConfig unit_;
    port::SerialPort line_;
    ClockMap clock_;
    bool told_{};
};

}  // namespace

std::unique_ptr<Source> make_board(const UnitConfig& unit) { return std::make_unique<Board>(unit); }

}  // namespace fairlead::gateway
