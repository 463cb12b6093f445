#include "examples/gateway/service.hpp"

#include <poll.h>
#include <sysexits.h>

#include <algorithm>
#include <cstring>

#include "examples/gateway/follower.hpp"
#include "examples/gateway/log.hpp"
#include "host_sim/recording/recording.hpp"
#include "port/linux/clock.hpp"

namespace fairlead::gateway {
namespace {

constexpr std::int64_t collect_every_ns = 20 * port::ms;  // far below what the feeds can hold
constexpr std::size_t poll_max = port::ModbusTcpServer::poll_max + 2;
constexpr std::uint16_t blocks_end = port::registers::events_begin;

}  // namespace

Service::~Service() = default;

std::unique_ptr<Service::Unit> Service::open_unit(const UnitConfig& config) {
    auto unit = std::make_unique<Unit>();
    unit->config = config;
    try {
        switch (config.source) {
            case SourceKind::replay: unit->source = make_replay(config); break;
            case SourceKind::serial: unit->source = make_board(config); break;
            case SourceKind::sensor: unit->source = make_sensor(config); break;
        }
    } catch (const sim::BadData& error) {
        throw StartError{EX_NOINPUT, error.what()};
    }
    return unit;
}

void Service::open_server(const Config& config) {
    tcp_.reset();
    rtu_.reset();
    ports_.clear();
    auto tcp = std::make_unique<port::ModbusTcpServer>(*this, counters_);
    if (tcp->open(config.limits) != Status::ok) throw StartError{EX_OSERR, "no memory"};
    for (const port::Network& network : config.allow) {
        if (tcp->allow(network) != Status::ok) throw StartError{EX_CONFIG, "too many networks"};
    }
    for (const port::Endpoint& endpoint : config.listen) {
        int error = 0;
        const auto bound = tcp->listen(endpoint, &error);
        if (!bound) {
            throw StartError{EX_UNAVAILABLE, "cannot listen on port " +
                                                 std::to_string(endpoint.port) + ": " +
                                                 std::strerror(error)};
        }
        ports_.push_back(*bound);
    }
    tcp_ = std::move(tcp);
    if (!config.rtu) return;
    rtu_ = std::make_unique<port::ModbusRtuServer>(*this, counters_);
    const port::ModbusRtuConfig rtu{config.rtu->device.c_str(), config.rtu->line, config.rtu->rs485,
                                    0};
    const Status status = rtu_->open(rtu, port::now_ns());
    if (status == Status::bad_argument) throw StartError{EX_CONFIG, "rtu: wrong settings"};
    if (status != Status::ok) {
        LogLine{Level::warning, "rtu line not there"}
            .add("device", config.rtu->device)
            .add("why", to_string(status));
    }
}

void Service::apply(const Config& config) {
    std::vector<std::unique_ptr<Unit>> fresh;
    for (const UnitConfig& wanted : config.units) {
        const bool kept = std::any_of(units_.begin(), units_.end(),
                                      [&](const auto& unit) { return unit->config == wanted; });
        if (!kept) fresh.push_back(open_unit(wanted));
    }
    const bool new_server = !running_ || !same_server(config, config_);
    config_ = config;  // the RTU server keeps a pointer to its device's name
    if (new_server) open_server(config_);
    units_.erase(std::remove_if(units_.begin(), units_.end(),
                                [&](const auto& unit) {
                                    return std::find(config.units.begin(), config.units.end(),
                                                     unit->config) == config.units.end();
                                }),
                 units_.end());
    for (auto& unit : fresh) {
        const std::uint32_t epoch = new_epoch();
        const UnitConfig& c = unit->config;
        unit->table.begin(static_cast<std::uint8_t>(c.id), c.name, c.source, epoch,
                          static_cast<std::int64_t>(c.stale_s * 1e9));
        unit->source->start(unit->feed, epoch);
        units_.push_back(std::move(unit));
    }
    by_id_.fill(nullptr);
    for (const auto& unit : units_) by_id_[static_cast<std::size_t>(unit->config.id)] = unit.get();
    server_state_.counters = &counters_;
    running_ = true;
}

bool Service::is_alive(std::int64_t now_ns) const noexcept {
    return std::all_of(units_.begin(), units_.end(),
                       [&](const auto& unit) { return unit->source->is_alive(now_ns); });
}

port::RegisterTable Service::prepare(std::uint8_t unit, std::uint16_t address,
                                     std::uint16_t) noexcept {
    Unit* const found = by_id_[unit];
    if (found == nullptr) return {};
    found->table.collect(found->feed);
    if (address < blocks_end) found->table.refresh(server_state_, port::now_ns());
    return {found->table.registers(), port::registers::map_length};
}

void Service::collect() noexcept {
    for (const auto& unit : units_) unit->table.collect(unit->feed);
}

void Service::serve(int wake_fd, std::int64_t until_ns) noexcept {
    std::array<pollfd, poll_max> polled{};
    while (port::now_ns() < until_ns) {
        std::int64_t wake_ns = std::min(until_ns, port::now_ns() + collect_every_ns);
        polled[0] = {wake_fd, POLLIN, 0};
        std::size_t n = 1;
        const std::int64_t before_ns = port::now_ns();
        n += tcp_->prepare(&polled[n], before_ns, &wake_ns);
        const std::size_t rtu_at = n;
        if (rtu_) n += rtu_->prepare(&polled[n], before_ns, &wake_ns);
        const timespec wait = port::remaining(wake_ns);
        const int ready = ppoll(polled.data(), n, &wait, nullptr);
        if (ready < 0) continue;  // a signal: its descriptor tells
        const std::int64_t now_ns = port::now_ns();
        server_state_.clients = static_cast<std::uint32_t>(tcp_->clients());
        tcp_->serve(&polled[1], now_ns);
        if (rtu_) rtu_->serve(&polled[rtu_at], now_ns);
        collect();
        const auto turn_us = static_cast<std::uint32_t>((port::now_ns() - now_ns) / port::us);
        server_state_.turn_max_us = std::max(server_state_.turn_max_us, turn_us);
        if ((polled[0].revents & POLLIN) != 0) return;
    }
}

}  // namespace fairlead::gateway
