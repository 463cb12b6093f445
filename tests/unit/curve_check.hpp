#pragma once
// Reads the committed segments of a reducer as a decoder would, and compares them in double with
// the samples that went in: every sample within its tolerance, in time, exactly once; states that
// go on without a step; costs that bound what a coder writes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "fairlead/code/pieces.hpp"
#include "fairlead/reduce/reducer.hpp"
#include "fairlead/reduce/rotation_channel.hpp"

namespace fairlead::test {

struct Report {
    double worst{0};  // error over tolerance
    std::uint64_t samples{0}, late{0}, uncovered{0}, outside{0}, broken{0}, jumps{0}, pieces{0};
    std::uint64_t frames{0}, rebases{0};
    double bits{0}, most_bits{0};
    std::string first;  // what went wrong first

    void wrong(std::uint64_t& counter, const char* what) {
        ++counter;
        if (first.empty()) first = what;
    }
    bool good() const { return late + uncovered + outside + broken == 0; }
    void add(const Report& r) {
        worst = std::max(worst, r.worst);
        samples += r.samples, late += r.late, uncovered += r.uncovered, outside += r.outside;
        broken += r.broken, jumps += r.jumps, pieces += r.pieces, frames += r.frames;
        rebases += r.rebases, bits += r.bits, most_bits = std::max(most_bits, r.most_bits);
        if (first.empty()) first = r.first;
    }
};

using Quat4 = std::array<double, 4>;
inline Quat4 wide(const Quat& q) {
    return {static_cast<double>(q.w), static_cast<double>(q.x), static_cast<double>(q.y),
            static_cast<double>(q.z)};
}
inline Quat4 product(const Quat4& a, const Quat4& b) {
    return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}
inline Quat4 turned_by(const std::array<double, 3>& v) {
    const double a = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const double s = a > 1e-9 ? std::sin(a / 2) / a : 0.5;
    return {std::cos(a / 2), s * v[0], s * v[1], s * v[2]};
}
inline double angle_between(const Quat4& a, const Quat4& b) {
    double aa = 0, bb = 0, ab = 0, chord = 0;
    for (std::size_t i = 0; i < 4; ++i) aa += a[i] * a[i], bb += b[i] * b[i], ab += a[i] * b[i];
    const double sa = 1 / std::sqrt(aa), sb = (ab < 0 ? -1 : 1) / std::sqrt(bb);
    for (std::size_t i = 0; i < 4; ++i) chord += std::pow(a[i] * sa - b[i] * sb, 2);
    return 4 * std::asin(std::min(1.0, std::sqrt(chord) / 2));
}

/// One stretch of curve with what is needed to draw it.
template <std::size_t N>
struct Stretch {
    std::int64_t from{}, to{};  // sub-ticks of the run
    std::array<double, N> v{};
    std::array<curve::Polynomial<double>, N> c{};
    Quat4 anchor{};
};

/// Follows the committed frames of one channel.
template <class Channel>
class Follower;

template <std::size_t D, class Kind, class BeamT, std::size_t Window>
class Follower<reduce::VectorChannel<D, Kind, BeamT, Window>> {
  public:
    using Channel = reduce::VectorChannel<D, Kind, BeamT, Window>;
    using Value = typename Channel::Value;

    void frame(Channel& channel, const reduce::Frame& frame, Report& report) {
        const auto& s = channel.segment();
        if (!s.present) {
            if (live_) live_ = false;
            return;
        }
        if (!s.starts && !live_) report.wrong(report.broken, "goes on without a start");
        begins_ = s.starts;
        for (std::size_t a = 0; a < D; ++a) {
            if (s.starts) state_[a] = s.start[a];
            axis(channel, frame, a, report);
        }
        live_ = !s.ends;
        to_ = frame.start_subs + 64 * std::int64_t{s.end_tick};
        if (frame.seam == reduce::Seam::restart)
            for (auto& x : state_) x.forget(true);
        if (frame.seam == reduce::Seam::independent)
            for (auto& x : state_) x.forget(false);
    }
    std::int64_t end() const { return to_; }

