#include "host_sim/study/bench_cubics/stream.hpp"

#include <algorithm>
#include <cmath>

#include "fairlead/math/quat.hpp"
#include "host_sim/study/bench_cubics/pieces.hpp"

namespace fairlead::sim::cubics {
namespace {

constexpr std::size_t axes = 3;

/// Values that a restart tells for all axes: 5 bits for their size.
template <class Io>
bool told(Io& io, std::array<std::int32_t, axes>& values) {
    std::uint32_t size = 0;
    for (const std::int32_t v : values)
        size = (std::max)(size, code::bit_count(static_cast<std::uint32_t>(std::abs(v))));
    io.bits(size, 5);
    if (size > 30) return false;
    for (std::int32_t& v : values) {
        auto bits = static_cast<std::uint32_t>(std::abs(v));
        bool minus = v < 0;
        io.bits(bits, size);
        io.flag(minus, 1, 1);
        v = minus ? -static_cast<std::int32_t>(bits) : static_cast<std::int32_t>(bits);
    }
    return true;
}

/// A rotation of the grid: 2 bits, and three numbers of one size.
template <class Io>
void told(Io& io, curve::GridQuat& anchor, double step) {
    const std::int32_t most = curve::grid_size(static_cast<float>(step));
    const std::uint32_t size = code::bit_count(static_cast<std::uint32_t>(2 * most));
    std::uint32_t largest = anchor.largest;
    io.bits(largest, 2);
    anchor.largest = static_cast<std::uint8_t>(largest);
    for (auto& n : anchor.n) {
        auto bits = static_cast<std::uint32_t>(n + most);
        io.bits(bits, size);
        n = static_cast<std::int16_t>(static_cast<std::int32_t>(bits) - most);
    }
}

/// The state of all tracks: an axis each, or one.
template <std::size_t N>
constexpr std::size_t tracks = axes / N;
template <std::size_t N>
using Places = std::array<Place<N>, tracks<N>>;
template <std::size_t N>
using Pieces = std::array<std::vector<Piece<N>>, tracks<N>>;

template <std::size_t N>
bool same(const Places<N>& a, const Places<N>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        const State<N>&x = a[i].chart, &y = b[i].chart;
        if (x.at != y.at || x.last_code != y.last_code || x.last_ticks != y.last_ticks ||
            x.last_k != y.last_k || x.before_k != y.before_k || x.sign != y.sign ||
            x.run != y.run || !y.known || !curve::same(a[i].anchor, b[i].anchor))
            return false;
    }
    return true;
}

/// Draws pieces at whole ticks, and sees how far the curve moves between them.
template <std::size_t N>
class Drawing {
  public:
    Drawing(const Subject<N>& subject, std::size_t size, const Place<N>& start)
        : step_{subject.step()},
          rotates_{subject.rotates()},
          values(size * static_cast<std::size_t>(dim())) {
        const auto first = value(start.anchor, in_steps(start));
        std::copy(first.begin(), first.begin() + dim(), values.begin());
    }
    void operator()(const Span<N>& span, const Quat& anchor, const Place<N>& after,
                    std::int32_t tick, std::int32_t h) {
        if (!span.known) return;
        std::array<double, N> x{};
        for (std::int32_t t = 0; t <= h; ++t) {
            for (std::size_t c = 0; c < N; ++c)
                x[c] = curve::value_at<double>(span, c, static_cast<double>(t));
            const auto now = value(anchor, x);
            if (t > 0)
                std::copy(now.begin(), now.begin() + dim(),
                          values.begin() + static_cast<std::ptrdiff_t>(tick + t) * dim());
        }
        end_ = value(anchor, x);
        if (after.chart.last_code != curve::code::jump)
            seam = (std::max)(seam, moved(end_, value(after.anchor, in_steps(after))));
    }
    /// The frame has ended, where the chart may have moved.
    void at_end(const Place<N>& before, const Place<N>& after) {
        seam = (std::max)(seam, moved(value(before.anchor, in_steps(before)),
                                      value(after.anchor, in_steps(after))));
    }

  private:
    using Value = std::array<double, 4>;
    std::ptrdiff_t dim() const { return rotates_ ? 4 : static_cast<std::ptrdiff_t>(N); }
    static std::array<double, N> in_steps(const Place<N>& place) {
        std::array<double, N> x{};
        for (std::size_t c = 0; c < N; ++c)
            x[c] = static_cast<double>(place.chart.at[c].p) /
                   (6. * static_cast<double>(curve::cubic_unit));
        return x;
    }
    Value value(const Quat& anchor, const std::array<double, N>& steps) const {
        Value out{};
        if constexpr (N == 3) {
            if (rotates_) {
                const auto q =
                    wide(anchor) * exp_of({steps[0] * step_, steps[1] * step_, steps[2] * step_});
                return {q.w, q.x, q.y, q.z};
            }
        }
        for (std::size_t c = 0; c < N; ++c) out[c] = steps[c] * step_;
        return out;
    }
    double moved(const Value& a, const Value& b) const {
        if (rotates_) return rotation_angle(a.data(), b.data());
        double most = 0;
        for (std::size_t c = 0; c < N; ++c) most = (std::max)(most, std::fabs(a[c] - b[c]));
        return most;
    }
    double step_;
    bool rotates_;
    Value end_{};

