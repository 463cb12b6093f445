// Runs hostile but accepted motion through the pipeline, reads the stream back, and prints what
// came of it: one line of counts and a digest of the bytes. flags.py builds it with many flags.
// Nothing here may crash, hang or write outside its memory, whatever the flags do to the
// arithmetic; with flags that keep IEEE 754, nothing may leave the tolerance either.
#include <array>
#include <cstdio>
#include <cstring>

#include "fairlead/base/arithmetic.hpp"
#include "fairlead/pipeline.hpp"
#include "fairlead/reduce/evaluate.hpp"
#include "fairlead/wire/decoder.hpp"

using namespace fairlead;

namespace {

constexpr std::size_t window = 24;
constexpr float tol_m = 0.001f;
struct Config : PipelineConfig {
    static constexpr std::size_t window = ::window;
    static constexpr Credit slice = slice_small;
};

/// A pipeline between guard words: an overrun of its memory changes them.
struct Guarded {
    std::array<std::uint64_t, 64> before{};
    Pipeline<Config> pipeline;
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

/// Reads the stream as a reader would, and measures how far the curve passes from each sample.
struct Reader {
    Decoder decoder{};
    std::array<Pose, 4 * window> open{};
    std::size_t count{0};
    std::uint32_t covered{0}, beyond{0};
    float worst{0};

    void note(const Pose& pose) {
        if (count < open.size()) open[count++] = pose;
    }
    void measure(const Curve<VectorChannel<3>>& curve, std::int64_t until_ns) {
        std::size_t n = 0;
        for (; n < count && open[n].t_ns < until_ns; ++n) {
            const auto p =
                value_at(curve, decoder.position().scale, decoder.tick_ns(), open[n].t_ns);
            const std::array<float, 3> v{open[n].p_w_m.x, open[n].p_w_m.y, open[n].p_w_m.z};
            bool fits = true;
            for (std::size_t d = 0; d < 3; ++d) {
                const float e = approx::absolute(p[d] - v[d]) / tol_m;
                // beyond 4 km a millimetre is no longer within a float's coefficients
                if (!(e <= worst) && approx::absolute(v[d]) < 4000) worst = e;
                fits = fits && e <= 1.001f;
            }
            ++covered;
            if (!fits) ++beyond;
        }
        for (std::size_t i = n; i < count; ++i) open[i - n] = open[i];
        count -= n;
    }
    void read(const Bytes& bytes) {
        for (std::size_t i = 0; i < bytes.size; ++i) {
            if (!decoder.push(bytes.data[i])) continue;
            auto before = decoder.position();
            Decoder::Update update;
            for (std::size_t k = 0; k < 256 && decoder.next(update); ++k) {
                if (update.channel == Decoder::Channel::position && update.piece)
                    measure(before.curve, decoder.position().curve.span.t0_ns);
                before = decoder.position();
            }
            const auto& now = decoder.position();
            measure(now.curve,
                    now.curve.span.t0_ns + std::int64_t{now.cover_ticks} * decoder.tick_ns());
        }
    }
};

std::uint64_t digest = 14695981039346656037u;  // FNV-1a
std::uint32_t samples = 0, breaks = 0, covered = 0, beyond = 0, unserved = 0, failures = 0;
float worst = 0;

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

void run(int kind) {
    EncoderParams encoder;
    encoder.tol_position_m = {tol_m, tol_m, tol_m};
    encoder.delay_max = window;
    static Guarded guarded{{}, Pipeline<Config>{{{}, {}, encoder}}, {}};
    static Reader reader;
    guarded = {{}, Pipeline<Config>{{{}, {}, encoder}}, {}};
    reader = {};
    Random random{static_cast<std::uint32_t>(kind + 1)};
    auto take = [&](const Bytes& bytes) {
        for (std::size_t i = 0; i < bytes.size; ++i)
            digest = (digest ^ bytes.data[i]) * 1099511628211u;
        reader.read(bytes);
        return !bytes.empty();
    };
    std::int64_t t_ns = 0;
    std::uint32_t accepted = 0;
    for (int i = 0; i < 1500; ++i) {
        Pose pose;
        pose.t_ns = t_ns += pause_ns(kind, random);
        pose.p_w_m = {place(kind, i, random), place(kind, i + 700, random), 1};
        pose.q_wb = from_rotation_vector<float>(
            {0.3f * random.within_one(), 0.01f * static_cast<float>(i), 0});
        pose.flags = flag::position_valid | flag::orientation_valid;
        if (i % 211 == 13)
            pose.p_w_m.y = approx::sqrt(-1.0f);  // not a number: the intake refuses it
        const Bytes bytes = guarded.pipeline.push(pose);
        const auto& kept = guarded.pipeline.filtered();
        if (kept && (kept->flags & flag::position_valid) != 0) {
            reader.note(*kept);
            ++accepted;
        }
        take(bytes);
    }
    bool more = true;
    for (int i = 0; i < 4 * static_cast<int>(window) && more; ++i)
        more = take(guarded.pipeline.flush());
    if (more) fail("flush() does not come to an end", kind);
    for (std::size_t i = 0; i < guarded.before.size(); ++i)
        if ((guarded.before[i] | guarded.after[i]) != 0)
            return fail("memory outside the pipeline was written", kind);
    const auto& counters = guarded.pipeline.encoder().position().counters();
    if (counters.samples != accepted) fail("an accepted sample is missing", kind);
    if (reader.covered != accepted) fail("an accepted sample is not covered", kind);
    samples += counters.samples;
    breaks += counters.breaks;
    unserved += counters.unserved;
    covered += reader.covered;
    beyond += reader.beyond;
    if (!(reader.worst <= worst)) worst = reader.worst;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "flush-to-zero") == 0) flush_to_zero();
    for (int kind = 0; kind < kinds; ++kind) run(kind);
    std::printf(
        "digest %016llx samples %u breaks %u beyond %u unserved %u worst %.3f arithmetic %s\n",
        static_cast<unsigned long long>(digest), samples, breaks, beyond, unserved,
        static_cast<double>(worst), to_string(check_arithmetic()));
    return failures != 0;
}
