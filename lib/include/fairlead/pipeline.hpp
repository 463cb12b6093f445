#pragma once
// The whole way of the data as one type: intake -> filter -> reduce -> codec. Discrete events enter
// beside the poses and keep their exact times: no filter's latency shifts them against the motion,
// for a filter stamps what it emits with the time at which that was true.
//
// The firmware, the gateway and the host simulator run this very type. All memory is in the object;
// work per push is bounded by the configuration (BOUNDS.md).
#include <cstddef>

#include "fairlead/base/types.hpp"
#include "fairlead/board.hpp"
#include "fairlead/sense/intake.hpp"
#include "fairlead/smooth/filter.hpp"
#include "fairlead/wire/encoder.hpp"

namespace fairlead {

/// What a configuration names; derive from it or write your own.
struct PipelineConfig {
    using Filter = NoFilter;
    static constexpr std::size_t window = 64;      // ring capacity of the reducers, in records
    static constexpr Credit slice = slice_medium;  // search per push and channel: wire/encoder.hpp
    static constexpr std::size_t events = 8;       // discrete events that may wait; 0: has none
};

template <class Config>
class Pipeline {
  public:
    using Filter = typename Config::Filter;
    using Encoding = Encoder<Config::window, Config::slice, Config::events>;
    struct Params {
        IntakeParams intake{};
        Filter filter{};
        EncoderParams encoder{};
    };

    explicit Pipeline(const Params& params) noexcept
        : intake_{params.intake}, filter_{params.filter}, encoder_{params.encoder} {}

    /// One raw record. @return the frames that it completed, possibly none; valid until the next
    /// call.
    Bytes push(const Pose& raw) noexcept {
        filtered_.reset();
        if (const auto pose = intake_.push(raw)) filtered_ = filter_.push(*pose);
        return filtered_ ? encoder_.push(*filtered_) : encoder_.idle();
    }

    /// A change on a discrete channel; any order of times. Its frame is among those of the next
    /// push(), idle() or flush(), or at most event_delay_max of them later.
    /// @return false: the queue is full, and the event is not taken.
    bool push_event(const Event& event) noexcept { return encoder_.push_event(event); }

    /// Instead of push(), where no record came in its time: lets out events alone.
    Bytes idle() noexcept {
        filtered_.reset();
        return encoder_.idle();
    }

    /// Lets out what is still inside. @return frames; call until there are none. A call costs no
    /// more than a push: what the filter still holds goes in without a search.
    Bytes flush() noexcept {
        while ((filtered_ = filter_.flush())) {
            const Bytes bytes = encoder_.push(*filtered_, false);
            if (!bytes.empty()) return bytes;
        }
        return encoder_.flush();
    }

    /// What the last push gave to the reducers: the filtered record that the guarantee speaks of.
    const std::optional<Pose>& filtered() const noexcept { return filtered_; }
    const Intake<Pose>& intake() const noexcept { return intake_; }
    const Encoding& encoder() const noexcept { return encoder_; }

  private:
    Intake<Pose> intake_;
    Filter filter_;
    Encoding encoder_;
    std::optional<Pose> filtered_{};
};

}  // namespace fairlead