  public:
    std::vector<double> values;
    double seam{};
};

/// What a frame tells before its pieces.
struct Head {
    bool begins{}, restarts{};
    std::array<std::int32_t, axes> first{};  // values of a vector, or c1 of its runs
    curve::GridQuat anchor{};
};

/// Codes one frame: an encoder is given its pieces, a decoder appends them.
template <std::size_t N, class Io>
class Frame {
  public:
    Frame(Io& io, const Costs& costs, const Subject<N>& subject, float chart_rad, std::int32_t from,
          std::int32_t to)
        : io_{io}, costs_{costs}, subject_{subject}, chart_rad_{chart_rad}, from_{from}, to_{to} {}

    bool code(Places<N>& places, Pieces<N>& pieces, Head head, std::vector<Drawing<N>>* drawing) {
        if ((head.begins || head.restarts) && !start(places, head)) return false;
        for (std::size_t i = 0; i < tracks<N>; ++i)
            if (!track(places[i], pieces[i], head, i * N,
                       drawing == nullptr ? nullptr : &(*drawing)[i]))
                return false;
        return true;
    }

  private:
    bool start(Places<N>& places, Head& head) {
        std::uint32_t time = static_cast<std::uint32_t>(from_) & 255u;
        io_.bits(time, 8);
        if constexpr (N == 3) {
            if (subject_.rotates()) {
                told(io_, head.anchor, subject_.step());
                if (head.restarts) return begin_run(places[0], head.anchor, subject_.step());
                const auto step = static_cast<float>(subject_.step());
                places[0] = {State<N>::begin({}), curve::from_grid(head.anchor, step)};
                return true;
            }
        }
        if (!told(io_, head.first)) return false;
        for (std::size_t i = 0; i < axes && head.begins; ++i) {
            Place<N>& place = places[i / N];
            if (i % N == 0) place.chart = State<N>::begin({});
            place.chart.at[i % N] = curve::at_rest(head.first[i]);
        }
        return true;
    }

    bool track(Place<N>& place, std::vector<Piece<N>>& pieces, const Head& head, std::size_t axis,
               Drawing<N>* draw) {
        std::int32_t tick = from_;
        for (std::size_t i = 0; tick < to_; ++i) {
            Piece<N> p = i < pieces.size() ? pieces[i] : Piece<N>{};
            if (place.chart.run == 3 && p.code != curve::code::jump)
                for (std::size_t c = 0; c < N; ++c)
                    p.k[c] = subject_.rotates() ? 0 : head.first[axis + c];
            Span<N> span;
            const Quat anchor = place.anchor;
            if (!code_piece(io_, costs_, place.chart, to_ - tick, p, span)) return false;
            if (!settle(place, subject_.rotates(), subject_.step(), chart_rad_)) return false;
            if (!Io::writes) pieces.push_back(p);
            const std::int32_t h = p.subs / curve::subs_per_tick;
            if (draw != nullptr) (*draw)(span, anchor, place, tick, h);
            tick += h;
        }
        const Place<N> before = place;
        if constexpr (N == 3)
            if (subject_.rotates() && !rebase(place, subject_.step())) return false;
        if (draw != nullptr) draw->at_end(before, place);
        return tick == to_;
    }

    Io& io_;
    const Costs& costs_;
    const Subject<N>& subject_;
    float chart_rad_;
    std::int32_t from_, to_;
};

/// Encoder, reader in step and reader that joins at each restart, frame after frame.
template <std::size_t N>
class Run {
  public:
    Run(const Track& track, double tolerance, const StreamParams& params, const Costs& costs,
        Counts& counts)
        : track_{track},
          tolerance_{tolerance},
          step_{step_of(track, params.step * tolerance)},
          last_{static_cast<std::int32_t>(track.size()) - 1},
          params_{params},
          costs_{costs},
          counts_{counts} {
        for (std::size_t i = 0; i < tracks<N>; ++i) subjects_.emplace_back(track, i * N, step_);
        begin();
        for (std::size_t i = 0; i < tracks<N>; ++i)
            drawing_.emplace_back(subjects_[i], track.size(), places_[i]);
    }

