#pragma once
// Records in, frames out: the reducer, the frames that carry what it commits, headers, events.
//
// A frame that the reducer has committed is compared with its samples, and then coded, in portions
// over the next `spare` pushes: no push does all the work of a frame. What of the delay remains is
// the reducer's window. Header frames and event frames leave before data frames of the same push.
//
// A frame whose check fails, or that does not fit into its bytes, never leaves. Its time leaves as
// steps instead (reduce/jump_walk.hpp), which hold any samples: one stretch of it a call, as many
// samples as fit, so that each sample is still in time. The reducer's window then begins anew from
// where the decoder is. While such stretches wait, no frame is committed: a record that needs one
// waits too, and later ones are refused (Status::refused) until it has been taken.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

#include "fairlead/base/bytes.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/reduce/cubic_channel.hpp"
#include "fairlead/reduce/reducer.hpp"
#include "fairlead/reduce/rotation_channel.hpp"
#include "fairlead/wire/encoder_params.hpp"
#include "fairlead/wire/events.hpp"
#include "fairlead/wire/frame_writer.hpp"

namespace fairlead::wire {

/// Sizes of a search (reduce/beam.hpp): wider costs work and memory, and saves bytes.
using Small = reduce::BeamSize<2, 24>;
using Medium = reduce::BeamSize<3, 24>;
using Large = reduce::BeamSize<8, 64, 2, 200>;
/// Of rotations, whose vertices have three components: more of them are about as cheap.
using MediumTurning = reduce::BeamSize<6, 32>;

/// A channel of D numbers, each within its tolerance by itself.
template <std::size_t D, class BeamT = Medium, class KindT = curve::Smooth>
struct VectorForm {
    using Kind = KindT;
    using Beam = BeamT;
    using Value = std::array<float, D>;
    template <std::size_t Window>
    using Channel = typename reduce::VectorOf<D, Kind, BeamT, Window>::Type;
    static constexpr std::size_t axes = D, rotations = 0;
    static constexpr float tolerance_min = 1e-6f, tolerance_max = 1e6f;
};
/// A channel of orientations, within its tolerance as a rotation angle.
template <class BeamT = MediumTurning, class KindT = curve::Smooth>
struct RotationForm {
    using Kind = KindT;
    static_assert(!Kind::cubic, "orientations have quadratics");
    using Beam = BeamT;
    using Value = Quat;
    template <std::size_t Window>
    using Channel = reduce::RotationChannel<Kind, BeamT, Window>;
    static constexpr std::size_t axes = 0, rotations = 1;
    static constexpr float tolerance_min = reduce::rotation_tolerance_min_rad, tolerance_max = 0.5f;
};

/// Records: the largest delay_records. Events: discrete events that may wait between two records,
/// and channels of them that a late reader learns of; 0 to 6. Memory: sizeof.
template <std::size_t Records, std::size_t Events, class... Channels>
class Encoder {
    static_assert(sizeof...(Channels) >= 1 && sizeof...(Channels) <= channels_max,
                  "an encoder has 1 to 4 channels");
    static_assert(Records >= 8 && Records <= 246, "an encoder delays by 8 to 246 records");

  public:
    static constexpr std::size_t channel_count = sizeof...(Channels);
    static constexpr std::uint32_t records_max = Records;
    static constexpr std::size_t axes = (0 + ... + Channels::axes);
    static constexpr std::size_t rotations = (0 + ... + Channels::rotations);
    using FirstKind = typename std::tuple_element_t<0, std::tuple<Channels...>>::Kind;
    using Kinds = std::conditional_t<(std::is_same_v<FirstKind, typename Channels::Kind> && ...),
                                     KindSet<FirstKind>, KindSet<typename Channels::Kind...>>;
    static constexpr std::size_t axes_most = (std::max)({std::size_t{1}, Channels::axes...});
    using Params = EncoderParams<channel_count, axes_most>;
    using Values = std::tuple<typename Channels::Value...>;

