// build/fairlead-gateway-measure: the figures of docs/gateway.md, one command each. Everything runs
// on this machine's loopback and pseudo-terminals. Exit code 1: a promise is not kept.
#include <modbus/modbus.h>
#include <sys/select.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <thread>

#include "examples/gateway/register_map.hpp"
#include "examples/gateway/unit_table.hpp"
#include "port/linux/clock.hpp"
#include "port/linux/modbus_tcp.hpp"
#include "tests/gateway/measure/harness.hpp"

namespace fairlead::gateway::measure {
namespace {

namespace reg = register_map;

struct Options {
    std::string gateway{"build/fairlead-gateway"};
    double seconds{60};
    std::uint64_t reads{1'000'000};
    long growth_kib{0};
    std::string counter{"build/count_allocations.so"};
};

std::uint64_t word(const std::uint16_t* live, const char* name) {
    const reg::Field& row = reg::field(name);
    return reg::get(live + (row.address - reg::live_begin), width_of(row.type));
}
std::uint64_t unit_word(Client& client, const char* name) {
    const reg::Field& row = reg::field(name);
    std::array<std::uint16_t, 4> words{};
    client.read(row.address, width_of(row.type), words.data());
    return reg::get(words.data(), width_of(row.type));
}

// ---- torn reads

/// One unit in front of the real table and server; its state is written at 1 kHz from elsewhere.
class OneUnit final : public port::RegisterBank {
  public:
    OneUnit() {
        server_.counters = &counters;
        table_->begin(1, "torn", SourceKind::sensor, 7, 2'000'000'000);
    }
    port::RegisterTable prepare(std::uint8_t, std::uint16_t, std::uint16_t) noexcept override {
        table_->collect(feed);
        table_->refresh(server_, port::now_ns());
        return {table_->registers(), reg::map_length};
    }
    UnitFeed feed;
    port::ModbusCounters counters;

  private:
    std::unique_ptr<UnitTable> table_ = std::make_unique<UnitTable>();
    ServerState server_{};
};

UnitState state_number(std::uint32_t n) {
    const auto f = static_cast<float>(n & 0xFFFF);
    UnitState s;
    s.epoch = 7;
    s.sequence = n;
    s.source_ns = n;
    s.t_ns = std::int64_t{n} * 1'000'003;
    s.q_wb = {f, f + 1, f + 2, f + 3};
    s.p_w_m = {f + 4, f + 5, f + 6};
    s.rate_rad_s = {f + 7, f + 8, f + 9};
    s.v_w_m_s = {f + 10, f + 11, f + 12};
    return s;
}

bool is_whole(const std::uint16_t* live) {
    const auto n = static_cast<std::uint32_t>(word(live, "live.seq_begin"));
    const UnitState s = state_number(n);
    bool whole = word(live, "live.seq_end") == n &&
                 static_cast<std::int64_t>(word(live, "live.t_ns")) == s.t_ns;
    for (std::uint16_t i = 0; i < 13; ++i) {
        whole = whole && reg::get_f32(live + 8 + 2 * i) == s.q_wb.w + static_cast<float>(i);
    }
    return whole || n == 0;
}

int torn(const Options& options) {
    const auto unit = std::make_unique<OneUnit>();
    port::ModbusTcpLimits limits;
    limits.requests_per_second = 0;
    const auto server = std::make_unique<port::ModbusTcpServer>(*unit, unit->counters);
    int error = 0;
    if (server->open(limits) != Status::ok) return 70;
    if (server->allow(*port::parse_network("127.0.0.0/8")) != Status::ok) return 70;
    const auto bound = server->listen(*port::parse_endpoint("127.0.0.1:0"), &error);
    if (!bound) return 70;
    std::atomic<bool> stop{false};
    std::thread writer{[&] {
        std::int64_t next_ns = port::now_ns();
        for (std::uint32_t n = 1; !stop; ++n) {
            unit->feed.state.write(state_number(n));
            port::sleep_until(next_ns += port::ms);
        }
    }};
    std::thread serving{[&] {
        std::array<pollfd, port::ModbusTcpServer::poll_max> polled{};
        while (!stop) {
            std::int64_t wake_ns = port::now_ns() + 20 * port::ms;
            const std::size_t n = server->prepare(polled.data(), port::now_ns(), &wake_ns);
            const timespec wait = port::remaining(wake_ns);
            ppoll(polled.data(), n, &wait, nullptr);
            server->serve(polled.data(), port::now_ns());
        }
    }};
    std::atomic<std::uint64_t> torn_reads{0}, failed{0}, changes{0};
    std::vector<std::thread> clients;
    constexpr unsigned readers = 4;
    for (unsigned c = 0; c < readers; ++c) {
        clients.emplace_back([&] {
            Client client{*bound, 1};
            std::uint64_t before = 0;
            for (std::uint64_t i = 0; i < options.reads / readers; ++i) {
                std::array<std::uint16_t, reg::live_size> live{};
                if (!client.read(reg::live_begin, reg::live_size, live.data()))
                    ++failed;
                else if (!is_whole(live.data()))
                    ++torn_reads;
                const std::uint64_t now = word(live.data(), "live.seq_begin");
                changes += now != before ? 1u : 0u;
                before = now;
            }
        });
    }
    for (std::thread& client : clients) client.join();
    stop = true;
    writer.join();
    serving.join();
    std::printf("reads %llu, torn %llu, failed %llu, of different publications %llu\n",
                static_cast<unsigned long long>(options.reads),
                static_cast<unsigned long long>(torn_reads.load()),
                static_cast<unsigned long long>(failed.load()),
                static_cast<unsigned long long>(changes.load()));
    return torn_reads + failed == 0 ? 0 : 1;
}

// ---- load

/// The pattern of libmodbus's example of a server with many connections: select, modbus_receive,
/// modbus_reply.
class StockServer {
  public:
    StockServer() : context_{modbus_new_tcp("127.0.0.1", 0)} {
        mapping_ = modbus_mapping_new(0, 0, 256, 0);
        // port 0 is refused by libmodbus: take one that is free now
        for (port_ = 21502; listener_ < 0 && port_ < 21600; ++port_) {
            modbus_free(context_);
            context_ = modbus_new_tcp("127.0.0.1", port_);
            listener_ = modbus_tcp_listen(context_, 64);
        }
        --port_;
        thread_ = std::thread{[this] { run(); }};
    }
    ~StockServer() {
        stop_ = true;
        thread_.join();
        close(listener_);
        modbus_mapping_free(mapping_);
        modbus_free(context_);
    }
    int port() const { return port_; }