    Result all() {
        const std::int32_t ticks =
            (std::min)(params_.delay, params_.restart > 0 ? params_.restart : params_.delay) -
            params_.look_ahead;
        const std::int32_t every =
            params_.restart > 0 ? (std::max)(1, params_.restart / ticks) : 1 << 30;  // frames
        std::int32_t number = 0, restarted = 0;
        for (std::int32_t from = 0; from < last_ && result_.fault.empty(); ++number) {
            const bool due =
                params_.rolling ? params_.restart > 0 && from - restarted >= params_.restart - ticks
                                : number > 0 && number % every == 0;
            if (due) restart(), restarted = from;
            from = params_.rolling
                       ? rolling_frame(from, due)
                       : frame(from, (std::min)(last_, from + ticks),
                               (std::min)(last_, from + ticks + params_.look_ahead), -1, due);
        }
        judge();
        return result_;
    }

  private:
    /// Rotations are computed in float, so that their step is one.
    static double step_of(const Track& track, double step) {
        return track.channel == Channel::orientation ? static_cast<double>(static_cast<float>(step))
                                                     : step;
    }

    void begin() {
        head_.begins = true;
        if constexpr (N == 3) {
            if (subjects_[0].rotates()) return begin_rotation();
        }
        for (std::size_t i = 0; i < axes; ++i) {
            head_.first[i] = static_cast<std::int32_t>(std::lround(track_.at(0)[i] / step_));
            places_[i / N].chart.at[i % N] = curve::at_rest(head_.first[i]);
        }
    }

    /// The rotation of the grid nearest to the first sample.
    void begin_rotation() {
        const auto step = static_cast<float>(step_);
        const double* q = track_.at(0);
        const curve::GridQuat rounded =
            curve::to_grid(normalised(Quat{static_cast<float>(q[0]), static_cast<float>(q[1]),
                                           static_cast<float>(q[2]), static_cast<float>(q[3])}),
                           step);
        double least = 1e30;
        for (int way = 0; way < 27; ++way) {
            curve::GridQuat near_by = rounded;
            for (int c = 0, rest = way; c < 3; ++c, rest /= 3) {
                auto& n = near_by.n[static_cast<std::size_t>(c)];
                n = static_cast<std::int16_t>(n + rest % 3 - 1);
            }
            const auto w = wide(curve::from_grid(near_by, step));
            const double told[4] = {w.w, w.x, w.y, w.z};
            const double off = rotation_angle(told, q);
            if (off < least) {
                least = off;
                head_.anchor = near_by;
            }
        }
        places_[0].anchor = curve::from_grid(head_.anchor, step);
    }

    void restart() {
        head_ = {};
        head_.restarts = true;
        for (std::size_t i = 0; i < tracks<N>; ++i) {
            places_[i].chart.restart();
            reader_[i].chart.restart();
            joined_[i] = {State<N>::join(), {}};
        }
        joins_ = true;
    }

    /// A frame whose sample next to its start has waited as long as it may. Its pieces end where
    /// the best of them do, at half the delay or before.
    std::int32_t rolling_frame(std::int32_t from, bool due) {
        const std::int32_t known = (std::min)(last_, from + params_.delay);
        const std::int32_t commit =
            due ? known : from + static_cast<std::int32_t>(params_.delay * params_.commit);
        return frame(from, known, known, known == last_ ? -1 : commit, due);
    }

    std::int32_t frame(std::int32_t from, std::int32_t to, std::int32_t known, std::int32_t commit,
                       bool restarts) {
        Pieces<N> pieces, read, again;
        const double radius = (1 - (subjects_[0].rotates() ? 1e-5 : 2e-6)) * tolerance_ / step_;
        std::int32_t end = to;
        for (std::size_t i = 0; i < tracks<N>; ++i) {
            auto found = search(subjects_[i], places_[i], {from, to, known, radius, commit}, costs_,
                                params_.search);
            if (found.pieces.empty()) {
                result_.fault = "no way on";
                return last_;
            }
            pieces[i] = std::move(found.pieces);
            if (restarts) head_.anchor = found.anchor;
            if (restarts && pieces[i][0].code != curve::code::jump)
                for (std::size_t c = 0; c < N; ++c) head_.first[i * N + c] = pieces[i][0].k[c];
            if (commit >= 0) {
                end = from;
                for (const Piece<N>& p : pieces[i]) end += p.subs / curve::subs_per_tick;
            }
        }
        if (!coded(from, end, pieces, read, again)) return last_;
        head_ = {};
        return end;
    }