    /// Pushes from the commit of a frame to its last byte, by the delay: short windows are coded at
    /// once.
    static constexpr std::uint32_t spare(std::uint32_t delay_records) noexcept {
        const std::uint32_t usual = delay_records >= 96   ? 6
                                    : delay_records >= 48 ? 3
                                    : delay_records >= 24 ? 2
                                                          : 0;
        // the search of cubics goes on behind a commit, and knows more then
        if (Kinds::cubics) return delay_records >= 32 ? 6 : delay_records >= 16 ? 4 : 2;
        return (std::min)({usual, Channels::Beam::spare...});
    }
    /// Records of the reducer's window at a delay, and the most at any delay of the type.
    static constexpr std::uint32_t window_records(std::uint32_t delay_records) noexcept {
        return delay_records - spare(delay_records) + 1;
    }
    static constexpr std::size_t window_max = [] {
        std::uint32_t most = 0;
        for (std::uint32_t d = 8; d <= Records; ++d)
            most = window_records(d) > most ? window_records(d) : most;
        return std::size_t{most};
    }();

    static constexpr Check check(const Params& params) noexcept {
        const Check ranges = fairlead::detail::check_ranges(params);
        if (!ranges) return ranges;
        if (params.delay_records > Records) return {Status::bad_argument, "delay_records"};
        constexpr float least[] = {Channels::tolerance_min...},
                        most[] = {Channels::tolerance_max...};
        for (std::size_t i = 0; i < channel_count; ++i)
            for (const float tolerance : params.tolerance[i])
                if (!(tolerance >= least[i] && tolerance <= most[i]))
                    return {Status::bad_argument, "tolerance"};
        // a frame of cubics needs the state before it
        if (Kinds::cubics && params.restart_interval_ns == every_frame_ns)
            return {Status::bad_argument, "restart_interval_ns"};
        return {};
    }
    /// What an intake before this encoder may let through.
    static constexpr IntakeLimits limits(const Params& params) noexcept {
        IntakeLimits limits;
        const std::int64_t tick = curve::Grid::of_period(0, params.sample_period_ns).tick_ns();
        limits.spacing_min_ns = (tick * curve::spacing_subs_min + 63) / 64;
        limits.gap_ns_max = curve::gap_ticks_max * tick;
        limits.gap_ns = params.gap_ns > 0 ? params.gap_ns : default_gap_ns(params.sample_period_ns);
        if (limits.gap_ns > limits.gap_ns_max) limits.gap_ns = limits.gap_ns_max;
        // sub-ticks of a run fit run_max
        limits.run_ns_max = tick / 64 < 32 ? (tick / 64) * (run_max / 2) : IntakeLimits::run_ns;
        return limits;
    }

    /// Refused parameters give an inert encoder: every push says bad_argument. See check().
    explicit Encoder(const Params& params) noexcept : params_{params} {
        good_ = check(params_).status == Status::ok;
        if (!good_) return;
        period_ns_ = params_.sample_period_ns;
        run_ = static_cast<std::uint16_t>(params_.run - 1u);
        spare_ = spare(params_.delay_records);
        configure(std::index_sequence_for<Channels...>{});
    }

    /// A record at t_ns: values of the channels whose bit in `valid` is set; `gaps`: channels whose
    /// curve must not go on over what is before. Times of a run rise by limits().spacing_min_ns at
    /// least; new_run: t_ns has nothing to do with the times before. @return whole frames, if any.
    /// status: refused: busy(), and the record was not taken.
    Bytes push(std::int64_t t_ns, const Values& values, std::uint32_t valid, std::uint32_t gaps,
               bool new_run) noexcept {
        size_ = 0;
        if (!good_) return {nullptr, 0, Status::bad_argument};
        const bool was_busy = busy();
        if (was_busy)
            go_on();
        else
            take({t_ns, values, valid, gaps, new_run});
        let_out_events(size_ > 0 ? 0 : params_.event_delay_records);
        Bytes out = bytes();
        if (was_busy) out.status = Status::refused;
        return out;
    }
    /// A record waits until a frame has left whose check failed: the next one would be refused.
    bool busy() const noexcept { return waits_; }
    /// An event of a discrete channel; it leaves with the next record, at most event_delay_records
    /// later. @return false: Events of them wait already, and it is not taken.
    bool push_event(const Event& event) noexcept { return good_ && events_.push(event); }
    /// Instead of push(), where no record has come: lets out events alone.
    Bytes idle() noexcept {
        size_ = 0;
        if (!good_) return {nullptr, 0, Status::bad_argument};
        if (waits_ || exact_) go_on();
        let_out_events(params_.event_delay_records);
        return bytes();
    }
    /// Lets everything out, with the work of a push for each call: call it until the status is
    /// Status::end; a call may give no bytes. What comes later starts new curves. Where it comes
    /// within a tick, it begins a new run.
    Bytes flush() noexcept {
        size_ = 0;
        if (!good_) return {nullptr, 0, Status::end};
        const bool more = flush_some();
        let_out_events(0);
        Bytes out = bytes();
        out.status = more ? Status::ok : Status::end;
        return out;
    }
    /// Forgets what has not left; the next record begins a new run.
    void reset() noexcept {
        coding_ = running_ = exact_ = waits_ = false;
        size_ = 0;
    }
    /// The sample period of runs that begin from now on.
    void set_period(std::int64_t sample_period_ns) noexcept {
        if (sample_period_ns >= sample_period_min_ns && sample_period_ns <= sample_period_max_ns)
            period_ns_ = sample_period_ns;
    }