    double error(double subs, const Value& value, const Channel& channel) {
        double worst = 0;
        for (std::size_t a = 0; a < D; ++a) {
            const auto& all = stretch_[a];
            double y = std::numeric_limits<double>::quiet_NaN();
            for (auto i = all.rbegin(); i != all.rend(); ++i) {
                const bool in =
                    subs > static_cast<double>(i->from) && subs <= static_cast<double>(i->to);
                const bool at_start = subs == static_cast<double>(i->from) && start_at(a, i->from);
                if (!in && !at_start) continue;
                y = at_start ? start_v_[a]
                             : i->v[0] + i->c[0].rise((subs - static_cast<double>(i->from)) / 64);
                break;
            }
            const double e = std::fabs(channel.scale().value(y) - static_cast<double>(value[a]));
            worst = e <= worst ? worst : e;
            if (!(e == e)) return std::numeric_limits<double>::infinity();
        }
        return worst;
    }
    void forget_before(std::int64_t subs) {
        for (auto& all : stretch_)
            while (all.size() > 1 && all.front().to < subs) all.pop_front();
    }

  private:
    bool start_at(std::size_t a, std::int64_t from) const { return start_from_[a] == from; }

    void axis(Channel& channel, const reduce::Frame& frame, std::size_t a, Report& report) {
        const auto& s = channel.segment();
        auto& st = state_[a];
        const auto& t = s.start[a];
        if (st.v != t.v || st.s != t.s || st.last_k != t.last_k || st.sign != t.sign ||
            st.last_code != t.last_code || st.fresh != t.fresh)
            report.wrong(report.broken, "state differs at a frame's start");
        std::int64_t at = frame.start_subs + 64 * std::int64_t{s.start_tick};
        std::int32_t left = (s.end_tick - s.start_tick) * 64;
        if (s.starts) {
            start_from_[a] = at;
            start_v_[a] = st.v[0];
            if (left == 0) stretch_[a].push_back({at, at, {start_v_[a]}, {}, {}});
        }
        const bool told = frame.seam == reduce::Seam::restart && !s.ends;
        code::Counter counter;
        for (curve::Piece<1> p; channel.next(a, p);) {
            const curve::State<1> before = st;
            curve::Piece<1> q = p;
            if (!code::code_piece<Kind>(counter, code::costs<Kind, 1>, st, q, left,
                                        told ? code::End::told : code::End::coded, &s.end_v[a]) ||
                q.k != p.k || q.subs != p.subs || q.code != p.code)
                return report.wrong(report.broken, "a piece that no coder takes");
            ++report.pieces;
            const bool jump = p.code == curve::code::jump;
            report.jumps += jump ? 1 : 0;
            const double v = jump ? st.v[0] : before.v[0];
            stretch_[a].push_back({at,
                                   at + p.subs,
                                   {v},
                                   {curve::polynomial<double>(
                                       p.code, before.fresh, before.s[0],
                                       static_cast<double>(st.v[0] - before.v[0]), p.subs / 64)},
                                   {}});
            at += p.subs;
            left -= p.subs;
        }
        if (left != 0) report.wrong(report.broken, "pieces do not fill the frame");
        if (st.v[0] != s.end_v[a]) report.wrong(report.broken, "the end is not as told");
        cost_ = counter.cost();
        report.bits += counter.cost() / 16.0;
        frame_bits += counter.cost() / 16.0;
    }

    std::array<curve::State<1>, D> state_{};
    std::array<std::deque<Stretch<1>>, D> stretch_{};
    std::array<std::int64_t, D> start_from_{};
    std::array<double, D> start_v_{};
    std::int64_t to_{INT64_MIN};
    code::Cost cost_{};
    bool live_{false}, begins_{false};

  public:
    double frame_bits{0};
};

template <class Kind, class BeamT, std::size_t Window>
class Follower<reduce::RotationChannel<Kind, BeamT, Window>> {
  public:
    using Channel = reduce::RotationChannel<Kind, BeamT, Window>;