    bool coded(std::int32_t from, std::int32_t to, Pieces<N>& pieces, Pieces<N>& read,
               Pieces<N>& again) {
        for (std::size_t i = 0; i < tracks<N>; ++i) tally(i, pieces[i], to - from);
        std::vector<std::uint8_t> bytes(65536);
        code::RangeEncoder encoder{bytes.data(), bytes.size()};
        const float chart = params_.search.chart_rad;
        if (!Frame<N, code::RangeEncoder>{encoder, costs_, subjects_[0], chart, from, to}.code(
                places_, pieces, head_, nullptr))
            return result_.fault = "a piece is out of bounds", false;
        const std::size_t size = encoder.finish();
        // where frames end at vertices, one byte more tells where
        result_.bytes += (params_.rolling ? 4 : 3) + size;
        const Head known{head_.begins, head_.restarts, {}, {}};
        code::RangeDecoder decoder{bytes.data(), size};
        if (!Frame<N, code::RangeDecoder>{decoder, costs_, subjects_[0], chart, from, to}.code(
                reader_, read, known, &drawing_) ||
            !decoder.finished() || !same<N>(places_, reader_))
            return result_.fault = "a reader in step is not", false;
        if (!joins_) return true;
        code::RangeDecoder other{bytes.data(), size};
        if (!Frame<N, code::RangeDecoder>{other, costs_, subjects_[0], chart, from, to}.code(
                joined_, again, known, nullptr) ||
            !same<N>(places_, joined_))
            return result_.fault = "a reader that joined differs", false;
        return true;
    }

    void tally(std::size_t i, const std::vector<Piece<N>>& pieces, std::int32_t ticks) {
        Place<N> place = places_[i];
        if constexpr (N == 3)
            if (subjects_[0].rotates() && head_.restarts)
                static_cast<void>(begin_run(place, head_.anchor, step_));
        std::int32_t left = ticks;
        for (const Piece<N>& p : pieces) {
            Span<N> span;
            count(counts_, place.chart, left, p);
            const bool jump = p.code == curve::code::jump;
            if ((curve::is_line(p.code) || jump) && !place.chart.loose()) {
                ++result_.breaks;
                result_.control_points += jump ? 3 : 2;  // more knots in one place
            }
            static_cast<void>(curve::step(place.chart, p, span));
            static_cast<void>(
                settle(place, subjects_[0].rotates(), step_, params_.search.chart_rad));
            left -= p.subs / curve::subs_per_tick;
            ++result_.pieces;
        }
    }

    void judge() {
        result_.decoded.resize(track_.x.size());
        for (std::size_t i = 0; i < tracks<N>; ++i) {
            const std::vector<double>& x = drawing_[i].values;
            for (std::size_t n = 0; n < x.size(); ++n) {
                const std::size_t at = N == 1 ? n * axes + i : n;
                result_.decoded[at] = x[n];
            }
            result_.seam = (std::max)(result_.seam, drawing_[i].seam / tolerance_);
        }
        const std::size_t dim = track_.dim();
        for (std::size_t i = 0; i < track_.size(); ++i)
            result_.error =
                (std::max)(result_.error, track_.error(i, &result_.decoded[i * dim]) / tolerance_);
        result_.control_points += result_.pieces + 3 * tracks<N>;
    }

    const Track& track_;
    double tolerance_, step_;
    std::int32_t last_;
    const StreamParams& params_;
    const Costs& costs_;
    Counts& counts_;
    std::vector<Subject<N>> subjects_;
    Places<N> places_{}, reader_{}, joined_{};
    std::vector<Drawing<N>> drawing_;
    Head head_{};
    bool joins_{false};
    Result result_;
};

}  // namespace

StreamParams usual_params(Channel channel) {
    StreamParams params;
    if (channel == Channel::position) return params;
    params.step = 1.15;  // the corners of a cell of the lattice are a tolerance from its middle
    params.search.width = 9;
    params.search.margin_bits = 15;
    params.search.control_weight = 4;
    params.search.vertex_weight = 2.2;
    return params;
}

StreamParams knot_params(Channel channel, double piece_bits) {
    StreamParams params = usual_params(channel);
    params.joint = params.rolling = true;
    params.restart = 0;
    params.step = 0.25;
    params.search.piece_bits = piece_bits;
    params.search.width = 8;
    params.search.margin_bits = 2 * piece_bits;
    params.search.control_weight = 0.04;
    params.search.vertex_weight = 0.02;
    return params;
}

Result run(const Track& track, double tolerance, const StreamParams& params, const Costs& costs,
           Counts& counts) {
    if (track.channel == Channel::orientation || params.joint)
        return Run<3>{track, tolerance, params, costs, counts}.all();
    return Run<1>{track, tolerance, params, costs, counts}.all();
}

}  // namespace fairlead::sim::cubics