    const auto& reducer() const noexcept { return reducer_; }
    std::uint32_t frames() const noexcept { return frames_; }
    std::uint32_t restarts() const noexcept { return restarts_; }
    /// Frames that did not fit into their bytes, and were given up. Of quadratics: never, by the
    /// bound of their cost. The cost of cubics is an estimate: a few in 1000 on rough streams.
    std::uint32_t overflows() const noexcept { return overflows_; }
    /// Samples that a committed curve did not hold within its tolerance; its frame was given up.
    /// By rounding that the search leaves too little room for: in about 3 of 10^6 random streams.
    std::uint32_t check_failures() const noexcept {
        return failures(std::index_sequence_for<Channels...>{});
    }
    /// Frames that began where the decoder is not: never.
    std::uint32_t strays() const noexcept { return strays_; }
    /// Frames for which steps left, for one of these reasons.
    std::uint32_t given_up() const noexcept { return given_up_; }
    std::uint32_t refused_events() const noexcept { return events_.refused(); }
    std::uint16_t run() const noexcept { return run_; }

  private:
    using Reducer = reduce::Reducer<typename Channels::template Channel<window_max>...>;
    using Writer = FrameWriter<axes, rotations, Kinds>;
    static constexpr std::size_t header_max = header_size_max(channel_count, axes + rotations);
    // a frame that was being coded and one that a new run or a flush ends, each with a header
    static constexpr std::size_t out_max =
        2 * (data_frame_max + header_max) + EventSender<Events>::frame_max;
    /// Bits of a frame beside its pieces and what its curves tell where they start, at most. Head:
    /// restart 4, ticks 3 + 17, time 42, flag of the jump 1; of a channel: flags 13, two ticks 17,
    /// and its end: 9 and 27 for each axis of a vector, 51 for a rotation. An independent frame
    /// tells as much at its start, and slopes: 27 for each axis, 82 for a rotation. The coder's
    /// end: 20.
    static constexpr std::size_t overhead_bits(bool independent) noexcept {
        constexpr std::size_t ends = (0 + ... + (Channels::axes > 0 ? 9 + 27 * Channels::axes : 0));
        std::size_t bits = 67 + 20 + 30 * channel_count + 51 * rotations + ends;
        if (independent) bits += 133 * rotations + ends;
        return bits;
    }

    /// What one column of the search may add to a frame.
    static constexpr std::size_t column_bits =
        (0 + ... + Channels::template Channel<window_max>::column_bits_max);
    static constexpr std::size_t start_bits =
        (0 + ... + Channels::template Channel<window_max>::start_bits_max);
    // a curve that starts tells no slopes, and its values once
    static constexpr std::size_t first_bits =
        (std::max)(start_bits, overhead_bits(true) - overhead_bits(false));
    static_assert(8 * payload_max > overhead_bits(false) + first_bits + column_bits,
                  "the channels are too many for a frame");

    /// Bits of a stretch with the fewest samples, at most. All samples of a channel lie in its last
    /// tick then, `most` of them. From the stretch's start a step of a track leads to the first cut
    /// between two of them: a value, and as many parts without one as 250 ticks need; then one part
    /// for each sample and one to the end, within the tick. A code stands where a part begins on a
    /// whole tick; behind the first it is that of a jump behind a jump. The first of a cubic is its
    /// way and the bits of a break.
    template <class Kind>
    static constexpr std::size_t exact_bits(std::size_t components, std::size_t value_bits,
                                            std::size_t jump_cost) noexcept {
        constexpr std::size_t most = 64 / curve::spacing_subs_min + 1;
        constexpr std::size_t long_parts = 250 / (curve::gap_ticks_max + 1) + 1;
        constexpr std::size_t duration = code::other_duration_cost / 16 + 1;
        constexpr std::size_t first =
            code::cost_max / 16 + (Kind::cubic ? code::break_jump_bits : 0);
        const std::size_t codes = first + (long_parts * jump_cost + 15) / 16;
        return (most + 1) * components * (5 + value_bits) + long_parts * components * 5 +
               (most + 1 + long_parts) * duration + codes;
    }
    // values differ by less than 2^26 steps, places in a chart by less than 2^17
    static constexpr std::size_t exact_stretch_bits =
        (0 + ... +
         (Channels::axes * exact_bits<typename Channels::Kind>(
                               1, 26, reduce::jump_cost<typename Channels::Kind, 1>) +
          Channels::rotations * exact_bits<typename Channels::Kind>(
                                    3, 17, reduce::jump_cost<typename Channels::Kind, 3>)));
    // such a frame tells no ends of vectors; where curves start, none tells its state before
    static constexpr std::size_t exact_overhead_bits =
        (std::max)(overhead_bits(true), 87 + 30 * channel_count + start_bits);
    static_assert(8 * payload_max >= exact_overhead_bits + exact_stretch_bits,
                  "a frame that is given up has a way on");