  private:
    void run() {
        fd_set all;
        FD_ZERO(&all);
        FD_SET(listener_, &all);
        int highest = listener_;
        while (!stop_) {
            fd_set ready = all;
            timeval wait{0, 50000};
            if (select(highest + 1, &ready, nullptr, nullptr, &wait) <= 0) continue;
            for (int fd = 0; fd <= highest; ++fd) {
                if (!FD_ISSET(fd, &ready)) continue;
                if (fd == listener_) {
                    const int fresh = accept(listener_, nullptr, nullptr);
                    if (fresh < 0 || fresh >= FD_SETSIZE) continue;
                    FD_SET(fresh, &all);
                    highest = std::max(highest, fresh);
                    continue;
                }
                modbus_set_socket(context_, fd);
                std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> query{};
                const int got = modbus_receive(context_, query.data());
                if (got > 0) {
                    modbus_reply(context_, query.data(), got, mapping_);
                } else if (got == -1) {
                    close(fd);
                    FD_CLR(fd, &all);
                }
            }
        }
        for (int fd = 0; fd <= highest; ++fd) {
            if (FD_ISSET(fd, &all) && fd != listener_) close(fd);
        }
    }
    modbus_t* context_;
    modbus_mapping_t* mapping_{};
    int listener_{-1};
    int port_{};
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

constexpr int boards_count = 8;
constexpr int clients_count = 32;

std::vector<std::unique_ptr<BoardOnLine>> make_boards(int count, double damaged_share) {
    std::vector<std::unique_ptr<BoardOnLine>> boards;
    for (int i = 0; i < count; ++i) {
        boards.push_back(std::make_unique<BoardOnLine>(
            BoardOnLine::Settings{400, static_cast<unsigned>(i + 1), damaged_share}));
    }
    return boards;
}
std::vector<std::string> arguments_for(const std::vector<std::unique_ptr<BoardOnLine>>& boards,
                                       const std::string& listen) {
    std::vector<std::string> arguments{"--listen", listen};
    for (const auto& board : boards) {
        arguments.emplace_back("--serial");
        arguments.push_back(board->device());
    }
    return arguments;
}

void show(const char* name, Latencies& all) {
    std::printf(
        "%-28s requests %zu, failed %llu, p50 %.0f us, p99 %.0f us, p99.9 %.0f us, max %.0f us\n",
        name, all.us.size(), static_cast<unsigned long long>(all.failed),
        static_cast<double>(all.at(0.5)), static_cast<double>(all.at(0.99)),
        static_cast<double>(all.at(0.999)), static_cast<double>(all.at(1)));
}

constexpr int load_turns = 6;

int load(const Options& options) {
    bool late = false;
    Latencies quiet, attacked;
    {
        const auto boards = make_boards(boards_count, 0);
        GatewayProcess gateway{options.gateway, arguments_for(boards, "127.0.0.1:0")};
        for (const auto& board : boards) board->start();
        port::sleep_until(port::now_ns() + 2 * port::second);
        // in turns, so that whatever else this machine does falls on both alike
        for (int turn = 0; turn < 2 * load_turns; ++turn) {
            std::unique_ptr<Hostile> enemy;
            if (turn % 2 == 1) enemy = std::make_unique<Hostile>(gateway.port(), false);
            (turn % 2 == 1 ? attacked : quiet)
                .add(poll_all(gateway.port(), boards_count, clients_count, 50,
                              options.seconds / load_turns));
        }
        show("gateway", quiet);
        show("gateway, hostile client", attacked);
        std::uint64_t publications = 0, misses = 0, worst_us = 0, damaged = 0;
        for (int unit = 1; unit <= boards_count; ++unit) {
            Client client{gateway.port(), unit};
            publications += unit_word(client, "health.publications");
            misses += unit_word(client, "health.deadline_misses");
            damaged += unit_word(client, "health.frames_damaged");
            worst_us = std::max(worst_us, unit_word(client, "health.publish_max_us"));
        }
        std::printf(
            "  8 boards at 400 Hz: publications %llu, later than 5 ms %llu, latest %llu us, "
            "damaged frames %llu\n",
            static_cast<unsigned long long>(publications), static_cast<unsigned long long>(misses),
            static_cast<unsigned long long>(worst_us), static_cast<unsigned long long>(damaged));
        late = late || misses > 0 || publications == 0;
    }
    for (const bool hostile : {false, true}) {
        StockServer stock;
        std::unique_ptr<Hostile> enemy;
        if (hostile) enemy = std::make_unique<Hostile>(stock.port(), false);
        Latencies all = poll_all(stock.port(), boards_count, clients_count, 50,
                                 std::min(options.seconds, 10.0));
        show(hostile ? "stock server, hostile client" : "stock server", all);
    }
    const float ratio = attacked.at(0.999) / quiet.at(0.999);
    std::printf("p99.9 with the hostile client: %.2f times that without\n",
                static_cast<double>(ratio));
    return !late && ratio <= 2 ? 0 : 1;
}

// ---- memory

int memory(const Options& options) {
    const auto boards = make_boards(2, 0.01);
    GatewayProcess gateway{options.gateway, arguments_for(boards, "127.0.0.1:0")};
    for (const auto& board : boards) board->start();
    const Hostile enemy{gateway.port(), true};
    std::thread polling{[&] { poll_all(gateway.port(), 2, 8, 50, options.seconds); }};
    const std::int64_t began_ns = port::now_ns();
    port::sleep_until(began_ns + 10 * port::second);
    const long early = gateway.resident_kib();
    polling.join();
    const long late = gateway.resident_kib();
    std::printf("resident after 10 s: %ld KiB, after %.0f s of hostile load: %ld KiB\n", early,
                options.seconds, late);
    return late <= early + options.growth_kib ? 0 : 1;
}

// ---- allocations

/// The allocator's calls once it serves: boards with damage, clients, hostile ones. A gateway that
/// is given FAIRLEAD_ALLOCATIONS and the counting library tells them in a file.
int allocations(const Options& options) {
    const std::string path = "/tmp/fairlead_allocations_" + std::to_string(getpid());
    std::ofstream{path}.write("\0\0\0\0\0\0\0\0", 8);
    const auto count = [&] {
        std::uint64_t n = 0;
        std::ifstream{path}.read(reinterpret_cast<char*>(&n), sizeof n);
        return n;
    };
    const auto boards = make_boards(2, 0.01);
    setenv("FAIRLEAD_ALLOCATIONS", path.c_str(), 1);
    setenv("LD_PRELOAD", options.counter.c_str(), 1);
    GatewayProcess gateway{options.gateway, arguments_for(boards, "127.0.0.1:0")};
    unsetenv("LD_PRELOAD");
    for (const auto& board : boards) board->start();
    std::uint64_t early = 0, late = 0;
    {
        const Hostile enemy{gateway.port(), true};
        poll_all(gateway.port(), 2, 8, 50, 2);
        early = count();
        poll_all(gateway.port(), 2, 8, 50, options.seconds);
        late = count();
    }
    unlink(path.c_str());
    std::printf("calls of the allocator: %llu up to 2 s, %llu in the %.0f s after\n",
                static_cast<unsigned long long>(early),
                static_cast<unsigned long long>(late - early), options.seconds);
    return early > 0 && late == early ? 0 : 1;
}

// ---- history, damage, restart

int history(const Options& options, double damaged_share) {
    const auto boards = make_boards(1, damaged_share);
    GatewayProcess gateway{options.gateway, arguments_for(boards, "127.0.0.1:0")};
    boards[0]->start();
    Client client{gateway.port(), 1};
    CurveReader reader{[&](std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
        return client.read(address, count, out);
    }};
    if (reader.identify() != PollResult::ok) return 1;
    bool good = true;
    for (double s = 0; s < options.seconds && good; s += 1) {
        port::sleep_until(port::now_ns() + port::second);
        const PollResult result = reader.poll();
        good = result == PollResult::ok || reader.epoch() == 0;
    }
    boards[0]->stop();
    port::sleep_until(port::now_ns() + 200 * port::ms);
    good = good && reader.poll() == PollResult::ok;
    const Deviation d = compare(reader, boards[0]->poses());
    const auto& c = reader.counters();
    std::printf(
        "samples %zu, covered %zu, largest deviation %.6f m %.6f rad; spans %llu, lost %llu, "
        "requests %llu, registers %llu\n",
        d.samples, d.covered, d.worst_m, d.worst_rad, static_cast<unsigned long long>(c.spans),
        static_cast<unsigned long long>(c.lost_spans), static_cast<unsigned long long>(c.requests),
        static_cast<unsigned long long>(c.registers));
    const auto health = [&](const char* name) {
        return static_cast<unsigned long long>(unit_word(client, name));
    };
    std::printf(
        "bytes sent %llu, damaged %llu; frames good %llu, breaks %llu, bytes skipped %llu, "
        "curves back in step %llu times\n",
        static_cast<unsigned long long>(boards[0]->bytes()),
        static_cast<unsigned long long>(boards[0]->damaged()), health("health.frames"),
        health("health.breaks"), health("health.bytes_skipped"), health("health.resyncs"));
    const bool within = d.worst_m <= static_cast<double>(BoardOnLine::tolerance_m) &&
                        d.worst_rad <= static_cast<double>(BoardOnLine::tolerance_rad);
    // the reducers still hold their delay's worth of samples when the board falls silent
    const bool all = damaged_share > 0 || d.covered + 130 >= d.samples;
    return good && within && all && c.lost_spans == 0 ? 0 : 1;
}

int restart(const Options& options) {
    const auto boards = make_boards(1, 0);
    boards[0]->start();
    auto gateway =
        std::make_unique<GatewayProcess>(options.gateway, arguments_for(boards, "127.0.0.1:0"));
    const std::string listen = "127.0.0.1:" + std::to_string(gateway->port());
    port::sleep_until(port::now_ns() + 5 * port::second);
    auto client = std::make_unique<Client>(gateway->port(), 1);  // it must ask at once
    CurveReader reader{[&](std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
        return client->read(address, count, out);
    }};
    if (reader.poll() != PollResult::ok) return 1;
    const std::uint32_t first = reader.epoch();
    const std::size_t spans = reader.spans(port::CurveChannel::orientation).size();
    gateway->kill_hard();
    const PollResult dead = reader.poll();
    gateway = std::make_unique<GatewayProcess>(options.gateway, arguments_for(boards, listen));
    port::sleep_until(port::now_ns() + 5 * port::second);
    client = std::make_unique<Client>(gateway->port(), 1);
    const PollResult after = reader.poll();
    const bool unmixed = reader.spans(port::CurveChannel::orientation).size() == spans;
    reader.begin_run();
    const bool second = reader.poll() == PollResult::ok && reader.epoch() != first;
    boards[0]->stop();
    const Deviation d = compare(reader, boards[0]->poses());
    std::printf(
        "after kill -9: %s; after the restart: %s, %s; second run: covered %zu samples, "
        "largest deviation %.6f m %.6f rad\n",
        dead == PollResult::no_answer ? "no answer" : "ANSWERED",
        after == PollResult::new_run ? "a new run is told" : "NOT TOLD",
        unmixed ? "nothing was mixed" : "MIXED", d.covered, d.worst_m, d.worst_rad);
    return dead == PollResult::no_answer && after == PollResult::new_run && unmixed && second &&
                   d.covered > 0 && d.worst_m <= static_cast<double>(BoardOnLine::tolerance_m)
               ? 0
               : 1;
}

}  // namespace
}  // namespace fairlead::gateway::measure

int main(int argc, char** argv) {
    using namespace fairlead::gateway::measure;
    CLI::App app{"Measures what docs/gateway.md promises"};
    Options options;
    int result = 0;
    app.require_subcommand(1);
    app.add_option("--gateway", options.gateway, "program to measure");
    app.add_option("--seconds", options.seconds, "duration of load, memory, history and noise");
    app.add_option("--growth", options.growth_kib, "KiB that memory may grow: a sanitizer's own");
    app.add_option("--reads", options.reads, "of torn");
    app.add_subcommand("torn", "live block read while it is written at 1 kHz")->callback([&] {
        result = torn(options);
    });
    app.add_subcommand("load", "32 clients at 50 Hz, 8 boards at 400 Hz, and a hostile client")
        ->callback([&] { result = load(options); });
    app.add_subcommand("memory", "resident memory under hostile load")->callback([&] {
        result = memory(options);
    });
    app.add_subcommand("allocations", "calls of the allocator once it serves")->callback([&] {
        result = allocations(options);
    });
    app.add_subcommand("history", "a poller of once a second rebuilds the motion")->callback([&] {
        result = history(options, 0);
    });
    app.add_subcommand("noise", "the same with 1 % of the line's bytes damaged")->callback([&] {
        result = history(options, 0.01);
    });
    app.add_subcommand("noise-table", "what damage costs, over restart interval and delay")
        ->callback([&] { result = noise_table(options.seconds); });
    app.add_subcommand("restart", "kill -9 and restart: two runs are never mixed")->callback([&] {
        result = restart(options);
    });
    CLI11_PARSE(app, argc, argv);
    return result;
}
