// Runs hostile but accepted motion through the pipeline, reads the stream back, and prints what
// came of it: one line of counts and a digest of the bytes. flags.py builds it with many flags.
// Nothing here may crash, hang or write outside its memory, whatever the flags do to the
// arithmetic; with flags that keep IEEE 754, nothing may leave the tolerance either.
#include <array>
#include <cstdio>
#include <cstring>

#include <vector>

#include "fairlead/base/arithmetic.hpp"
#include "fairlead/pipeline.hpp"
#include "fairlead/wire/live.hpp"

using namespace fairlead;

namespace {

constexpr std::size_t window = 24;
constexpr float tol_m = 0.001f, tol_rad = 0.01f;
struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, fairlead::Orientation>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = window;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = 0;
};
using Whole = Pipeline<Board>;

/// A pipeline between guard words: an overrun of its memory changes them.
struct Guarded {
    std::array<std::uint64_t, 64> before{};
    Whole pipeline;
    std::array<std::uint64_t, 64> after{};
};

struct Random {
    std::uint32_t state;
    std::uint32_t next() {
        state = state * 1664525u + 1013904223u;
        return state >> 8;
    }
    float within_one() { return static_cast<float>(next()) / 8388608.0f - 1; }
};

/// The motions: how far a hand is after i records. Each tries another way to leave a curve behind.
constexpr int kinds = 8;
float place(int kind, int i, Random& random) {
    const auto steps = static_cast<float>(i);
    switch (kind) {
        case 0: return 0.3f * approx::sin(0.05f * steps) + 0.0003f * random.within_one();
        case 1: return random.within_one();                     // jumps each record
        case 2: return i % 97 == 50 ? 9000.0f : 0.01f * steps;  // one record far off
        case 3: return 5000.0f * random.within_one();           // far off, always
        case 4: return 1e-38f * random.within_one();            // denormal numbers
        case 5: return i % 2 == 0 ? 0.0011f : -0.0011f;         // just beyond the tolerance
        case 6: return 0.0001f * steps * steps;                 // faster and faster
        default: return i % 40 < 20 ? 0.0f : 8000.0f + 0.5f * random.within_one();  // steps
    }
}

std::int64_t pause_ns(int kind, Random& random) {
    if (kind == 1) return 4000000 + static_cast<std::int64_t>(random.next() % 90000000u);
    return 8333333;
}

/// Reads the stream as a reader would, and measures in double how far the curves pass from each
/// sample.
struct Reader {
    wire::Decoder<3, 1> decoder{};
    struct Held {
        wire::CurvePiece piece;
        curve::Grid grid;
    };
    std::array<std::vector<Held>, 4> tracks{};  // three axes and the rotation, in order of time
    std::uint64_t sent{0};

    void take() {
        for (wire::CurvePiece piece; decoder.next(piece);)
            if (piece.end > piece.start || piece.begins)
                tracks[piece.rotates ? 3 : piece.axis % 3].push_back({piece, decoder.grid()});
    }
    void read(const Bytes& bytes) {
        sent += bytes.size;
        for (const std::uint8_t byte : bytes)
            if (decoder.push(byte)) take();
    }
    /// Largest error over tolerance of a sample; below 0: it is not covered.
    double error(const Pose& pose, std::array<std::size_t, 4>& at) const {
        const float p[] = {pose.p_w_m.x, pose.p_w_m.y, pose.p_w_m.z};
        double most = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const auto& track = tracks[k];
            while (at[k] < track.size() &&
                   track[at[k]].grid.time_ns(track[at[k]].piece.end) < pose.t_ns)
                ++at[k];
            if (at[k] == track.size()) return -1;
            const auto& [piece, grid] = track[at[k]];
            if (!wire::holds_at(piece, grid, pose.t_ns)) return -1;
            const double e = k < 3 ? (wire::axis_motion<double>(piece, grid, pose.t_ns).value -
                                      static_cast<double>(p[k])) /
                                         static_cast<double>(tol_m)
                                   : turn(piece, grid, pose) / static_cast<double>(tol_rad);
            const double size = e < 0 ? -e : e;
            if (!(size <= most)) most = size;
        }
        return most;
    }
    /// Angle between the curve and the sample: the sine of its half, twice.
    static double turn(const wire::CurvePiece& piece, const curve::Grid& grid, const Pose& pose) {
        const auto told = wire::orientation_motion<double>(piece, grid, pose.t_ns).q_wb;
        const Quat& q = pose.q_wb;
        const BasicQuat<double> truth{static_cast<double>(q.w), static_cast<double>(q.x),
                                      static_cast<double>(q.y), static_cast<double>(q.z)};
        const auto apart = vec(conj(told) * truth);
        return 2 * norm(apart) / approx::sqrt(dot(truth, truth));
    }
};

