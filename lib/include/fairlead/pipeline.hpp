#pragma once
// The whole way of the data as one type: intake -> (calibration -> attitude) -> filter -> reduction
// -> frames. Poses, samples of an IMU and vectors take the same way; the board names which of them
// comes in and which channels leave (board.hpp). Firmware, gateway and host simulator run it.
//
// In:    one record a push, times in any order: the intake judges them, and nothing else does.
// Out:   whole frames, often none. Each accepted record is covered within tolerance by bytes that
//        have left after params.delay_records more accepted records, and the filter's latency.
// Cost:  memory is the object; work of a push, an idle() and a flush() is bounded by the type.
// State: refused parameters make it inert: check() names the field, and every call says so.
#include <cstdint>
#include <optional>

#include "fairlead/base/bytes.hpp"
#include "fairlead/base/check.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/board.hpp"
#include "fairlead/pipeline_codec.hpp"
#include "fairlead/pipeline_front.hpp"
#include "fairlead/pipeline_grid.hpp"
#include "fairlead/sense/intake.hpp"
#include "fairlead/smooth/filter.hpp"
#include "fairlead/stream_params.hpp"

namespace fairlead {

/// Board: board.hpp. Codec<Board>: reduction and frames behind the filter, the encoder of this
/// library. It has check(stream params), limits(stream params, period), a constructor (stream
/// params, delay in records), set_period(), push(record), idle(), flush(), push_event(), busy() and
/// reset(). Its flush() says Status::end when nothing is left. While it is busy() it takes no
/// record, and idle() lets out what must leave before.
template <class Board, template <class> class Codec>
class BasicPipeline {
    static_assert(check_board<Board>());
    using Traits = detail::InputTraits<typename Board::Input>;

  public:
    using Raw = typename Traits::Raw;        // what comes in
    using Record = typename Traits::Record;  // what is filtered and reduced
    using Filter = typename Board::Filter;
    using Encoder = Codec<Board>;
    using Front = detail::Front<typename Board::Input>;
    using Gate =
        Intake<Raw, Traits::imu ? Front::takes : detail::valid_bits<typename Board::Channels>>;
    using Stream = StreamParams<typename Board::Channels, Board::delay_records_max>;
    using Grid = detail::GridFinder<Stream, Encoder>;
    struct Params : Stream, Front::Params {
        Filter filter{};
        IntakeParams intake{};
    };

    /// The first field that is refused, of all stages.
    static constexpr Check check(const Params& params) noexcept {
        const Stream& stream = params;
        if (const Check c = fairlead::check(stream); !c) return c;
        if (const Check c = Encoder::check(stream); !c) return c;
        if (const Check c = Front::check(params); !c) return c;
        return fairlead::check(params.intake, Grid::first_limits(stream));
    }

    /// Refused parameters reach no stage: those are built from the defaults, and stay idle.
    explicit BasicPipeline(const Params& params) noexcept
        : BasicPipeline{check(params) ? params : Params{}, check(params)} {}

    /// One record. @return the frames that it completed, possibly none, valid until the next call;
    /// status: refused (the intake's counts say why; or the encoder is busy), no_valid_data (the
    /// record was accepted, but none of the channels has a value in it: are the valid bits set?),
    /// bad_argument (inert).
    Bytes push(const Raw& raw) noexcept {
        filtered_.reset();
        front_out_.reset();
        if (!checked_) return inert();
        if (encoder_.busy()) {
            Bytes bytes = encoder_.idle();
            bytes.status = Status::refused;
            return bytes;
        }
        const std::optional<Raw> accepted = intake_.push(raw);
        Bytes bytes = carry(accepted);
        if (intake_.refused()) bytes.status = Status::refused;
        return bytes;
    }

    /// A change on a discrete channel; any order of times. Its frame is among those of the next
    /// push(), idle() or flush(), or at most event_delay_records of them later.
    /// @return false: the queue is full or the pipeline is inert, and the event is not taken.
    bool push_event(const Event& event) noexcept { return checked_ && encoder_.push_event(event); }

    /// Instead of push(), where no record came in its time: lets out what waits, and events.
    Bytes idle() noexcept {
        filtered_.reset();
        front_out_.reset();
        if (!checked_) return inert();
        return encoder_.busy() ? encoder_.idle() : carry(intake_.idle());
    }

    /// Lets out what is still inside, at the price of a push for each call. Call it until the
    /// status is Status::end; frames come with any of the calls. Records may follow: they start
    /// new curves.
    Bytes flush() noexcept {
        filtered_.reset();
        front_out_.reset();
        if (!checked_) return {nullptr, 0, Status::end};
        if (encoder_.busy()) return more(encoder_.idle());
        if (const auto last = intake_.flush()) return more(carry(last));
        if ((filtered_ = filter_.flush())) return more(encode());
        return encoder_.flush();
    }

    /// As new: what is inside is forgotten, and the next record begins a run. Counts stay, and so
    /// does the run number.
    void reset() noexcept {
        intake_.reset();
        front_.reset();
        filter_.reset();
        encoder_.reset();
        filtered_.reset();
        front_out_.reset();
        if (checked_) grid_.start(intake_, encoder_);
    }

    /// ok, or the name of the parameter for which the pipeline is inert.
    const Check& check() const noexcept { return checked_; }
    /// What the last push made of its record: behind the attitude filter, and behind the filter.
    /// The guarantee speaks of filtered().
    const std::optional<Record>& pose() const noexcept { return front_out_; }
    const std::optional<Record>& filtered() const noexcept { return filtered_; }
    /// The sample period in use, ns; 0: not known yet.
    std::int64_t sample_period_ns() const noexcept { return grid_.period_ns(); }
    const Gate& intake() const noexcept { return intake_; }
    const Encoder& encoder() const noexcept { return encoder_; }
    auto& attitude() noexcept { return front_.attitude(); }
    const auto& attitude() const noexcept { return front_.attitude(); }

  private:
    static constexpr std::uint32_t waiting = Gate::waiting_max;

    BasicPipeline(const Params& params, const Check& checked) noexcept
        : checked_{checked},
          intake_{params.intake},
          front_{params},
          filter_{params.filter},
          encoder_{params, params.delay_records - waiting},
          grid_{params} {
        if (checked_) grid_.start(intake_, encoder_);
    }

    static constexpr Bytes inert() noexcept { return {nullptr, 0, Status::bad_argument}; }
    static Bytes more(Bytes bytes) noexcept {
        bytes.status = Status::ok;
        return bytes;
    }

    Bytes carry(const std::optional<Raw>& accepted) noexcept {
        if (!accepted) return encoder_.idle();
        grid_.measure(*accepted, intake_, encoder_);
        front_out_ = front_.push(*accepted);
        const bool usable =
            front_out_ && (front_out_->flags & detail::valid_bits<typename Board::Channels>) != 0;
        grid_.mark(front_out_);
        if (front_out_) filtered_ = filter_.push(*front_out_);
        Bytes bytes = filtered_ ? encode() : encoder_.idle();
        if (!usable) bytes.status = Status::no_valid_data;
        return bytes;
    }

    Bytes encode() noexcept {
        grid_.place(*filtered_, intake_, encoder_);
        return encoder_.push(*filtered_);
    }

    Check checked_;
    Gate intake_;
    Front front_;
    Filter filter_;
    Encoder encoder_;
    Grid grid_;
    std::optional<Record> front_out_{};
    std::optional<Record> filtered_{};
};

/// The pipeline with the encoder of this library.
template <class Board>
using Pipeline = BasicPipeline<Board, StreamEncoder>;

}  // namespace fairlead
