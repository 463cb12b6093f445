// The intake for each kind of record, with any parameters that its check lets through, any limits
// and any records. Held: what comes out is in order, in range and finite; each record is given once
// or counted; none waits longer than one push.
#include "fairlead/sense/intake.hpp"

#include "tests/fuzz/input.hpp"

namespace {

using namespace fairlead;
using fuzz::Input;

Pose record(Input& in, const Pose*) {
    Pose pose;
    const std::uint8_t kind = in.byte();
    pose.flags =
        kind < 200 ? flag::position_valid | flag::orientation_valid : in.raw<std::uint32_t>();
    if (kind & 1) pose.p_w_m = in.vector(2e4f);
    if (kind & 2) pose.q_wb = {in.number(1), in.number(1), in.number(1), in.number(1)};
    return pose;
}
Sample record(Input& in, const Sample*) { return fuzz::sample(in); }
VectorSample<4> record(Input& in, const VectorSample<4>*) {
    VectorSample<4> sample;
    sample.flags = in.byte() < 200 ? +flag::vector_valid : in.raw<std::uint32_t>();
    for (float& v : sample.value) v = in.number(10);
    return sample;
}

bool inside(float v, float max) { return v >= -max && v <= max; }
bool inside(const Vec3& v, float max) {
    return inside(v.x, max) && inside(v.y, max) && inside(v.z, max);
}
void expect_good(const Pose& pose, const IntakeParams& p) {
    FUZZ_EXPECT(inside(pose.p_w_m, p.position_max_m));
    const float n = dot(pose.q_wb, pose.q_wb);
    FUZZ_EXPECT(n > 0.9999f && n < 1.0001f);
}
void expect_good(const Sample& s, const IntakeParams& p) {
    FUZZ_EXPECT(inside(s.gyro_rad_s, p.gyro_max_rad_s));
    FUZZ_EXPECT(inside(s.accel_m_s2, p.accel_max_m_s2));
    FUZZ_EXPECT(inside(s.mag_uT, p.mag_max_uT));
}
void expect_good(const VectorSample<4>& s, const IntakeParams& p) {
    for (const float v : s.value) FUZZ_EXPECT(inside(v, p.value_max));
}

template <class Record>
void run(Input& in) {
    IntakeParams params;
    IntakeLimits limits;
    if (in.flag()) {
        params.gap_ns = in.raw<std::int64_t>();
        params.leap_ns = in.raw<std::int64_t>();
        params.stuck_records = in.byte();
        params.position_max_m = in.number(1e5f);
        params.gyro_max_rad_s = in.number(100);
        params.unit_tolerance = in.number(0.5f);
        limits.spacing_min_ns = 1 + in.raw<std::uint32_t>() / 4;
        limits.gap_ns_max = in.raw<std::uint32_t>();
        limits.run_ns_max = 1 + in.raw<std::uint32_t>();
        limits.first_waits = in.flag();
    }
    const bool good = static_cast<bool>(check(params, limits));
    Intake<Record> intake{params, limits};
    const IntakeParams used = within(completed(params, limits), limits);
    std::uint64_t pushed = 0, given = 0;
    std::int64_t last = 0, base = 0;
    const auto refused = [&intake] {
        const FaultCounts& f = intake.faults();
        return f[Fault::repeated_time] + f[Fault::backward_time] + f[Fault::leap] +
               f[Fault::too_close];
    };
    const auto take = [&](const std::optional<Record>& out) {
        if (!out) return;
        expect_good(*out, used);
        const bool run = given == 0 || (out->flags & flag::new_run) != 0;
        if (run) {
            base = out->t_ns;
        } else {
            FUZZ_EXPECT(out->t_ns > last);
            FUZZ_EXPECT(out->t_ns - last >= limits.spacing_min_ns);
            FUZZ_EXPECT(out->t_ns - base <= limits.run_ns_max);
            FUZZ_EXPECT((out->flags & flag::gap_before) || out->t_ns - last <= used.gap_ns);
        }
        last = out->t_ns;
        ++given;
    };
    std::int64_t t = in.flag() ? in.raw<std::int64_t>() : 0;
    while (!in.empty()) {
        Record next = record(in, static_cast<const Record*>(nullptr));
        next.t_ns = t;
        t = in.time_after(t, 8'000'000);
        take(intake.push(next));
        ++pushed;
        if (!good) {
            FUZZ_EXPECT(given == 0 && intake.refused());
            continue;
        }
        FUZZ_EXPECT(pushed == given + refused() + (intake.waiting() ? 1 : 0));
        if (t % 16 == 7) take(intake.idle());
    }
    take(intake.flush());
    FUZZ_EXPECT(!intake.flush() && !intake.waiting());
    FUZZ_EXPECT(!good || pushed == given + refused());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input in{data, size};
    switch (in.byte() % 3) {
        case 0: run<Pose>(in); break;
        case 1: run<Sample>(in); break;
        default: run<VectorSample<4>>(in); break;
    }
    return 0;
}
