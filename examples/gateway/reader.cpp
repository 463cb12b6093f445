#include "examples/gateway/reader.hpp"
#include "examples/gateway/register_map.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace fairlead::gateway {
namespace {

namespace reg = register_map;
using port::CurveChannel;
using port::CurveSpan;

constexpr std::uint32_t ring = std::uint32_t{reg::history_pages} * reg::spans_per_page;

/// A field out of registers that were read from `begin` on.
std::uint64_t word(const std::uint16_t* read, std::uint16_t begin, const reg::Field& row) {
    return reg::get(read + (row.address - begin), width_of(row.type));
}

}  // namespace

bool CurveReader::ask(std::uint16_t address, std::uint16_t count, std::uint16_t* out) {
    ++counters_.requests;
    counters_.registers += count;
    return read_(address, count, out);
}

PollResult CurveReader::identify() {
    std::array<std::uint16_t, reg::live_begin> r{};
    if (!ask(0, reg::live_begin, r.data())) return PollResult::no_answer;
    const bool ours = word(r.data(), 0, reg::field("magic")) == reg::magic &&
                      word(r.data(), 0, reg::field("map_version")) >> 8 == reg::map_version >> 8 &&
                      word(r.data(), 0, reg::field("probe.u32")) == 0x0102'0304 &&
                      reg::get_f32(&r[reg::field("probe.f32").address]) == 1.0f;
    return ours ? PollResult::ok : PollResult::not_a_gateway;
}

void CurveReader::begin_run() {
    channels_ = {};
    events_.clear();
    next_event_ = 0;
    epoch_ = 0;
}

PollResult CurveReader::poll() {
    std::array<std::uint16_t, reg::state_size> r{};
    if (!ask(reg::live_begin, reg::state_size, r.data())) return PollResult::no_answer;
    const auto field = [&](const char* name) {
        return word(r.data(), reg::live_begin, reg::field(name));
    };
    const auto epoch = static_cast<std::uint32_t>(field("live.epoch"));
    if (epoch_ == 0) {
        // a late joiner begins with what the ring still holds
        epoch_ = epoch;
        const auto oldest = [](std::uint64_t next) {
            const auto n = static_cast<std::uint32_t>(next);
            return n > ring - reg::spans_per_page ? n - (ring - reg::spans_per_page) : 0;
        };
        channels_[0].wanted = oldest(field("orientation.next"));
        channels_[1].wanted = oldest(field("position.next"));
    }
    if (epoch != epoch_) return PollResult::new_run;
    status_ = static_cast<std::uint16_t>(field("live.status"));
    const PollResult orientation = poll_channel(
        CurveChannel::orientation, static_cast<std::uint32_t>(field("orientation.next")));
    if (orientation != PollResult::ok) return orientation;
    const PollResult position =
        poll_channel(CurveChannel::position, static_cast<std::uint32_t>(field("position.next")));
    if (position != PollResult::ok) return position;
    return poll_events(static_cast<std::uint32_t>(field("events.next")));
}

PollResult CurveReader::poll_events(std::uint32_t next) {
    while (next_event_ < next) {
        const std::uint32_t first = next_event_ - next_event_ % reg::events_per_page;
        std::array<std::uint16_t, reg::page_size> page{};
        const std::uint16_t address =
            reg::page_address(reg::events_begin, first, reg::events_per_page, reg::event_pages);
        if (!ask(address, reg::page_size, page.data())) return PollResult::no_answer;
        const reg::PageHeader header = reg::get_page_header(page.data());
        if (header.epoch != epoch_) return PollResult::new_run;
        const std::uint32_t end = header.first + header.count;
        if (header.first < first || end <= next_event_) return PollResult::not_a_gateway;
        if (header.first > first) {  // the ring has gone round
            counters_.lost_events += header.first - next_event_;
            next_event_ = header.first;
        }
        for (; next_event_ < end; ++next_event_) {
            const std::uint16_t* at =
                &page[reg::page_header + (next_event_ - header.first) * reg::event_size];
            const auto value = [&](std::size_t row) {
                return reg::get_word(at, reg::event_fields[row]);
            };
            events_.push_back({static_cast<std::int64_t>(value(0)),
                               static_cast<std::uint16_t>(value(1)),
                               static_cast<std::uint16_t>(value(2))});
        }
    }
    return PollResult::ok;
}

PollResult CurveReader::poll_channel(CurveChannel which, std::uint32_t next) {
    Channel& channel = channels_[static_cast<std::size_t>(which)];
    while (channel.wanted < next) {
        const std::uint32_t first = channel.wanted - channel.wanted % reg::spans_per_page;
        std::array<std::uint16_t, reg::page_size> page{};
        const std::uint16_t address = reg::page_address(reg::history_begin(which), first,
                                                        reg::spans_per_page, reg::history_pages);
        if (!ask(address, reg::page_size, page.data())) return PollResult::no_answer;
        const reg::PageHeader header = reg::get_page_header(page.data());
        if (header.epoch != epoch_) return PollResult::new_run;
        if (header.first != first || header.count > reg::spans_per_page) {
            // the ring has gone round: go on with what stands there now
            if (header.first < first || header.first % reg::spans_per_page != 0) {
                return PollResult::not_a_gateway;
            }
            counters_.lost_spans += header.first - channel.wanted;
            channel.wanted = header.first;
            continue;
        }
        for (std::uint16_t i = 0; i < header.count; ++i) {
            const CurveSpan span = reg::get_span(
                page.data() + reg::page_header + i * reg::span_size, which, header.sub_ns);
            counters_.spans += channel.spans.count(first + i) == 0 ? 1u : 0u;
            channel.spans[first + i] = span;
        }
        const std::uint32_t end = first + header.count;
        if (end <= channel.wanted) break;  // the page is older than the count
        channel.wanted = end;
    }
    return PollResult::ok;
}

const CurveSpan* CurveReader::covering(CurveChannel channel, std::int64_t t_ns) const noexcept {
    const Spans& spans = of(channel).spans;
    for (auto it = spans.rbegin(); it != spans.rend() && it->second.t1_ns() >= t_ns; ++it)
        if (it->second.covers(t_ns)) return &it->second;
    return nullptr;
}

std::int64_t CurveReader::covered_until_ns(CurveChannel channel) const noexcept {
    const Spans& spans = of(channel).spans;
    return spans.empty() ? std::numeric_limits<std::int64_t>::min()
                         : spans.rbegin()->second.t1_ns();
}

void CurveReader::drop_before(std::int64_t t_ns) {
    for (Channel& channel : channels_) {
        Spans& spans = channel.spans;
        while (spans.size() > 1 && spans.begin()->second.t1_ns() < t_ns) {
            spans.erase(spans.begin());
        }
    }
}

}  // namespace fairlead::gateway
