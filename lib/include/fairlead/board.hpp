#pragma once
// What a board names when it builds a Pipeline: what comes in, what leaves, how much memory. A
// board is a struct with six members, all of them required, so that a misspelt one is a missing
// one, and a missing one does not compile:
//
//     struct Board {
//         using Input = fairlead::Pose;            // or Imu<mode>, or VectorSample<D>
//         using Channels = fairlead::Channels<fairlead::Position, fairlead::Orientation>;
//         using Filter = fairlead::PoseFilter<9>;  // or NoFilter
//         static constexpr std::size_t delay_records_max = 120;
//         static constexpr fairlead::Beam beam = fairlead::Beam::medium;
//         static constexpr std::size_t events_max = 0;
//     };
//
// A seventh may stand beside: `using Kind = fairlead::curve::Cubics;` gives positions and vectors a
// continuous acceleration (docs/cubics.md). Without it, and of orientations always, the velocity is
// continuous.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "fairlead/base/types.hpp"
#include "fairlead/curve/lengths.hpp"
#include "fairlead/sense/attitude_state.hpp"

namespace fairlead {

/// Channels of a stream. What a board does not name costs neither RAM nor flash.
struct Position {};
struct Orientation {};
template <std::size_t D>
struct Vector {
    static_assert(D >= 1 && D <= vector_components_max, "a vector has 1 to 5 components");
};

/// The channels that leave: Position, Orientation, both, or one Vector<D>.
template <class... Channel>
struct Channels {
    template <class C>
    static constexpr bool has = (std::is_same_v<C, Channel> || ...);
};

/// Input of a pipeline that gets the samples of an IMU: which sensors the attitude is found from.
template <AttitudeMode mode = AttitudeMode::imu_mag>
struct Imu {};

/// Width of the search for few bytes: more hypotheses cost work and RAM, and save bytes.
/// docs/choosing.md has the figures.
enum class Beam : std::uint8_t { narrow, medium, wide };

/// Leaves records as they are.
struct NoFilter {
    static constexpr std::size_t latency = 0;
    template <class Record>
    static std::optional<Record> push(const Record& record) noexcept {
        return record;
    }
    static std::nullopt_t flush() noexcept { return std::nullopt; }
    static void reset() noexcept {}
};

namespace detail {

template <class Input>
struct InputTraits;  // not defined: Input is none of the three kinds
template <>
struct InputTraits<Pose> {
    using Raw = Pose;
    using Record = Pose;
    static constexpr bool imu = false;
};
template <std::size_t D>
struct InputTraits<VectorSample<D>> {
    using Raw = VectorSample<D>;
    using Record = VectorSample<D>;
    static constexpr bool imu = false;
};
template <AttitudeMode m>
struct InputTraits<Imu<m>> {
    using Raw = Sample;
    using Record = Pose;
    static constexpr bool imu = true;
    static constexpr AttitudeMode mode = m;
};

template <class Input, class AChannels>
inline constexpr bool channels_fit = false;
template <>
inline constexpr bool channels_fit<Pose, Channels<Position>> = true;
template <>
inline constexpr bool channels_fit<Pose, Channels<Orientation>> = true;
template <>
inline constexpr bool channels_fit<Pose, Channels<Position, Orientation>> = true;
template <AttitudeMode mode>
inline constexpr bool channels_fit<Imu<mode>, Channels<Orientation>> = true;
template <std::size_t D>
inline constexpr bool channels_fit<VectorSample<D>, Channels<Vector<D>>> = true;

/// Bits that mark a value of these channels as valid.
template <class AChannels>
inline constexpr flag::Bits valid_bits = flag::vector_valid;  // a Vector<D>
template <class... C>
inline constexpr flag::Bits valid_bits<Channels<Position, C...>> =
    flag::position_valid | (sizeof...(C) > 0 ? flag::orientation_valid : 0u);
template <>
inline constexpr flag::Bits valid_bits<Channels<Orientation>> = flag::orientation_valid;

// Has the board such a member? One probe each.
template <class B, class = void>
inline constexpr bool has_input = false;
template <class B>
inline constexpr bool has_input<B, std::void_t<typename B::Input>> = true;
template <class B, class = void>
inline constexpr bool has_channels = false;
template <class B>
inline constexpr bool has_channels<B, std::void_t<typename B::Channels>> = true;
template <class B, class = void>
inline constexpr bool has_filter = false;
template <class B>
inline constexpr bool has_filter<B, std::void_t<typename B::Filter>> = true;
template <class B, class = void>
inline constexpr bool has_delay = false;
template <class B>
inline constexpr bool has_delay<B, std::void_t<decltype(B::delay_records_max)>> = true;
template <class B, class = void>
inline constexpr bool has_beam = false;
template <class B>
inline constexpr bool has_beam<B, std::void_t<decltype(B::beam)>> = true;
template <class B, class = void>
inline constexpr bool has_events = false;
template <class B>
inline constexpr bool has_events<B, std::void_t<decltype(B::events_max)>> = true;

/// The kind of pieces of the board's positions and vectors.
template <class B, class = void>
struct KindOf {
    using Type = curve::Smooth;
};
template <class B>
struct KindOf<B, std::void_t<typename B::Kind>> {
    using Type = typename B::Kind;
};

template <class T, class = void>
inline constexpr bool is_defined = false;
template <class T>
inline constexpr bool is_defined<T, std::void_t<decltype(sizeof(T))>> = true;

/// A count: std::size_t and nothing else, so that no sign and no fraction is lost.
template <class T>
inline constexpr bool is_count = std::is_same_v<std::remove_cv_t<T>, std::size_t>;

/// Is the filter one for these records? push(record) and flush() give optional records.
template <class Filter, class Record, class = void>
inline constexpr bool filters = false;
template <class Filter, class Record>
inline constexpr bool
    filters<Filter, Record,
            std::void_t<decltype(std::declval<Filter&>().push(std::declval<const Record&>())),
                        decltype(std::declval<Filter&>().reset())>> =
        std::is_same_v<decltype(std::declval<Filter&>().push(std::declval<const Record&>())),
                       std::optional<Record>>;

}  // namespace detail

/// Fails to compile, with a sentence, where a board lacks a member or a member is of a wrong kind.
template <class Board>
constexpr bool check_board() noexcept {
    using namespace detail;
    static_assert(has_input<Board>,
                  "the board lacks `using Input = ...`: Pose, Imu<mode> or "
                  "VectorSample<D>");
    static_assert(has_channels<Board>,
                  "the board lacks `using Channels = Channels<...>`: Position, "
                  "Orientation, both, or Vector<D>");
    static_assert(has_filter<Board>,
                  "the board lacks `using Filter = ...`: NoFilter, "
                  "PoseFilter<taps> or another filter of poses");
    static_assert(has_delay<Board>,
                  "the board lacks `static constexpr std::size_t "
                  "delay_records_max`: the longest delay, in records");
    static_assert(has_beam<Board>,
                  "the board lacks `static constexpr Beam beam`: narrow, medium or "
                  "wide");
    static_assert(has_events<Board>,
                  "the board lacks `static constexpr std::size_t events_max`: "
                  "discrete events that may wait; 0 for none");
    if constexpr (has_input<Board>) {
        constexpr bool known = is_defined<InputTraits<typename Board::Input>>;
        static_assert(known, "Input must be Pose, Imu<mode> or VectorSample<D>");
        if constexpr (known && has_channels<Board>)
            static_assert(channels_fit<typename Board::Input, typename Board::Channels>,
                          "these Channels do not come from this Input: Pose gives Position, "
                          "Orientation or both (in this order), Imu gives Orientation, "
                          "VectorSample<D> gives Vector<D>");
        if constexpr (known && has_filter<Board>)
            static_assert(filters<typename Board::Filter,
                                  typename InputTraits<typename Board::Input>::Record>,
                          "Filter is no filter for the records of this Input");
    }
    using Kind = typename KindOf<Board>::Type;
    static_assert(std::is_same_v<Kind, curve::Smooth> || std::is_same_v<Kind, curve::Cubics>,
                  "Kind must be curve::Smooth (the velocity is continuous) or curve::Cubics (the "
                  "acceleration too)");
    if constexpr (std::is_same_v<Kind, curve::Cubics> && has_channels<Board>)
        static_assert(!std::is_same_v<typename Board::Channels, fairlead::Channels<Orientation>>,
                      "Kind = curve::Cubics needs a channel Position or Vector<D>: orientations "
                      "have a continuous velocity");
    if constexpr (has_delay<Board>) {
        static_assert(is_count<decltype(Board::delay_records_max)>,
                      "delay_records_max must be of type std::size_t");
        static_assert(Board::delay_records_max >= 16 && Board::delay_records_max <= 240,
                      "delay_records_max must be 16 to 240 records");
    }
    if constexpr (has_beam<Board>)
        static_assert(std::is_same_v<std::remove_cv_t<decltype(Board::beam)>, Beam>,
                      "beam must be of type fairlead::Beam");
    if constexpr (has_events<Board>) {
        static_assert(is_count<decltype(Board::events_max)>,
                      "events_max must be of type std::size_t");
        static_assert(Board::events_max <= 6, "events_max must be 0 to 6");
    }
    return true;
}

}  // namespace fairlead
