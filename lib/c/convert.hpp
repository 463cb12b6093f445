#pragma once
// The structs of fairlead.h beside those of the library. Each pair is joined once, field by field,
// and the join works in both directions; static_asserts fail where a side has a field that the
// other lacks.
#include "fairlead.h"
#include "lib/c/configuration.hpp"

namespace fairlead::c {

/// Copies a field of C to C++.
struct ToCpp {
    template <class T>
    constexpr void operator()(const T& c, T& cpp) const noexcept {
        cpp = c;
    }
    void operator()(const float (&c)[3], Vec3& cpp) const noexcept { cpp = {c[0], c[1], c[2]}; }
    void operator()(const float (&c)[4], Quat& cpp) const noexcept {
        cpp = {c[0], c[1], c[2], c[3]};
    }
    template <std::size_t D>
    void operator()(const float (&c)[D], std::array<float, D>& cpp) const noexcept {
        std::copy(c, c + D, cpp.begin());
    }
};
/// Copies a field of C++ to C.
struct ToC {
    template <class T>
    constexpr void operator()(T& c, const T& cpp) const noexcept {
        c = cpp;
    }
    template <class Real>
    void operator()(float (&c)[3], const BasicVec3<Real>& cpp) const noexcept {
        c[0] = cpp.x, c[1] = cpp.y, c[2] = cpp.z;
    }
    void operator()(float (&c)[4], const Quat& cpp) const noexcept {
        c[0] = cpp.w, c[1] = cpp.x, c[2] = cpp.y, c[3] = cpp.z;
    }
    template <std::size_t D>
    void operator()(float (&c)[D], const std::array<float, D>& cpp) const noexcept {
        std::copy(cpp.begin(), cpp.end(), c);
    }
};
/// Counts fields.
struct CountFields {
    int n{0};
    template <class... Any>
    constexpr void operator()(Any&&...) noexcept {
        ++n;
    }
};

template <class C, class Cpp, class Copy>
constexpr void join_pose(C& c, Cpp& cpp, Copy&& copy) noexcept {
    copy(c.t_ns, cpp.t_ns);
    copy(c.p_w_m, cpp.p_w_m);
    copy(c.q_wb, cpp.q_wb);
    copy(c.flags, cpp.flags);
}
template <class C, class Cpp, class Copy>
constexpr void join_sample(C& c, Cpp& cpp, Copy&& copy) noexcept {
    copy(c.t_ns, cpp.t_ns);
    copy(c.gyro_rad_s, cpp.gyro_rad_s);
    copy(c.accel_m_s2, cpp.accel_m_s2);
    copy(c.mag_uT, cpp.mag_uT);
    copy(c.flags, cpp.flags);
    copy(c.temperature_c, cpp.temperature_c);
}
template <class C, class Cpp, class Copy>
constexpr void join_vector(C& c, Cpp& cpp, Copy&& copy) noexcept {
    copy(c.t_ns, cpp.t_ns);
    copy(c.value, cpp.value);
    copy(c.flags, cpp.flags);
}
template <class C, class Cpp, class Copy>
constexpr void join_event(C& c, Cpp& cpp, Copy&& copy) noexcept {
    copy(c.t_ns, cpp.t_ns);
    copy(c.channel, cpp.channel);
    copy(c.value, cpp.value);
    copy(c.flags, cpp.flags);
}
template <class C, class Cpp, class Copy>
constexpr void join_intake(C& c, Cpp& cpp, Copy&& copy) noexcept {
    copy(c.gap_ns, cpp.gap_ns);
    copy(c.leap_ns, cpp.leap_ns);
    copy(c.stuck_records, cpp.stuck_records);
    copy(c.position_max_m, cpp.position_max_m);
    copy(c.value_max, cpp.value_max);
    copy(c.gyro_max_rad_s, cpp.gyro_max_rad_s);
    copy(c.accel_max_m_s2, cpp.accel_max_m_s2);
    copy(c.mag_max_uT, cpp.mag_max_uT);
    copy(c.unit_tolerance, cpp.unit_tolerance);
}
template <class C, class Cpp, class Copy>
constexpr void join_affine(C& c, Cpp& cpp, Copy&& copy) noexcept {
    copy(c.offset, cpp.offset);
    copy(c.matrix[0], cpp.matrix.x);
    copy(c.matrix[1], cpp.matrix.y);
    copy(c.matrix[2], cpp.matrix.z);
}
template <class C, class Cpp, class Copy>
constexpr void join_calibration(C& c, Cpp& cpp, Copy&& copy) noexcept {
    join_affine(c.gyro, cpp.gyro, copy);
    join_affine(c.accel, cpp.accel, copy);
    join_affine(c.mag, cpp.mag, copy);
    copy(c.gyro_offset_per_K, cpp.gyro_offset_per_K);
    copy(c.temperature_C, cpp.temperature_C);
    copy(c.q_bs, cpp.q_bs);
}
template <class C, class Cpp, class Copy>
constexpr void join_tolerance([[maybe_unused]] C& c, [[maybe_unused]] Cpp& cpp,
                              [[maybe_unused]] Copy&& copy) noexcept {
#if FAIRLEAD_SENDS_POSITION
    copy(c.position_m, cpp.position_m);
#endif
#if FAIRLEAD_SENDS_ORIENTATION
    copy(c.orientation_rad, cpp.orientation_rad);
#endif
#if FAIRLEAD_TAKES_VECTORS
    copy(c.value, cpp.value);
#endif
}
template <class C, class Cpp, class Copy>
constexpr void join_stream(C& c, Cpp& cpp, Copy&& copy) noexcept {
    copy(c.sample_period_ns, cpp.sample_period_ns);
    copy(c.delay_records, cpp.delay_records);
    copy(c.restart_interval_ns, cpp.restart_interval_ns);
    copy(c.header_interval_ns, cpp.header_interval_ns);
    copy(c.event_delay_records, cpp.event_delay_records);
}
template <class C, class Cpp, class Copy>
constexpr void join_params(C& c, Cpp& cpp, Copy&& copy) noexcept {
    join_stream(c, cpp, copy);
    copy(c.stream_id, cpp.stream_id);  // any value is good: it is not among the checked fields
    join_tolerance(c.tolerance, cpp.tolerance, copy);
    join_intake(c.intake, cpp.intake, copy);
#if FAIRLEAD_TAKES_SAMPLES
    join_calibration(c.calibration, cpp.calibration, copy);
#endif
}

inline Pose to_cpp(const fairlead_pose& c) noexcept {
    Pose out;
    join_pose(c, out, ToCpp{});
    return out;
}
inline Sample to_cpp(const fairlead_sample& c) noexcept {
    Sample out;
    join_sample(c, out, ToCpp{});
    return out;
}
inline Event to_cpp(const fairlead_event& c) noexcept {
    Event out;
    join_event(c, out, ToCpp{});
    return out;
}
inline void to_c(fairlead_pose& c, const Pose& cpp) noexcept { join_pose(c, cpp, ToC{}); }
inline void to_c(fairlead_event& c, const Event& cpp) noexcept { join_event(c, cpp, ToC{}); }
#if FAIRLEAD_TAKES_VECTORS
inline VectorSample<Kind::components> to_cpp(const fairlead_vector& c) noexcept {
    VectorSample<Kind::components> out;
    join_vector(c, out, ToCpp{});
    return out;
}
inline void to_c(fairlead_vector& c, const VectorSample<Kind::components>& cpp) noexcept {
    join_vector(c, cpp, ToC{});
}
#endif

inline fairlead_fault_counts faults_of(const FaultCounts& counts) noexcept {
    return {counts[Fault::repeated_time], counts[Fault::backward_time], counts[Fault::leap],
            counts[Fault::too_close],     counts[Fault::gap],           counts[Fault::new_run],
            counts[Fault::not_finite],    counts[Fault::out_of_range],  counts[Fault::not_unit],
            counts[Fault::stuck]};
}
static_assert(sizeof(fairlead_fault_counts) == fault_kinds * sizeof(std::uint64_t));

namespace detail {

/// Fields that the library's own table of a parameter struct has (P::each).
template <class P>
constexpr int checked_fields() noexcept {
    CountFields count;
    P params{};
    P::each(params, count);
    return count.n;
}
constexpr int joined_intake() noexcept {
    fairlead_intake_params c{};
    IntakeParams cpp{};
    CountFields count;
    join_intake(c, cpp, count);
    return count.n;
}
static_assert(joined_intake() == checked_fields<IntakeParams>(),
              "IntakeParams has fields that join_intake() and fairlead.h lack");
constexpr int joined_stream() noexcept {
    fairlead_pipeline_params c{};
    BoardPipeline::Stream cpp{};
    CountFields count;
    join_stream(c, cpp, count);
    const int tolerances =
        (sends_position ? 3 : 0) + (sends_orientation ? 1 : 0) + static_cast<int>(Kind::components);
    return count.n + tolerances;
}
static_assert(joined_stream() == checked_fields<BoardPipeline::Stream>(),
              "StreamParams has fields that join_params() and fairlead.h lack");
static_assert(sizeof(fairlead_pose) == sizeof(Pose) && sizeof(fairlead_sample) == sizeof(Sample) &&
                  sizeof(fairlead_event) == sizeof(Event) &&
                  sizeof(fairlead_calibration) == sizeof(Calibration),
              "a record or the calibration has a field that fairlead.h lacks");
#if FAIRLEAD_TAKES_VECTORS
static_assert(sizeof(fairlead_vector) == sizeof(VectorSample<Kind::components>));
#endif

}  // namespace detail
}  // namespace fairlead::c