    template <std::size_t... Index>
    void configure(std::index_sequence<Index...>) noexcept {
        const auto one = [](auto& channel, const PerAxis<axes_most>& tolerance) {
            constexpr std::size_t parts = std::decay_t<decltype(channel)>::parts;
            channel.configure(tolerance.template first<parts>());
        };
        (one(reducer_.template channel<Index>(), params_.tolerance[Index]), ...);
        reduce::Window window;
        // the oldest record of a frame waits for records - 1 pushes, and for the coding
        window.records = static_cast<std::int32_t>(window_records(params_.delay_records));
        const std::int64_t tick = curve::Grid::of_period(0, params_.sample_period_ns).tick_ns();
        window.gap_ticks = static_cast<std::int32_t>(limits(params_).gap_ns / tick);
        window.cost_max =
            static_cast<code::Cost>(16 * (8 * payload_max - overhead_bits(independent())));
        reducer_.configure(window);
    }

    struct Record {
        std::int64_t t_ns;
        Values values;
        std::uint32_t valid, gaps;
        bool new_run;
    };
    /// Takes a record; where a frame must leave before it can be taken, the record waits.
    void take(const Record& r) noexcept {
        // a time that does not rise has nothing to do with those before, whatever the flags say
        const bool rises = r.t_ns > now_ns_;
        if (r.new_run || !running_ || !rises || reducer_.ended_behind(r.t_ns)) {
            if (running_ && !end_curves()) return wait(r);
            begin_run(r);
        }
        const auto drain = [this] { return finish_frame(); };
        const reduce::Taken taken =
            reducer_.push(r.t_ns, r.values, r.valid, r.gaps, seam_at(r.t_ns), drain);
        if (taken == reduce::Taken::blocked) return wait(r);
        now_ns_ = r.t_ns;
        if (taken == reduce::Taken::committed)
            open_frame();
        else if (coding_ && ++waited_ >= spare_)
            finish_frame();
        else if (coding_)
            work_on_frame();
        if (coding_ && !exact_ && spare_ == 0) finish_frame();
    }
    void wait(const Record& r) noexcept {
        waiting_ = r;
        waits_ = true;
    }
    /// Lets out a stretch; takes the record that waits as soon as nothing else does.
    void go_on() noexcept {
        if (!finish_frame() || !waits_ || size_ > 0) return;
        waits_ = false;
        take(waiting_);
    }

    // ---- runs

