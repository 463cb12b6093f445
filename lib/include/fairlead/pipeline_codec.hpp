#pragma once
// The encoder of a board: its channels, beam and memory as the type of the wire's encoder, and its
// records as that one takes them. Nothing is decided here.
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>

#include "fairlead/base/bytes.hpp"
#include "fairlead/base/check.hpp"
#include "fairlead/board.hpp"
#include "fairlead/math/approx.hpp"
#include "fairlead/sense/intake.hpp"
#include "fairlead/stream_params.hpp"
#include "fairlead/wire/encoder.hpp"

namespace fairlead {

namespace detail {

template <Beam beam>
struct BeamSizes {
    using Type =
        std::conditional_t<beam == Beam::narrow, wire::Small,
                           std::conditional_t<beam == Beam::medium, wire::Medium, wire::Large>>;
};
template <Beam beam>
using BeamOf = typename BeamSizes<beam>::Type;

/// A channel of a board as the wire has it: its tag, its value in a record, its bits there.
template <class Channel, Beam beam, class Kind>
struct WireChannel;
template <Beam beam, class Kind>
struct WireChannel<Position, beam, Kind> {
    using Tag = wire::VectorForm<3, BeamOf<beam>, Kind>;
    static constexpr flag::Bits valid = flag::position_valid, gap = flag::position_gap;
    static std::array<float, 3> value(const Pose& pose) noexcept {
        return {pose.p_w_m.x, pose.p_w_m.y, pose.p_w_m.z};
    }
    template <class AnyTolerance>
    static constexpr PerAxis<3> tolerance(const AnyTolerance& t) noexcept {
        return t.position_m;
    }
};
template <Beam beam, class Kind>
struct WireChannel<Orientation, beam, Kind> {
    using Tag = wire::RotationForm<
        std::conditional_t<beam == Beam::medium, wire::MediumTurning, BeamOf<beam>>>;
    static constexpr flag::Bits valid = flag::orientation_valid, gap = flag::orientation_gap;
    static const Quat& value(const Pose& pose) noexcept { return pose.q_wb; }
    template <class AnyTolerance>
    static constexpr float tolerance(const AnyTolerance& t) noexcept {
        return t.orientation_rad;
    }
};
template <std::size_t D, Beam beam, class Kind>
struct WireChannel<Vector<D>, beam, Kind> {
    using Tag = wire::VectorForm<D, BeamOf<beam>, Kind>;
    static constexpr flag::Bits valid = flag::vector_valid, gap = flag::vector_gap;
    static const std::array<float, D>& value(const VectorSample<D>& sample) noexcept {
        return sample.value;
    }
    template <class AnyTolerance>
    static constexpr PerAxis<D> tolerance(const AnyTolerance& t) noexcept {
        return t.value;
    }
};

template <class Board, class AChannels>
class StreamEncoderOf;

template <class Board, class... Channel>
class StreamEncoderOf<Board, Channels<Channel...>> {
    template <class C>
    using Carried = WireChannel<C, Board::beam, typename KindOf<Board>::Type>;
    using Inner = wire::Encoder<Board::delay_records_max - 1, Board::events_max,
                                typename Carried<Channel>::Tag...>;
    static_assert(((approx::same(tolerance_min<Channel>, Carried<Channel>::Tag::tolerance_min) &&
                    approx::same(tolerance_max<Channel>, Carried<Channel>::Tag::tolerance_max)) &&
                   ...),
                  "the ranges of tolerances are those of the channels");

  public:
    using Stream = StreamParams<Channels<Channel...>, Board::delay_records_max>;
    using Record = typename InputTraits<typename Board::Input>::Record;

    static constexpr Check check(const Stream& stream) noexcept {
        return Inner::check(
            params(stream, usable(stream.sample_period_ns), stream.delay_records - 1));
    }
    /// What an intake may let through at this sample period.
    static constexpr IntakeLimits limits(const Stream& stream, std::int64_t period_ns) noexcept {
        IntakeLimits limits = Inner::limits(params(stream, period_ns, stream.delay_records - 1));
        if constexpr (Channels<Channel...>::template has<Position>)
            limits.position_max_m = range(smallest(stream.tolerance.position_m));
        if constexpr (!std::is_same_v<Record, Pose>)
            limits.value_max = range(smallest(stream.tolerance.value));
        return limits;
    }

    /// delay_records: from a record to the bytes that cover it, as the encoder sees them.
    StreamEncoderOf(const Stream& stream, std::uint32_t delay_records) noexcept
        : inner_{params(stream, usable(stream.sample_period_ns), delay_records)} {}

    void set_period(std::int64_t period_ns) noexcept { inner_.set_period(period_ns); }
    Bytes push(const Record& record) noexcept {
        const bool whole = (record.flags & flag::gap_before) != 0;
        std::uint32_t valid = 0, gaps = 0, bit = 1;
        const auto note = [&](flag::Bits value, flag::Bits gap) {
            if (record.flags & value) valid |= bit;
            if (whole || (record.flags & gap)) gaps |= bit;
            bit <<= 1;
        };
        (note(Carried<Channel>::valid, Carried<Channel>::gap), ...);
        return inner_.push(record.t_ns, {Carried<Channel>::value(record)...}, valid, gaps,
                           (record.flags & flag::new_run) != 0);
    }
    Bytes idle() noexcept { return inner_.idle(); }
    Bytes flush() noexcept { return inner_.flush(); }
    bool busy() const noexcept { return inner_.busy(); }
    bool push_event(const Event& event) noexcept { return inner_.push_event(event); }
    void reset() noexcept { inner_.reset(); }

    /// The wire's own encoder: its counts.
    const Inner& inner() const noexcept { return inner_; }

  private:
    /// A period that is not known yet is set before the first record.
    static constexpr std::int64_t usable(std::int64_t period_ns) noexcept {
        return period_ns == 0 ? sample_period_max_ns : period_ns;
    }
    static constexpr float range(float tolerance) noexcept {
        const curve::Scale scale = curve::Scale::of_step(1.2f * tolerance);
        return static_cast<float>(curve::value_steps_max) * scale.step<float>() * 0.999f;
    }
    static constexpr typename Inner::Params params(const Stream& stream, std::int64_t period_ns,
                                                   std::uint32_t delay_records) noexcept {
        typename Inner::Params p;
        p.sample_period_ns = period_ns;
        p.tolerance = {Carried<Channel>::tolerance(stream.tolerance)...};
        p.delay_records = delay_records;
        p.restart_interval_ns = stream.restart_interval_ns;
        p.header_interval_ns = stream.header_interval_ns;
        p.stream_id = stream.stream_id;
        p.event_delay_records = stream.event_delay_records;
        return p;
    }

    Inner inner_;
};

}  // namespace detail

template <class Board>
using StreamEncoder = detail::StreamEncoderOf<Board, typename Board::Channels>;

}  // namespace fairlead
