#pragma once
// Leads the records of a recording, and its discrete events, through a pipeline, with the heap
// sealed, and notes what came out when.
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "fairlead/base/bytes.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/replay/filter_chain.hpp"
#include "host_sim/replay/replay.hpp"
#include "host_sim/replay/seal.hpp"

namespace fairlead::sim {

/// The filter of the pipeline, which notes what goes in and out. Memory is reserved beforehand.
struct TappedFilter {
    FilterChain chain{};
    std::vector<Pose>* in{nullptr};
    std::vector<Pose>* out{nullptr};

    std::optional<Pose> push(const Pose& pose) noexcept {
        in->push_back(pose);
        return noted(chain.push(pose));
    }
    std::optional<Pose> flush() noexcept { return noted(chain.flush()); }
    void reset() noexcept { chain.reset(); }

  private:
    std::optional<Pose> noted(const std::optional<Pose>& pose) const noexcept {
        if (pose) out->push_back(*pose);
        return pose;
    }
};

/// Notes what the stream held when each pose of `input` had been taken.
inline void take(const Bytes& bytes, Replay& result) {
    const std::size_t before = result.stream.size();
    if (bytes.size > 0) result.stream.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
    auto& after = result.bytes_after_input;
    if (after.size() == result.input.size()) return;  // the reducers' own flush
    after.resize(result.input.size(), before);
    after.back() = result.stream.size();
}

template <class Step>
Bytes sealed(Step step) {
    const HeapSeal seal;
    return step();
}

/// Gives discrete events to the chain, each before the first record that is not earlier.
template <class Chain>
class EventFeed {
  public:
    EventFeed(const std::vector<Event>& events, Chain& chain, Replay& result)
        : events_{events}, chain_{chain}, result_{result.events}, stream_{result.stream} {}

    void offer(std::int64_t until_ns) {
        while (next_ < events_.size() && events_[next_].t_ns <= until_ns) offer_one();
    }
    bool offer_one() {
        if (next_ == events_.size()) return false;
        const Event& event = events_[next_++];
        ++result_.offered;
        if (chain_.push_event(event))
            result_.accepted.push_back(event);
        else
            ++result_.refused;
        return true;
    }
    /// The record is through: what was offered before it must be in the stream.
    void due() { result_.due.resize(result_.accepted.size(), stream_.size()); }

  private:
    const std::vector<Event>& events_;
    Chain& chain_;
    EventResult& result_;
    const std::string& stream_;
    std::size_t next_{0};
};

/// Faults of an intake that refuse a record or a channel of one.
inline std::size_t refusals(const FaultCounts& faults) {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < fault_kinds; ++i) {
        const auto kind = static_cast<Fault>(i);
        if (kind != Fault::gap && kind != Fault::new_run)
            sum += static_cast<std::size_t>(faults[kind]);
    }
    return sum;
}

/// Leads every record through the chain; `note` may look at it after each call.
template <class Chain, class Record, class Note>
void feed(Chain& chain, const std::vector<Record>& records, const std::vector<Event>& discrete,
          Note note, Replay& result) {
    Progress progress{"replay", records.size()};
    EventFeed<Chain> events{discrete, chain, result};
    for (const Record& record : records) {
        events.offer(record.t_ns);
        const std::size_t refused_before = refusals(chain.intake().faults());
        take(sealed([&] { return chain.push(record); }), result);
        // a record is counted once, however many of its channels are refused
        if (refusals(chain.intake().faults()) > refused_before) ++result.refused;
        events.due();
        note();
        result.bytes_after_record.push_back(result.stream.size());
        progress.show(result.bytes_after_record.size());
    }
    while (events.offer_one()) {  // those after the last record
        take(sealed([&] { return chain.idle(); }), result);
        events.due();
    }
    for (bool more = true; more;) {
        const Bytes bytes = sealed([&] { return chain.flush(); });
        take(bytes, result);
        note();
        more = bytes.status != Status::end;
    }
    const FaultCounts& faults = chain.intake().faults();
    for (std::size_t i = 0; i < fault_kinds; ++i) {
        const auto kind = static_cast<Fault>(i);
        const auto count = static_cast<std::size_t>(faults[kind]);
        result.faults.emplace_back(to_string(kind), count);
    }
}

}  // namespace fairlead::sim