    void begin_run(const Record& r) noexcept {
        const std::int64_t t_ns = r.t_ns;
        running_ = true;
        ++run_;
        grid_ = curve::Grid::of_period(t_ns, period_ns_);
        reducer_.begin(grid_);
        StreamShape s;
        s.stream_id = params_.stream_id;
        s.run = run_;
        s.base_ns = t_ns;
        s.timing.sub_ns = grid_.sub_ns;
        s.timing.time_bits = time_bits();
        s.timing.independent = independent();
        s.timing.usual_ticks = usual_ticks();
        s.timing.restart_frames = restart_frames();
        s.channels = channel_count;
        describe(s, r, std::index_sequence_for<Channels...>{});
        header_ns_ = restart_ns_ = t_ns;
        restart_after_ns_ =
            params_.restart_interval_ns - grid_.tick_ns() * std::int64_t{s.timing.usual_ticks};
        header_.begin(s);
        put_header(0, true);
        writer_.begin_run(s, header_.digest(), 0);
        events_.repeat();
    }
    template <std::size_t... Index>
    void describe(StreamShape& shape, const Record& r, std::index_sequence<Index...>) noexcept {
        const auto one = [&](auto index, bool turns, std::size_t count) {
            constexpr std::size_t i = decltype(index)::value;
            ChannelShape& c = shape.channel[i];
            c.type = turns ? ChannelType::orientation : ChannelType::vector;
            c.kind = std::tuple_element_t<i, std::tuple<Channels...>>::Kind::id;
            c.axes = static_cast<std::uint8_t>(turns ? 3 : count);
            c.tolerance = 0;
            for (std::size_t a = 0; a < c.axes; ++a) {
                c.step[a] = reducer_.template channel<i>().scale(turns ? 0 : a);
                const float tolerance = params_.tolerance[i][turns ? 0 : a];
                const float ratio = tolerance / c.step[a].template step<float>() * 32768.0f;
                const float up = ratio < 65534.0f ? ratio + 1.0f : 65535.0f;
                c.tolerance = (std::max)(c.tolerance, static_cast<std::uint16_t>(up));
            }
            if ((r.valid >> i & 1u) != 0) set_origin(c, std::get<i>(r.values));
        };
        (one(std::integral_constant<std::size_t, Index>{}, Channels::rotations > 0, Channels::axes),
         ...);
    }
    /// Absolute values are told against the run's first ones.
    static void set_origin(ChannelShape& c, const Quat& q) noexcept {
        put_origin(c, curve::to_grid(normalised(q), c.step[0].template step<float>()));
    }
    template <std::size_t D>
    static void set_origin(ChannelShape& c, const std::array<float, D>& value) noexcept {
        for (std::size_t a = 0; a < D; ++a)
            c.origin[a] = static_cast<std::int32_t>(
                (c.step[a].to_fine(value[a]) + curve::fine / 2) >> curve::fine_bits);
    }
    /// Frames from a restart frame to the next where all have their usual length.
    std::uint8_t restart_frames() const noexcept {
        const std::int64_t interval = params_.restart_interval_ns;
        const std::int64_t frame_ns = grid_.tick_ns() * std::int64_t{usual_ticks()};
        if (interval == every_frame_ns || interval / frame_ns > 255) return 0;
        return static_cast<std::uint8_t>((std::max)(std::int64_t{2}, interval / frame_ns));
    }
    /// Bits of a time that, with the tries of a reader, tell it within two header intervals and
    /// join_ns_max; within lost_ns_max where there is one header only.
    std::uint8_t time_bits() const noexcept {
        const std::int64_t interval = params_.header_interval_ns;
        const std::int64_t reach_ns = interval == never_ns          ? lost_ns_max
                                      : interval <= join_ns_max / 2 ? 2 * interval
                                                                    : join_ns_max;
        const std::int64_t ticks = reach_ns / grid_.tick_ns() + 2;
        std::uint8_t bits = 5;
        while (bits < 32 && (std::int64_t{unwraps} << bits) < ticks) ++bits;
        return bits;
    }
    void put_header(std::int64_t end, bool starts) noexcept {
        if (out_max - size_ < header_max) return;
        size_ += header_.write(end, starts, out_.data() + size_);
    }
    bool independent() const noexcept { return params_.restart_interval_ns == every_frame_ns; }
    std::uint8_t usual_ticks() const noexcept {
        return static_cast<std::uint8_t>(window_records(params_.delay_records) - 1);
    }

    // ---- frames

    /// How a frame that ends now should hand over.
    reduce::Seam seam_at(std::int64_t t_ns) const noexcept {
        if (params_.restart_interval_ns == every_frame_ns) return reduce::Seam::independent;
        // two restart frames never follow each other: the frame between lets a reader trust the
        // first
        if (reducer_.frame().seam == reduce::Seam::restart) return reduce::Seam::carry;
        // the next frame, as long as a usual one, would end too late
        return t_ns - restart_ns_ > restart_after_ns_ ? reduce::Seam::restart : reduce::Seam::carry;
    }

