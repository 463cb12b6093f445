#include "host_sim/study/bench_cubics/stream.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/study/bench_cubics/pieces.hpp"

namespace fairlead::sim::cubics {
namespace {

constexpr std::size_t axes = 3;
using States = std::array<State, axes>;
using Values = std::array<std::int32_t, axes>;

void count(Counts& counts, const State& s, std::int32_t left, const Piece& p) {
    const bool line = curve::is_line(p.code);
    if (p.code == curve::code::jump) return;
    const std::int32_t h = p.subs / curve::subs_per_tick;
    const bool ends = p.code == curve::code::to_end;
    if (s.run == 0 && !s.loose())
        ++counts.way[way_row(s, left)][static_cast<std::size_t>(line   ? Way::breaks
                                                                : ends ? Way::to_end
                                                                       : Way::listed)];
    if (line) ++counts.line[p.code - curve::code::line];
    if (!line && !ends && (s.run == 0 || s.run == 3)) ++counts.length[length_row(s)][p.code];
    if (s.run == 3) return;
    const std::int8_t sign = s.run > 0 || line ? std::int8_t{0} : s.sign[0];
    ++counts.value[value_row(s, h, line)][code::value_symbol(p.k[0], sign)];
}

/// Values that a restart tells for all axes: 5 bits for their size.
template <class Io>
bool told(Io& io, Values& values) {
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

/// Draws a piece at whole ticks.
struct Drawing {
    std::vector<double>* values;
    double step;
    double* seam;

    void operator()(const Span& span, const State& after, std::int32_t tick, std::int32_t h) const {
        if (!span.known || values == nullptr) return;
        for (std::int32_t t = 1; t <= h; ++t)
            (*values)[static_cast<std::size_t>(tick + t)] =
                step * curve::value_at<double>(span, 0, static_cast<double>(t));
        const curve::CubicVertex end = curve::piece_end(span.start[0], h, span.j[0]);
        if (after.last_code == curve::code::jump) return;
        *seam = (std::max)(*seam, std::fabs(static_cast<double>(end.p - after.at[0].p)) /
                                      (6. * static_cast<double>(curve::cubic_unit)) * step);
    }
};

/// Codes the pieces of one frame: an encoder is given them, a decoder appends them.
template <class Io>
class Frame {
  public:
    Frame(Io& io, const Costs& costs, std::int32_t from, std::int32_t to)
        : io_{io}, costs_{costs}, from_{from}, to_{to} {}

    /// first: values at the start of the curve, or c1 of each axis's run, or nothing.
    bool code(States& states, std::array<std::vector<Piece>, axes>& pieces, bool begins,
              const std::array<Drawing, axes>& drawing) {
        Values first{};
        const bool restarts = states[0].run == 3;
        if (restarts || begins) {
            std::uint32_t time = static_cast<std::uint32_t>(from_) & 255u;
            io_.bits(time, 8);
            for (std::size_t a = 0; a < axes; ++a) {
                if (!Io::writes) continue;
                if (begins) first[a] = curve::lattice_near(states[a].at[0]);
                if (restarts && pieces[a][0].code != curve::code::jump)
                    first[a] = pieces[a][0].k[0];
            }
            if (!told(io_, first)) return false;
            if (begins)
                for (std::size_t a = 0; a < axes; ++a) states[a] = State::begin({first[a]});
        }
        for (std::size_t a = 0; a < axes; ++a)
            if (!axis(states[a], pieces[a], first[a], drawing[a])) return false;
        return true;
    }

  private:
    bool axis(State& s, std::vector<Piece>& pieces, std::int32_t first, const Drawing& draw) {
        std::int32_t tick = from_;
        for (std::size_t i = 0; tick < to_; ++i) {
            Piece p = i < pieces.size() ? pieces[i] : Piece{};
            if (s.run == 3 && p.code != curve::code::jump) p.k[0] = first;
            Span span;
            if (!code_piece(io_, costs_, s, to_ - tick, p, span)) return false;
            if (!Io::writes) pieces.push_back(p);
            const std::int32_t h = p.subs / curve::subs_per_tick;
            draw(span, s, tick, h);
            tick += h;
        }
        return tick == to_;
    }
    Io& io_;
    const Costs& costs_;
    std::int32_t from_, to_;
};

bool same(const States& a, const States& b) {
    for (std::size_t i = 0; i < axes; ++i)
        if (a[i].at[0] != b[i].at[0] || a[i].last_code != b[i].last_code ||
            a[i].last_k != b[i].last_k || a[i].run != b[i].run || !b[i].known)
            return false;
    return true;
}

/// Encoder, reader in step and reader that joins at each restart, frame after frame.
class Run {
  public:
    Run(const Track& track, double tolerance, const StreamParams& params, const Costs& costs,
        Counts& counts)
        : track_{track},
          tolerance_{tolerance},
          step_{params.step * tolerance},
          params_{params},
          costs_{costs},
          counts_{counts} {
        for (std::size_t a = 0; a < axes; ++a) {
            std::vector<double> x;
            for (std::size_t i = 0; i < track.size(); ++i) x.push_back(track.at(i)[a] / step_);
            states_[a] = State::begin({static_cast<std::int32_t>(std::lround(x[0]))});
            decoded_[a].assign(x.size(), step_ * curve::lattice_near(states_[a].at[0]));
            samples_.emplace_back(std::move(x));
        }
    }

    Result all() {
        const auto last = static_cast<std::int32_t>(track_.size()) - 1;
        const std::int32_t ticks = (std::min)(params_.delay, params_.restart) - params_.look_ahead;
        const std::int32_t restart = (std::max)(1, params_.restart / ticks);  // in frames
        std::int32_t number = 0;
        for (std::int32_t from = 0; from < last && result_.fault.empty(); ++number) {
            const std::int32_t to = (std::min)(last, from + ticks);
            if (number > 0 && number % restart == 0) begin_run();
            frame(from, to, (std::min)(last, to + params_.look_ahead));
            from = to;
        }
        judge();
        return result_;
    }

  private:
    void begin_run() {
        for (std::size_t a = 0; a < axes; ++a) {
            states_[a].restart();
            reader_[a].restart();
            joined_[a] = State::join();
        }
        joins_ = true;
    }

    void frame(std::int32_t from, std::int32_t to, std::int32_t known) {
        std::array<std::vector<Piece>, axes> pieces, read, again;
        const double radius = (1 - 2e-6) / params_.step;
        for (std::size_t a = 0; a < axes; ++a) {
            pieces[a] =
                search(samples_[a], states_[a], from, to, known, radius, costs_, params_.search);
            tally(a, pieces[a], to - from);
        }
        std::vector<std::uint8_t> bytes(65536);
        code::RangeEncoder encoder{bytes.data(), bytes.size()};
        const std::array<Drawing, axes> none{};
        if (!Frame{encoder, costs_, from, to}.code(states_, pieces, from == 0, none))
            result_.fault = "a piece is out of bounds";
        const std::size_t size = encoder.finish();
        result_.bytes += 3 + size;
        code::RangeDecoder decoder{bytes.data(), size};
        const std::array<Drawing, axes> draw{Drawing{&decoded_[0], step_, &result_.seam},
                                             Drawing{&decoded_[1], step_, &result_.seam},
                                             Drawing{&decoded_[2], step_, &result_.seam}};
        if (!Frame{decoder, costs_, from, to}.code(reader_, read, from == 0, draw) ||
            !decoder.finished() || !same(states_, reader_))
            result_.fault = "a reader in step is not";
        if (!joins_) return;
        code::RangeDecoder other{bytes.data(), size};
        if (!Frame{other, costs_, from, to}.code(joined_, again, false, none) ||
            !same(states_, joined_))
            result_.fault = "a reader that joined differs";
    }

    void tally(std::size_t a, const std::vector<Piece>& pieces, std::int32_t ticks) {
        State s = states_[a];
        std::int32_t left = ticks;
        for (const Piece& p : pieces) {
            Span span;
            count(counts_, s, left, p);
            const bool breaks = curve::is_line(p.code) || p.code == curve::code::jump;
            if (breaks && !s.loose()) ++result_.breaks;
            static_cast<void>(curve::step(s, p, span));
            left -= p.subs / curve::subs_per_tick;
            ++result_.pieces;
        }
    }

    void judge() {
        double sum = 0;
        std::size_t n = 0;
        const std::size_t size = track_.size();
        for (std::size_t a = 0; a < axes; ++a) {
            const auto x = [&](std::size_t i) { return track_.at(i)[a]; };
            for (std::size_t i = 0; i < size; ++i)
                result_.error =
                    (std::max)(result_.error, std::fabs(decoded_[a][i] - x(i)) / tolerance_);
            for (std::size_t i = 5; i + 6 < size; ++i, ++n) {
                const double mean = (x(i + 5) - x(i - 4)) / 9;  // of the differences
                const double off = decoded_[a][i + 1] - decoded_[a][i] - mean;
                sum += off * off / (track_.period_s * track_.period_s);
            }
        }
        result_.velocity = n > 0 ? std::sqrt(sum / static_cast<double>(n) * axes) : 0;
        result_.seam /= tolerance_;
    }

    const Track& track_;
    double tolerance_, step_;
    const StreamParams& params_;
    const Costs& costs_;
    Counts& counts_;
    std::vector<Samples> samples_;
    std::array<std::vector<double>, axes> decoded_;
    States states_{}, reader_{}, joined_{};
    bool joins_{false};
    Result result_;
};

}  // namespace

Result run(const Track& track, double tolerance, const StreamParams& params, const Costs& costs,
           Counts& counts) {
    return Run{track, tolerance, params, costs, counts}.all();
}

}  // namespace fairlead::sim::cubics