    void frame(Channel& channel, const reduce::Frame& frame, Report& report) {
        const auto& s = channel.segment();
        if (!s.present) {
            live_ = false;
            return;
        }
        if (!s.starts && !live_) report.wrong(report.broken, "goes on without a start");
        const float step = channel.step();
        std::int64_t at = frame.start_subs + 64 * std::int64_t{s.start_tick};
        std::int32_t left = (s.end_tick - s.start_tick) * 64;
        if (s.starts) {
            state_ = {};
            state_.anchor = curve::from_grid(s.start_grid, step);
            stretch_.push_back({at, at, {}, {}, wide(state_.anchor)});
        }
        same(state_, s.start, report, "state differs at a frame's start");
        const bool told = frame.seam != reduce::Seam::carry && !s.ends;
        code::Counter counter;
        bool landed = false;
        for (curve::Piece<3> p; channel.next(0, p);) {
            const curve::RotationState before = state_;
            curve::Piece<3> q = p;
            if (landed || !code::code_piece<Kind>(counter, code::costs<Kind, 3>, state_.chart, q,
                                                  left, told ? code::End::told : code::End::coded))
                return report.wrong(report.broken, "a piece that no coder takes");
            if (p.code == curve::code::rebase) {
                curve::rebase(state_, step);
                ++report.rebases;
                continue;
            }
            ++report.pieces;
            const bool jump = p.code == curve::code::jump;
            report.jumps += jump ? 1 : 0;
            left -= p.subs;
            std::array<float, 3> end{};
            Quat target;
            landed = told && left == 0;
            if (landed) {
                target = curve::from_grid(s.end_grid, step);
                end = curve::place(before.anchor, target, step);
            }
            Stretch<3> z{at, at + p.subs, {}, {}, wide(before.anchor)};
            for (std::size_t a = 0; a < 3; ++a) {
                const auto& b = before.chart;
                z.v[a] = jump ? state_.chart.v[a] : b.v[a];
                const double rise = landed && !jump
                                        ? static_cast<double>(end[a]) - b.v[a]
                                        : static_cast<double>(state_.chart.v[a] - b.v[a]);
                z.c[a] = curve::polynomial<double>(p.code, b.fresh, b.s[a], rise, p.subs / 64);
            }
            stretch_.push_back(z);
            if (landed) curve::step_onto(state_, p.code, p.subs, target, end, step);
            at += p.subs;
        }
        if (left != 0) report.wrong(report.broken, "pieces do not fill the frame");
        if (told && !landed) report.wrong(report.broken, "the end is not where it was told");
        if (told)
            state_.chart.forget(frame.seam == reduce::Seam::restart);
        else
            curve::rebase(state_, step);
        live_ = !s.ends;
        to_ = frame.start_subs + 64 * std::int64_t{s.end_tick};
        report.bits += counter.cost() / 16.0;
        frame_bits += counter.cost() / 16.0;
    }
    std::int64_t end() const { return to_; }

    double error(double subs, const Quat& value, const Channel& channel) {
        for (auto i = stretch_.rbegin(); i != stretch_.rend(); ++i) {
            const bool point = i->from == i->to;
            const bool in =
                point ? subs == static_cast<double>(i->from)
                      : subs > static_cast<double>(i->from) && subs <= static_cast<double>(i->to);
            if (!in) continue;
            std::array<double, 3> theta{};
            for (std::size_t a = 0; a < 3; ++a)
                theta[a] = channel.scale().value(
                    i->v[a] + i->c[a].rise((subs - static_cast<double>(i->from)) / 64));
            return angle_between(product(i->anchor, turned_by(theta)), wide(value));
        }
        return std::numeric_limits<double>::infinity();
    }
    void forget_before(std::int64_t subs) {
        while (stretch_.size() > 1 && stretch_.front().to < subs) stretch_.pop_front();
    }

  private:
    static void same(const curve::RotationState& a, const curve::RotationState& b, Report& report,
                     const char* what) {
        const bool q = a.anchor.w == b.anchor.w && a.anchor.x == b.anchor.x &&
                       a.anchor.y == b.anchor.y && a.anchor.z == b.anchor.z;
        const auto &c = a.chart, &d = b.chart;
        if (!q || c.v != d.v || c.s != d.s || c.last_k != d.last_k || c.sign != d.sign ||
            c.last_code != d.last_code || c.fresh != d.fresh)
            report.wrong(report.broken, what);
    }