    void open_frame() noexcept {
        coding_ = true;
        checked_ = exact_ = coded_ = false;
        waited_ = 0;
        if (!begins_right(std::index_sequence_for<Channels...>{})) {
            ++strays_;
            return leave_as_steps();
        }
        // the content of a frame of cubics is known when their search is done
        if (!Kinds::cubics) open_whole();
    }
    void open_whole() noexcept {
        const reduce::Frame& frame = reducer_.frame();
        coded_ = open_stretch({0, frame.ticks, true}, frame.seam != reduce::Seam::carry);
    }
    /// Opens a frame for a stretch of the committed one.
    bool open_stretch(const reduce::Stretch& stretch, bool restart) noexcept {
        prepare(stretch, std::index_sequence_for<Channels...>{});
        FrameHead head;
        const std::int64_t start = reducer_.frame().start_subs;
        head.start = start + std::int64_t{stretch.from} * sub_per_tick;
        head.end = start + std::int64_t{stretch.to} * sub_per_tick;
        head.restart = restart && head.end > head.start;
        return writer_.open(head);
    }
    template <std::size_t... Index>
    void prepare(const reduce::Stretch& stretch, std::index_sequence<Index...>) noexcept {
        auto& coder = writer_.prepare();
        const std::int32_t ticks = stretch.to - stretch.from;
        std::size_t axis = 0, rotation = 0;
        const auto one = [&](auto index) {
            constexpr std::size_t i = decltype(index)::value;
            using Tag = std::tuple_element_t<i, std::tuple<Channels...>>;
            const auto& channel = reducer_.template channel<i>();
            const auto& s = channel.segment();
            ChannelFrame& frame = coder.channel[i];
            frame.present = s.present;
            frame.starts = s.present && s.starts;
            frame.goes_on = s.present && !s.ends;
            const bool live = (writer_.states.live >> i & 1u) != 0;
            if (live && !s.present && ticks == 0 && channel.active() && !channel.starts()) {
                // a frame for a single sample of another channel, while this curve goes on
                frame.present = frame.goes_on = true;
            } else {
                frame.over = live && (!s.present || s.starts);
            }
            frame.start_tick =
                static_cast<std::uint8_t>(s.present ? s.start_tick - stretch.from : 0);
            frame.end_tick =
                static_cast<std::uint8_t>(s.present && s.ends ? s.end_tick - stretch.from : ticks);
            if constexpr (Tag::rotations > 0) {
                writer_.first.grid[rotation] = s.start_grid;
                coder.told.grid[rotation] = s.end_grid;
                if (frame.starts) writer_.states.rotation[rotation] = s.start;
                ++rotation;
            } else {
                for (std::size_t k = 0; k < Tag::axes; ++k, ++axis) {
                    if constexpr (Tag::Kind::cubic)
                        coder.told.value[axis] = s.first[k];
                    else
                        coder.told.value[axis] = s.end_v[k];
                    if (frame.starts) states_of<i>()[k] = s.start[k];
                }
            }
        };
        (one(std::integral_constant<std::size_t, Index>{}), ...);
        if constexpr (rotations > 0) tell_grids(coder);
    }
    /// An independent frame tells at its start the grid on which the frame before ended.
    template <class Coder>
    void tell_grids(const Coder& coder) noexcept {
        for (std::size_t c = 0; c < channel_count; ++c) {
            const TrackRange& range = writer_.layout().channel[c];
            if (range.rotates && independent() && !coder.channel[c].starts)
                writer_.first.grid[range.first] = grids_[range.first];
        }
    }
    /// Of the pushes behind a commit, the first third compares and the others code: the search has
    /// the least to do behind a commit, and the more the longer ago it is.
    void work_on_frame() noexcept {
        if (exact_)
            static_cast<void>(let_out_stretch());
        else if (!checked_)
            check_frame(window_max / check_pushes() + 1);
        else
            code_pieces(portion());
    }
    /// Pieces of so many components, or all that are left.
    void code_pieces(std::size_t components) noexcept {
        for (; coded_ && !writer_.done() && components > 0;) {
            const std::size_t n = writer_.rotates() ? 3 : 1;
            components -= n < components ? n : components;
            coded_ = code_piece(std::index_sequence_for<Channels...>{});
        }
    }
    template <std::size_t... Index>
    bool code_piece(std::index_sequence<Index...>) noexcept {
        const auto place = writer_.place();
        bool good = false;
        static_cast<void>(
            ((place.channel == Index && (good = piece_of<Index>(place.track), true)) || ...));
        return good;
    }
    template <std::size_t Index>
    bool piece_of(std::size_t track) noexcept {
        auto& channel = reducer_.template channel<Index>();
        typename std::remove_reference_t<decltype(channel)>::PieceType piece{};
        return channel.next(track, piece) && writer_.piece(piece);
    }

