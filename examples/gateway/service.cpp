#include "examples/gateway/service.hpp"

#include <poll.h>
#include <sysexits.h>

#include <algorithm>
#include <cstring>
#include <new>

#include "examples/gateway/follower.hpp"
#include "examples/gateway/log.hpp"
#include "examples/gateway/text_file.hpp"
#include "host_sim/recording/recording.hpp"
#include "port/linux/clock.hpp"

namespace fairlead::gateway {
namespace {

constexpr std::int64_t collect_every_ns = 20 * port::ms;  // far below what the feeds can hold
constexpr std::size_t poll_max = port::ModbusTcpServer::poll_max + Service::wake_max + 1;
constexpr std::uint16_t blocks_end = port::registers::events_begin;

}  // namespace

Service::Plan::Plan() = default;
Service::Plan::Plan(Plan&&) noexcept = default;
Service::Plan& Service::Plan::operator=(Plan&&) noexcept = default;
Service::Plan::~Plan() = default;
Service::Change::Change() = default;
Service::Change::Change(Change&&) noexcept = default;
Service::Change& Service::Change::operator=(Change&&) noexcept = default;
Service::Change::~Change() = default;

void Service::Change::finish() {
    for (const auto& unit : retired_) unit->source->request_stop();  // all at once, then one by one
    retired_.clear();
    for (Unit* unit : fresh_) unit->source->start(unit->feed, unit->epoch);
    fresh_.clear();
}

Service::~Service() {
    for (const auto& unit : units_) unit->source->request_stop();
}

std::unique_ptr<Service::Unit> Service::open_unit(const UnitConfig& config) {
    auto unit = std::make_unique<Unit>();
    unit->config = config;
    unit->epoch = new_epoch();
    try {
        switch (config.source) {
            case SourceKind::replay:
                if (!is_regular_file(config.file))
                    throw StartError{EX_NOINPUT, config.file + ": no such recording"};
                unit->source = make_replay(config);
                break;
            case SourceKind::serial: unit->source = make_board(config); break;
            case SourceKind::sensor: unit->source = make_sensor(config); break;
        }
    } catch (const std::bad_alloc&) {
        throw StartError{EX_NOINPUT, config.file + ": too large for this machine's memory"};
    } catch (const sim::BadData& error) {
        throw StartError{EX_NOINPUT, error.what()};
    }
    return unit;
}

Service::Plan Service::plan(const Config& config, const std::vector<UnitConfig>& running) {
    Plan plan;
    plan.config_ = config;
    for (const UnitConfig& wanted : config.units)
        if (std::find(running.begin(), running.end(), wanted) == running.end())
            plan.fresh_.push_back(open_unit(wanted));
    return plan;
}

std::vector<UnitConfig> Service::running_units() const {
    std::vector<UnitConfig> out;
    for (const auto& unit : units_) out.push_back(unit->config);
    return out;
}

void Service::change_server(const Config& config) {
    if (!tcp_) {
        auto tcp = std::make_unique<port::ModbusTcpServer>(*this, counters_);
        if (tcp->open(config.limits) != Status::ok) throw StartError{EX_OSERR, "no memory"};
        tcp_ = std::move(tcp);
    }
    int error = 0;
    std::size_t failed = 0;
    const Status status = tcp_->change({config.limits, config.allow.data(), config.allow.size(),
                                        config.listen.data(), config.listen.size()},
                                       &error, &failed);
    if (status == Status::busy) {
        throw StartError{EX_UNAVAILABLE, "cannot listen on " + to_text(config.listen[failed]) +
                                             ": " + std::strerror(error)};
    }
    if (status != Status::ok) throw StartError{EX_CONFIG, "server: wrong limits"};
    ports_.clear();
    for (std::size_t i = 0; i < config.listen.size(); ++i) {
        ports_.push_back(tcp_->port(i));
        const port::Endpoint& at = config.listen[i];
        const bool told =
            std::find(config_.listen.begin(), config_.listen.end(), at) != config_.listen.end();
        if (at.is_loopback() || told) continue;
        LogLine{Level::warning, "listening beyond this machine"}
            .add("address", to_text(at))
            .add("why",
                 "Modbus has no passwords: keep it behind a firewall, and server.allow short");
    }
}

void Service::change_rtu(const Config& config) {
    if (config.rtu == config_.rtu && (rtu_ != nullptr) == config.rtu.has_value()) return;
    rtu_.reset();
    if (!config.rtu) return;
    rtu_device_ = config.rtu->device;
    rtu_ = std::make_unique<port::ModbusRtuServer>(*this, counters_);
    const port::ModbusRtuConfig rtu{rtu_device_.c_str(), config.rtu->line, config.rtu->rs485,
                                    config.rtu->gap_ns};
    const Status status = rtu_->open(rtu, port::now_ns());
    if (status != Status::ok) {
        LogLine{Level::warning, "rtu line not there"}
            .add("device", config.rtu->device)
            .add("why", to_string(status));
    }
}

Service::Change Service::commit(Plan plan) {
    change_server(plan.config_);  // the only part that can fail
    change_rtu(plan.config_);
    Change change;
    const auto& wanted = plan.config_.units;
    for (auto& unit : units_)
        if (std::find(wanted.begin(), wanted.end(), unit->config) == wanted.end())
            change.retired_.push_back(std::move(unit));
    units_.erase(std::remove(units_.begin(), units_.end(), nullptr), units_.end());
    for (auto& unit : plan.fresh_) {
        const UnitConfig& c = unit->config;
        unit->table.begin(static_cast<std::uint8_t>(c.id), c.name, c.source, unit->epoch,
                          static_cast<std::int64_t>(c.stale_s * 1e9));
        change.fresh_.push_back(unit.get());
        units_.push_back(std::move(unit));
    }
    by_id_.fill(nullptr);
    for (const auto& unit : units_) by_id_[static_cast<std::size_t>(unit->config.id)] = unit.get();
    server_state_.counters = &counters_;
    config_ = std::move(plan.config_);
    return change;
}

void Service::apply(const Config& config) { commit(plan(config, running_units())).finish(); }

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

void Service::serve(const std::array<int, wake_max>& wake_fds, std::int64_t until_ns) noexcept {
    std::array<pollfd, poll_max> polled{};
    while (port::now_ns() < until_ns) {
        std::int64_t wake_ns = std::min(until_ns, port::now_ns() + collect_every_ns);
        std::size_t n = 0;
        for (const int fd : wake_fds) polled[n++] = {fd, POLLIN, 0};
        const std::int64_t before_ns = port::now_ns();
        n += tcp_->prepare(&polled[n], before_ns, &wake_ns);
        const std::size_t rtu_at = n;
        if (rtu_) n += rtu_->prepare(&polled[n], before_ns, &wake_ns);
        const timespec wait = port::remaining(wake_ns);
        const int ready = ppoll(polled.data(), n, &wait, nullptr);
        if (ready < 0) continue;  // a signal: its descriptor tells
        const std::int64_t now_ns = port::now_ns();
        server_state_.clients = static_cast<std::uint32_t>(tcp_->clients());
        server_state_.log_dropped = LogWriter::dropped();
        tcp_->serve(&polled[wake_max], now_ns);
        if (rtu_) rtu_->serve(&polled[rtu_at], now_ns);
        collect();
        const auto turn_us = static_cast<std::uint32_t>((port::now_ns() - now_ns) / port::us);
        server_state_.turn_max_us = std::max(server_state_.turn_max_us, turn_us);
        for (std::size_t i = 0; i < wake_max; ++i)
            if ((polled[i].revents & POLLIN) != 0) return;
    }
}

}  // namespace fairlead::gateway