std::uint64_t digest = 14695981039346656037u;  // FNV-1a
std::uint32_t samples = 0, breaks = 0, beyond = 0, failures = 0;
double worst = 0;

/// What a start-up object of -ffast-math does to the processor.
void flush_to_zero() {
#ifdef __SSE__
    __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040u);
#endif
}

void fail(const char* what, int kind) {
    std::printf("motion %d: %s\n", kind, what);
    ++failures;
}

Whole::Params params() {
    Whole::Params p;
    p.sample_period_ns = 8'333'333;
    p.tolerance.position_m = tol_m;
    p.tolerance.orientation_rad = tol_rad;
    return p;
}

Pose pose_of(int kind, int i, std::int64_t t_ns, Random& random) {
    Pose pose;
    pose.t_ns = t_ns;
    pose.p_w_m = {place(kind, i, random), place(kind, i + 700, random), 1};
    pose.q_wb =
        from_rotation_vector<float>({0.3f * random.within_one(), 0.01f * static_cast<float>(i), 0});
    pose.flags = flag::position_valid | flag::orientation_valid;
    if (i % 211 == 13) pose.p_w_m.y = approx::sqrt(-1.0f);  // not a number: it is refused
    return pose;
}

void measure(const Reader& reader, const std::vector<Pose>& accepted, int kind) {
    std::array<std::size_t, 4> at{};
    std::uint32_t uncovered = 0;
    for (const Pose& pose : accepted) {
        if ((pose.flags & flag::position_valid) == 0) continue;
        const double e = reader.error(pose, at);
        if (e < 0) ++uncovered;
        if (!(e <= 1.0001)) ++beyond;
        if (!(e <= worst)) worst = e;
        ++samples;
    }
    if (uncovered > 0) fail("an accepted sample is not covered", kind);
}

void run(int kind) {
    static Guarded guarded{{}, Whole{params()}, {}};
    guarded = {{}, Whole{params()}, {}};
    Reader reader;
    std::vector<Pose> accepted;
    Random random{static_cast<std::uint32_t>(kind + 1)};
    const auto take = [&](const Bytes& bytes) {
        for (const std::uint8_t byte : bytes) digest = (digest ^ byte) * 1099511628211u;
        reader.read(bytes);
        if (guarded.pipeline.filtered()) accepted.push_back(*guarded.pipeline.filtered());
        return bytes.status != Status::end;
    };
    std::int64_t t_ns = 0;
    for (int i = 0; i < 1500; ++i)
        take(guarded.pipeline.push(pose_of(kind, i, t_ns += pause_ns(kind, random), random)));
    bool more = true;
    for (int i = 0; i < 4 * static_cast<int>(window) && more; ++i)
        more = take(guarded.pipeline.flush());
    if (more) fail("flush() does not come to an end", kind);
    for (int i = 0; i < 100 && reader.decoder.finish(); ++i) reader.take();
    for (std::size_t i = 0; i < guarded.before.size(); ++i)
        if ((guarded.before[i] | guarded.after[i]) != 0)
            return fail("memory outside the pipeline was written", kind);
    if (accepted.size() < 1400) fail("samples were refused", kind);
    if (reader.decoder.frame_counters().good_bytes != reader.sent)
        fail("bytes were not understood", kind);
    measure(reader, accepted, kind);
    breaks += reader.decoder.counters().breaks;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "flush-to-zero") == 0) flush_to_zero();
    for (int kind = 0; kind < kinds; ++kind) run(kind);
    std::printf("digest %016llx samples %u breaks %u beyond %u worst %.3f arithmetic %s\n",
                static_cast<unsigned long long>(digest), samples, breaks, beyond, worst,
                to_string(check_arithmetic()));
    return failures != 0;
}