    /// Compares so many samples of each track of the committed frame with its curve, as a decoder
    /// draws it.
    void check_frame(std::size_t samples) noexcept {
        const std::uint32_t before = check_failures();
        checked_ = check_frame(samples, std::index_sequence_for<Channels...>{});
        if (check_failures() != before)
            give_up();
        else if (checked_) {
            rewind(std::index_sequence_for<Channels...>{});
            if (Kinds::cubics) open_whole();
        }
    }
    template <std::size_t... Index>
    bool check_frame(std::size_t samples, std::index_sequence<Index...>) noexcept {
        bool all = true;
        ((all = reducer_.template channel<Index>().check(
                    samples * (Channels::axes > 0 ? Channels::axes : 1)) &&
                all),
         ...);
        return all;
    }
    template <std::size_t... Index>
    void rewind(std::index_sequence<Index...>) noexcept {
        (reducer_.template channel<Index>().rewind(), ...);
    }
    template <std::size_t... Index>
    std::uint32_t failures(std::index_sequence<Index...>) const noexcept {
        return (0u + ... + reducer_.template channel<Index>().failures());
    }
    /// Samples of the first stretch that is tried; where they do not fit, half of them are.
    static constexpr std::size_t exact_samples_max = 16;
    std::size_t check_pushes() const noexcept { return spare_ > 3 ? spare_ / 3 : 1; }
    /// Components of the pieces of a push, so that each of the rest has as many.
    std::size_t portion() const noexcept {
        const std::size_t pushes = spare_ > check_pushes() ? spare_ - check_pushes() : 1;
        return components(std::index_sequence_for<Channels...>{}) / pushes + 1;
    }
    template <std::size_t... Index>
    std::size_t components(std::index_sequence<Index...>) const noexcept {
        return (std::size_t{0} + ... + size_of<Index>());
    }
    template <std::size_t Index>
    std::size_t size_of() const noexcept {
        const auto& channel = reducer_.template channel<Index>();
        return channel.segment().present ? channel.size() : 0;
    }

    /// Lets out the frame, or a stretch of one that was given up. @return true: nothing of it is
    /// left.
    bool finish_frame() noexcept {
        if (!coding_) return true;
        if (!exact_ && !checked_) check_frame(reduce::check_all);
        if (exact_) return let_out_stretch();
        code_pieces(SIZE_MAX);
        const std::size_t size = coded_ ? writer_.close() : 0;
        if (size == 0) {
            ++overflows_;
            give_up();
            return let_out_stretch();
        }
        coding_ = false;
        let_out(size);
        reducer_.release();
        return true;
    }

    // ---- a frame that is given up

    /// The frame leaves as steps instead. What has been coded of it is forgotten.
    void give_up() noexcept {
        put_back(std::index_sequence_for<Channels...>{});
        leave_as_steps();
    }
    void leave_as_steps() noexcept {
        ++given_up_;
        reducer_.give_up();
        exact_ = true;
        exact_from_ = 0;
        exact_samples_ = exact_samples_max;
    }
    /// @return true: it was the last.
    bool let_out_stretch() noexcept {
        const auto states = writer_.states;
        std::size_t size = 0;
        reduce::Stretch stretch;
        for (int tries = 0; size == 0 && tries < 8; ++tries) {
            if (tries > 0) exact_samples_ = (exact_samples_ + 1) / 2;
            writer_.states = states;
            stretch = reducer_.stretch(exact_from_, exact_samples_);
            cut(stretch, std::index_sequence_for<Channels...>{});
            coded_ = open_stretch(stretch, independent());
            code_pieces(SIZE_MAX);
            size = coded_ ? writer_.close() : 0;
        }
        exact_from_ = stretch.to;
        if (size > 0) let_out(size);
        reducer_.drop_to(stretch.to);
        if (!stretch.last) return false;
        exact_ = coding_ = false;
        resume(std::index_sequence_for<Channels...>{});
        reducer_.release();
        return true;
    }
    template <std::size_t Index>
    static constexpr bool rotates =
        std::tuple_element_t<Index, std::tuple<Channels...>>::rotations > 0;
    /// States of the tracks of a channel, as the decoder has them behind what has left.
    template <std::size_t Index>
    auto* states_of() noexcept {
        const TrackRange& range = writer_.layout().channel[Index];
        if constexpr (rotates<Index>)
            return &writer_.states.rotation[range.first];
        else if constexpr (std::tuple_element_t<Index, std::tuple<Channels...>>::Kind::cubic)
            return &writer_.states.cubic[range.first];
        else
            return &writer_.states.axis[range.first];
    }
    template <std::size_t... Index>
    void put_back(std::index_sequence<Index...>) noexcept {
        const auto one = [this](auto index) {
            constexpr std::size_t i = decltype(index)::value;
            const auto& s = reducer_.template channel<i>().segment();
            auto* states = states_of<i>();
            if (!s.present) return;
            if constexpr (rotates<i>)
                *states = s.start;
            else
                for (const auto& state : s.start) *states++ = state;
        };
        (one(std::integral_constant<std::size_t, Index>{}), ...);
    }
    template <std::size_t... Index>
    void cut(const reduce::Stretch& stretch, std::index_sequence<Index...>) noexcept {
        const bool told = independent();
        const auto one = [&](auto index) {
            constexpr std::size_t i = decltype(index)::value;
            if constexpr (rotates<i>)
                reducer_.template channel<i>().cut(stretch, states_of<i>(), told);
            else
                reducer_.template channel<i>().cut(stretch, states_of<i>());
        };
        (one(std::integral_constant<std::size_t, Index>{}), ...);
    }
    template <std::size_t... Index>
    void resume(std::index_sequence<Index...>) noexcept {
        (reducer_.template resume<Index>(states_of<Index>()), ...);
    }
    /// Does the frame begin where the decoder is?
    template <std::size_t... Index>
    bool begins_right(std::index_sequence<Index...>) noexcept {
        return (true && ... && reducer_.template channel<Index>().begins_at(states_of<Index>()));
    }