    curve::RotationState state_{};
    std::deque<Stretch<3>> stretch_{};
    std::int64_t to_{INT64_MIN};
    bool live_{false};

  public:
    double frame_bits{0};
};

/// Pushes records into a reducer and checks what it commits.
template <class... Channels>
class CurveCheck {
  public:
    using Reducer = reduce::Reducer<Channels...>;
    using Values = typename Reducer::Values;

    CurveCheck(Reducer& reducer, const curve::Grid& grid,
               const std::array<float, sizeof...(Channels)>& tolerance,
               const reduce::Window& window)
        : reducer_{reducer}, tolerance_{tolerance}, records_{window.records} {
        configure(std::index_sequence_for<Channels...>{});
        reducer_.configure(window);
        reducer_.begin(grid);
    }
    Report report;

    void push(std::int64_t t_ns, const Values& values, std::uint32_t valid, std::uint32_t gaps,
              reduce::Seam seam) {
        waiting_.push_back({t_ns, values, valid, index_++});
        ++report.samples;
        const auto nothing_left = [] { return true; };
        if (reducer_.push(t_ns, values, valid, gaps, seam, nothing_left) ==
            reduce::Taken::committed)
            take();
        while (!waiting_.empty() && waiting_.front().valid == 0) waiting_.pop_front();
        if (!waiting_.empty() && index_ - waiting_.front().index > records_)
            report.wrong(report.late, "a record waits too long");
    }
    void finish() {
        if (reducer_.flush([] { return true; }) == reduce::Taken::committed) take();
        for (const auto& w : waiting_)
            if (w.valid != 0) report.wrong(report.uncovered, "a record is not covered");
    }

  private:
    struct Waiting {
        std::int64_t t_ns;
        Values values;
        std::uint32_t valid;
        std::int64_t index;
    };
    template <std::size_t... I>
    void configure(std::index_sequence<I...>) {
        (reducer_.template channel<I>().configure(tolerance_[I]), ...);
        ((failures_[I] = reducer_.template channel<I>().failures()), ...);
    }
    void take() {
        ++report.frames;
        frame_bits_ = 0;
        take(std::index_sequence_for<Channels...>{});
        report.most_bits = std::max(report.most_bits, frame_bits_);
        reducer_.release();
        while (!waiting_.empty() && waiting_.front().valid == 0) waiting_.pop_front();
    }
    template <std::size_t... I>
    void take(std::index_sequence<I...>) {
        (one<I>(), ...);
    }
    template <std::size_t I>
    void one() {
        auto& channel = reducer_.template channel<I>();
        auto& follower = std::get<I>(followers_);
        follower.frame_bits = 0;
        for (int i = 0; i < 1000 && !channel.check(7); ++i) {
        }
        if (channel.failures() != failures_[I]) {
            failures_[I] = channel.failures();
            report.wrong(report.broken, "the reducer's own check fails");
        }
        channel.rewind();
        follower.frame(channel, reducer_.frame(), report);
        frame_bits_ += follower.frame_bits;
        if (!channel.segment().present) return;
        const auto& grid = reducer_.grid();
        for (auto& w : waiting_) {
            if ((w.valid >> I & 1u) == 0) continue;
            const double subs =
                static_cast<double>(w.t_ns - grid.base_ns) / static_cast<double>(grid.sub_ns);
            if (subs > static_cast<double>(follower.end())) break;
            const double e = follower.error(subs, std::get<I>(w.values), channel) /
                             static_cast<double>(tolerance_[I]);
            report.worst = std::max(report.worst, e);
            if (!(e <= 1)) report.wrong(report.outside, "a sample is outside the tolerance");
            w.valid &= ~(1u << I);
        }
        follower.forget_before(follower.end() - 64);
    }

    Reducer& reducer_;
    std::array<float, sizeof...(Channels)> tolerance_;
    std::int64_t records_, index_{0};
    std::tuple<Follower<Channels>...> followers_{};
    std::deque<Waiting> waiting_{};
    double frame_bits_{0};
    std::array<std::uint32_t, sizeof...(Channels)> failures_{};
};

}  // namespace fairlead::test
