// Counts the symbols that the reducer commits on recordings: what tables.py makes costs of.
//
//     count vector|rotation FILE...
//
// Each recording is cut to its longest clean minute and reduced at several delays and tolerances,
// with restarts every 2 s. A stream's counts are weighted by the inverse of its size, so that every
// recording, delay and tolerance counts alike. Output: one line a row, "length ROW COUNTS..." and
// "value ROW COUNTS...".
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "fairlead/code/pieces.hpp"
#include "fairlead/reduce/reducer.hpp"
#include "fairlead/reduce/rotation_channel.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/study/baselines/track.hpp"

namespace {

using namespace fairlead;
using Kind = curve::Smooth;
using Width = reduce::BeamSize<4, 40>;
constexpr std::size_t longest = 240;
using Vectors = reduce::VectorChannel<3, Kind, Width, longest>;
using Rotations = reduce::RotationChannel<Kind, Width, longest>;

template <std::size_t N>
struct Tally {
    double length[code::length_rows][Kind::codes]{};
    double value[code::value_rows<N>][code::value_symbols]{};
    double cost{0};

    void add(const Tally& other, double weight) {
        for (std::size_t r = 0; r < code::length_rows; ++r)
            for (std::size_t s = 0; s < Kind::codes; ++s)
                length[r][s] += weight * other.length[r][s];
        for (std::size_t r = 0; r < code::value_rows<N>; ++r)
            for (std::size_t s = 0; s < code::value_symbols; ++s)
                value[r][s] += weight * other.value[r][s];
    }
    /// One piece, before the state takes it.
    void see(const curve::State<N>& state, const curve::Piece<N>& piece, bool told) {
        if (state.phase != 0) return;
        const bool mapped = state.loose() && curve::is_line(piece.code);
        const auto c = static_cast<std::uint8_t>(piece.code - (mapped ? curve::code::line : 0));
        length[code::length_row(state)][c] += 1;
        if (told || c == curve::code::jump || c == curve::code::rebase) return;
        bool before = false;
        const std::int32_t h = piece.subs / curve::subs_per_tick;
        for (std::size_t i = 0; i < N; ++i) {
            const std::size_t row = code::value_row<Kind>(state, c, h, i, before);
            value[row][code::value_symbol(piece.k[i], state.sign[i])] += 1;
            before = before || piece.k[i] != 0;
        }
    }
    void print() const {
        for (std::size_t r = 0; r < code::length_rows; ++r) {
            std::printf("length %zu", r);
            for (const double c : length[r]) std::printf(" %.4f", c);
            std::printf("\n");
        }
        for (std::size_t r = 0; r < code::value_rows<N>; ++r) {
            std::printf("value %zu", r);
            for (const double c : value[r]) std::printf(" %.4f", c);
            std::printf("\n");
        }
    }
};

Vectors::Value value_of(const Pose& p, Vectors*) { return {p.p_w_m.x, p.p_w_m.y, p.p_w_m.z}; }
Quat value_of(const Pose& p, Rotations*) { return p.q_wb; }

/// The symbols of one committed frame.
template <std::size_t N>
void see_frame(Vectors& channel, reduce::Seam seam, Tally<N>& tally) {
    const auto& segment = channel.segment();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        curve::State<1> state = segment.start[axis];
        std::int32_t left = (segment.end_tick - segment.start_tick) * curve::subs_per_tick;
        for (curve::Piece<1> piece; channel.next(axis, piece); left -= piece.subs) {
            tally.see(state, piece, seam == reduce::Seam::restart && piece.subs == left);
            curve::step(state, piece);
        }
    }
}
template <std::size_t N>
void see_frame(Rotations& channel, reduce::Seam seam, Tally<N>& tally) {
    const auto& segment = channel.segment();
    curve::RotationState state = segment.start;
    std::int32_t left = (segment.end_tick - segment.start_tick) * curve::subs_per_tick;
    for (curve::Piece<3> piece; channel.next(0, piece); left -= piece.subs) {
        tally.see(state.chart, piece, seam == reduce::Seam::restart && piece.subs == left);
        if (piece.code == curve::code::rebase)
            curve::rebase(state, channel.step());
        else
            curve::step(state.chart, piece);
    }
}

template <class Channel>
double reduce(const sim::Recording& recording, double tolerance, std::int32_t delay,
              Tally<Channel::components>& tally) {
    static reduce::Reducer<Channel> reducer;
    auto& channel = reducer.template channel<0>();
    channel.configure(static_cast<float>(tolerance));
    reducer.configure({delay, 32, 16 * 1400});
    const auto period = static_cast<std::int64_t>(std::llround(recording.period_s * 1e9));
    const std::int64_t base = recording.poses.front().t_ns;
    reducer.begin(curve::Grid::of_period(base, period));
    std::int64_t restarted = base;
    double bytes = 0;
    const auto take = [&] {
        const reduce::Frame& frame = reducer.frame();
        see_frame(channel, frame.seam, tally);
        bytes += 8;
        if (frame.seam == reduce::Seam::restart)
            restarted = reducer.grid().time_ns(frame.start_subs + std::int64_t{64} * frame.ticks);
        reducer.release();
    };
    const auto nothing_left = [] { return true; };
    for (const Pose& pose : recording.poses) {
        const bool due = pose.t_ns - restarted >= 2'000'000'000 - delay / 4 * period;
        const auto seam = due ? reduce::Seam::restart : reduce::Seam::carry;
        if (reducer.push(pose.t_ns, {value_of(pose, static_cast<Channel*>(nullptr))}, 1, 0, seam,
                         nothing_left) == reduce::Taken::committed)
            take();
    }
    if (reducer.flush(nothing_left) == reduce::Taken::committed) take();
    return bytes;
}

/// -log2 of the share of what was counted, in bits: how large the stream is by its own statistics.
template <std::size_t N>
double size_of(const Tally<N>& tally) {
    double bits = 0;
    const auto add = [&](const double* row, std::size_t n) {
        double all = 0;
        for (std::size_t i = 0; i < n; ++i) all += row[i];
        for (std::size_t i = 0; i < n; ++i)
            if (row[i] > 0) bits -= row[i] * std::log2(row[i] / all);
    };
    for (const auto& row : tally.length) add(row, Kind::codes);
    for (const auto& row : tally.value) add(row, code::value_symbols);
    return bits / 8;
}

template <class Channel>
void count(const std::vector<sim::Recording>& recordings, const std::vector<double>& tolerances) {
    constexpr std::size_t n = Channel::components;
    Tally<n> all;
    for (const auto& recording : recordings)
        for (const double tolerance : tolerances)
            for (const std::int32_t delay : {58, 59, 117, 119, 238}) {
                Tally<n> one;
                const double frames = reduce<Channel>(recording, tolerance, delay, one);
                all.add(one, 1000 / (frames + size_of(one)));
            }
    all.print();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: count vector|rotation FILE...\n");
        return 2;
    }
    const bool vectors = std::strcmp(argv[1], "vector") == 0;
    std::vector<sim::Recording> recordings;
    for (int i = 2; i < argc; ++i) {
        const auto channel = vectors ? sim::Channel::position : sim::Channel::orientation;
        recordings.push_back(sim::cut(sim::read_recording(argv[i]), channel));
    }
    const double degree = std::acos(-1.0) / 180;
    if (vectors)
        count<Vectors>(recordings, {0.001, 0.002, 0.005});
    else
        count<Rotations>(recordings, {0.25 * degree, 0.5 * degree, degree});
}