    /// The bytes of a data frame leave, and a header that is due before them.
    void let_out(std::size_t size) noexcept {
        FAIRLEAD_ASSERT(out_max - size_ >= size + header_max);  // two frames a call at most
        if (out_max - size_ < size + header_max) return;
        if constexpr (rotations > 0)
            for (std::size_t i = 0; i < rotations; ++i) grids_[i] = writer_.told().grid[i];
        const bool restart = writer_.head().restart;
        if (now_ns_ - header_ns_ >= params_.header_interval_ns) {
            header_ns_ = now_ns_;
            put_header(writer_.link().end, false);
        }
        if (restart) {
            restart_ns_ = grid_.time_ns(writer_.head().end);
            ++restarts_;
            if (!independent()) events_.repeat();
        }
        ++frames_;
        for (std::size_t i = 0; i < size; ++i) out_[size_ + i] = writer_.data()[i];
        size_ += size;
    }
    /// @return false: nothing is left.
    bool flush_some() noexcept {
        if (waits_) {
            go_on();
        } else if (coding_) {
            if (checked_ && !exact_ && (writer_.done() || !coded_))
                finish_frame();
            else
                work_on_frame();
        } else {
            const auto drain = [] { return true; };
            if (reducer_.flush(drain) != reduce::Taken::committed) return false;
            open_frame();
        }
        return true;
    }
    /// Ends all curves, and lets them out. @return false: stretches are left.
    bool end_curves() noexcept {
        if (!finish_frame()) return false;
        const auto drain = [] { return true; };
        if (reducer_.flush(drain) != reduce::Taken::committed) return true;
        open_frame();
        return finish_frame();
    }
    void let_out_events(std::uint32_t hold) noexcept {
        if (!running_ || out_max - size_ < EventSender<Events>::frame_max) return;
        size_ += events_.frame(out_.data() + size_, hold, header_.digest(), grid_.base_ns);
    }
    Bytes bytes() const noexcept { return {out_.data(), size_, Status::ok}; }

    Params params_;
    Reducer reducer_{};
    Writer writer_{};
    EventSender<Events> events_{};
    HeaderWriter<header_max> header_{};
    curve::Grid grid_{};
    std::array<curve::GridQuat, rotations> grids_{};
    std::array<std::uint8_t, out_max> out_{};
    std::int64_t now_ns_{0}, header_ns_{0}, restart_ns_{0}, restart_after_ns_{0}, period_ns_{0};
    std::size_t size_{0};
    Record waiting_{};
    std::uint32_t spare_{0}, waited_{0};
    std::uint32_t frames_{0}, restarts_{0}, overflows_{0}, strays_{0}, given_up_{0};
    std::int32_t exact_from_{0};    // of a frame that was given up: what has left of it, in ticks
    std::size_t exact_samples_{0};  // how many samples a stretch may have
    std::uint16_t run_{0};
    bool good_{false}, running_{false}, coding_{false}, coded_{false}, checked_{false};
    bool exact_{false}, waits_{false};
};

}  // namespace fairlead::wire
