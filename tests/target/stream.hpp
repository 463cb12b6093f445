#pragma once
// Streams made from recipes, the same on every machine: integers throughout, floats only where the
// records leave (exact scaling, + - * / sqrt). A recipe is one line of text:
//
//     NAME SEED RATE_HZ KIND:LENGTH:MOVE:TURN:PACE KIND:LENGTH:MOVE:TURN:PACE ...
//
// MOVE is a length in 2^-16 m, TURN a half angle in 2^-20 rad, PACE a number of records. Kinds:
//   rest     nothing moves
//   line     constant velocity and rate, drawn once (MOVE, TURN per record)
//   walk     velocity and rate change at random every PACE records
//   noise    white noise around a point: knots that never reduce
//   zigzag   a line with a corner of height MOVE, TURN every PACE records: a tolerance met barely
//   flip     a walk whose quaternion changes sign every PACE records
//   gap      a walk that loses MOVE records of time every PACE records; odd TURN: one channel only
//   jitter   a walk whose time steps differ by up to PACE percent
//   tiny     denormal positions and rotations
//   huge     far positions and rotations of up to half a turn a record
//   wild     what only Intake should meet: NaN, infinities, backward and repeated time
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/math/quat.hpp"
#include "tests/target/subject.hpp"

namespace fairlead::target {

enum class Kind : std::uint8_t {
    rest,
    line,
    walk,
    noise,
    zigzag,
    flip,
    gap,
    jitter,
    tiny,
    huge,
    wild
};
inline constexpr std::array<const char*, 11> kind_names{
    "rest", "line", "walk", "noise", "zigzag", "flip", "gap", "jitter", "tiny", "huge", "wild"};

struct Segment {
    Kind kind{};
    std::int32_t length{}, move{}, turn{}, pace{1};
};

struct Recipe {
    static constexpr std::size_t segments_max = 16;
    char name[32]{};
    std::uint32_t seed{1};
    std::int32_t rate_hz{120};
    std::array<Segment, segments_max> segments{};
    std::size_t segments_size{};
};

/// Reads one line; false where it is not a recipe (empty, a comment, nonsense).
bool parse(const char* line, Recipe& recipe) noexcept;

/// xorshift32: never 0, period 2^32 - 1.
class Dice {
  public:
    explicit Dice(std::uint32_t seed) noexcept : state_{seed != 0 ? seed : 1} {}
    std::uint32_t next() noexcept {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 17;
        state_ ^= state_ << 5;
        return state_;
    }
    /// Evenly in [-n, n].
    std::int32_t around_zero(std::int32_t n) noexcept {
        const auto span = static_cast<std::uint64_t>(2 * static_cast<std::int64_t>(n) + 1);
        return static_cast<std::int32_t>(static_cast<std::int64_t>((next() * span) >> 32) - n);
    }

  private:
    std::uint32_t state_;
};

class Generator {
  public:
    explicit Generator(const Recipe& recipe) noexcept;
    /// False at the end. wild segments are skipped unless asked for.
    bool next(Record& record, bool with_wild) noexcept;

  private:
    using Ints = std::array<std::int32_t, 3>;

    Ints draw(std::int32_t scale) noexcept;
    void enter_segment() noexcept;
    void move_on() noexcept;
    std::int64_t step_ns() noexcept;
    Pose shape() noexcept;
    Sample sense(const Pose& pose, std::int64_t dt_ns) noexcept;
    void spoil(Record& record) noexcept;

    const Recipe& recipe_;
    Dice dice_;
    std::size_t segment_{0};
    std::int32_t at_{-1};             // record within the segment
    Ints p_{}, v_{}, w_{}, v_old_{};  // 2^-16 m, the same per record, 2^-20 rad per record
    Quat q_{};
    std::int64_t t_ns_{1'000'000'000};
};

}  // namespace fairlead::target
