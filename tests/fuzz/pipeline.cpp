// Whole pipelines with the encoder's and the reader's own types: any parameters that the check lets
// through, any records, events, idle calls, flushes. Held, from the bytes and in double: each
// accepted record is covered in time and within tolerance, and the reader understands the stream.
#include "tests/pipeline/pipeline_check.hpp"

#include "tests/fuzz/input.hpp"

namespace {

using namespace fairlead;
using fuzz::Input;

template <class In, class Chosen, std::size_t Delay, class AFilter = NoFilter>
struct BoardOf {
    using Input = In;
    using Channels = Chosen;
    using Filter = AFilter;
    static constexpr std::size_t delay_records_max = Delay;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = 2;
};

template <class In, class Chosen, std::size_t Delay>
struct CubicBoardOf : BoardOf<In, Chosen, Delay> {
    using Kind = curve::Cubics;
};

template <class Params>
void draw(Params& params, Input& in, std::size_t delay_max) {
    constexpr std::int64_t usual[] = {0, 125'000, 1'000'000, 8'333'333, 40'000'000, 1'000'000'000};
    const std::size_t choice = in.below(8);
    params.sample_period_ns =
        choice < 6 ? usual[choice]
                   : 125'000 + static_cast<std::int64_t>(in.raw<std::uint32_t>() % 999'875'000u);
    params.delay_records = static_cast<std::uint32_t>(16 + in.below(delay_max - 15));
    constexpr std::int64_t restarts[] = {0, never_ns, 2'000'000'000, 50'000'000};
    params.restart_interval_ns = restarts[in.below(4)];
    if (in.flag()) params.header_interval_ns = 1'000'000'000;
    if (in.flag()) params.intake.gap_ns = std::int64_t{1'000'000} << in.below(12);
    params.event_delay_records = in.byte() % 8u;
}

Pose record(Input& in, float tol_m, float tol_rad, const Pose& before) {
    Pose pose = before;
    const std::uint8_t kind = in.byte();
    if (kind & 1) pose.p_w_m = pose.p_w_m + in.vector(3 * tol_m);
    if (kind & 2) pose.q_wb = pose.q_wb * from_rotation_vector(in.vector(3 * tol_rad));
    if (kind & 4) pose.p_w_m = in.vector(1000 * tol_m);
    if ((kind & 8) && (kind & 16)) pose.q_wb = from_rotation_vector(in.vector(6));
    pose.flags = flag::position_valid | flag::orientation_valid;
    if (kind >= 224) pose.flags = in.byte();
    return pose;
}

VectorSample<2> record(Input& in, float tol, float, const VectorSample<2>& before) {
    VectorSample<2> sample = before;
    const std::uint8_t kind = in.byte();
    if (kind & 1) sample.value[0] += in.number(3 * tol);
    if (kind & 2) sample.value[1] += in.number(3 * tol);
    if (kind & 4) sample.value = {in.number(1000 * tol), in.number(1000 * tol)};
    sample.flags = kind < 224 ? +flag::vector_valid : in.byte();
    return sample;
}
Sample record(Input& in, float, float, const Sample&) { return fuzz::sample(in); }

void drift(Pose& pose, float step) { pose.p_w_m.x += step; }
void drift(VectorSample<2>& sample, float step) { sample.value[0] += step; }
void drift(Sample& sample, float step) { sample.gyro_rad_s.z += step; }

template <class Board>
void run(Input& in) {
    using Check = test::PipelineCheck<Board>;
    typename Check::Params params;
    draw(params, in, Board::delay_records_max);
    float metres = 0.001f, radians = 0.0043633f;
    if constexpr (Board::Channels::template has<Position>) {
        if (in.flag()) params.tolerance.position_m = metres = in.number(0.1f);
    }
    if constexpr (Board::Channels::template has<Orientation>) {
        if (in.flag()) params.tolerance.orientation_rad = radians = in.number(0.5f);
    }
    if constexpr (Board::Channels::template has<Vector<2>>) {
        if (in.flag()) params.tolerance.value = metres = in.number(10);
    }
    if (!Check::Chain::check(params)) return;
    Check check{params};
    const std::int64_t period = params.sample_period_ns ? params.sample_period_ns : 8'333'333;
    std::int64_t t = in.flag() ? in.raw<std::int64_t>() : 1'700'000'000'000'000'000;
    typename detail::InputTraits<typename Board::Input>::Raw next{};
    while (!in.empty()) {
        next = record(in, metres, radians, next);
        const std::uint8_t step = in.byte();
        // a record once drawn may go on for a while, at rest or drifting
        for (std::size_t n = step >= 192 ? 1 + in.below(80) : 1; n > 0; --n) {
            next.t_ns = t;
            check.push(next);
            t = in.time_after(t, period);
            if (step & 1) drift(next, metres / 4);
        }
        if (step % 61 == 1) check.idle();
        if (step % 61 == 2) check.flush();
        if (step % 61 == 3) check.push_event({t, in.byte(), in.raw<std::uint16_t>(), 0});
    }
    check.finish();
    if (!check.verdict().good()) std::fprintf(stderr, "%s\n", check.verdict().first.c_str());
    FUZZ_EXPECT(check.verdict().good());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size > 1000) return 0;
    Input in{data, size};
    using Both = Channels<Position, Orientation>;
    switch (in.byte() % 7) {
        case 0: run<BoardOf<Pose, Both, 48>>(in); break;
        case 1: run<BoardOf<Pose, Channels<Position>, 24, PoseFilter<3>>>(in); break;
        case 2: run<BoardOf<VectorSample<2>, Channels<Vector<2>>, 16>>(in); break;
        case 3: run<BoardOf<Imu<AttitudeMode::imu>, Channels<Orientation>, 20>>(in); break;
        case 4: run<BoardOf<Pose, Channels<Orientation>, 64>>(in); break;
        case 5: run<CubicBoardOf<Pose, Both, 24>>(in); break;
        default: run<CubicBoardOf<VectorSample<2>, Channels<Vector<2>>, 48>>(in); break;
    }
    return 0;
}
