#pragma once
// Filters: against the same in double, written otherwise where the tests have such a reference.
// Strain: against the exact solve of the whole sequence. Fairing: the way from the record, bounded.
#include "fairlead/smooth/adaptive.hpp"
#include "fairlead/smooth/cascade.hpp"
#include "fairlead/smooth/fairing_window.hpp"
#include "fairlead/smooth/filter.hpp"
#include "fairlead/smooth/predict.hpp"
#include "fairlead/smooth/strain.hpp"
#include "tests/ref/mask.hpp"
#include "tests/ref/strain.hpp"
#include "tests/target/errors/arithmetic.hpp"
#include "tests/target/pose_stage.hpp"

namespace cascade_stage {
#include "tests/target/subjects/cascade_5x4.hpp"
}
namespace fairing_2_stage {
#include "tests/target/subjects/fairing_2x4.hpp"
}
namespace fairing_3_stage {
#include "tests/target/subjects/fairing_3x4.hpp"
}
namespace filter_stage {
#include "tests/target/subjects/filter_9.hpp"
}
namespace filter_causal_stage {
#include "tests/target/subjects/filter_causal_9.hpp"
}
namespace predict_stage {
#include "tests/target/subjects/predict.hpp"
}
namespace strain_stage {
#include "tests/target/subjects/strain_16.hpp"
}

namespace fairlead::target {

template <class Mask>
ref::Taps taps_of(const Mask& mask) {
    ref::Taps taps;
    for (std::size_t i = 0; i < mask.size(); ++i) taps.push_back(double{mask.tap(i)});
    return taps;
}

template <class Subject>
Largest against(const std::vector<Records>& streams, const ref::Taps& taps, long centre,
                int passes = 1) {
    Largest error;
    for (const Records& records : streams) {
        auto p = positions_of(records);
        auto q = orientations_of(records);
        for (int i = 0; i < passes; ++i) {
            p = ref::masked_stream(p, taps, centre);
            q = ref::masked_stream(q, taps, centre);
        }
        const auto out = all_of(Subject{}, records);
        for (std::size_t i = 0; i < out.size(); ++i) error.pose(out[i], p[i], q[i]);
    }
    return error;
}

/// The adaptive filter's line, in double.
template <template <class> class Space>
using ExactLine = detail::FadingLine<Space<double>>;

struct AdaptiveErrors {
    Largest filter, predicted;
};
inline AdaptiveErrors adaptive_errors(const std::vector<Records>& streams) {
    AdaptiveErrors errors;
    for (const Records& records : streams) {
        constexpr AdaptiveParams turning, moving{2, 4};
        AdaptivePoseFilter filter{turning, moving};
        ExactLine<detail::OrientationSpace> q;
        ExactLine<detail::PositionSpace> p;
        for (const Record& record : records) {
            const Pose& in = record.pose;
            const auto position = p.push(in.t_ns, widened(in.p_w_m), moving);
            const auto orientation = q.push(in.t_ns, widened(in.q_wb), turning);
            errors.filter.pose(*filter.push(in), of(position), of(orientation));
            const std::int64_t then_ns = in.t_ns + 20'000'000;
            errors.predicted.pose(filter.predict(then_ns), of(p.at(then_ns)), of(q.at(then_ns)));
        }
    }
    return errors;
}

template <class Subject>
Largest fairing_error(const std::vector<Records>& streams) {
    Largest way;
    for (const Records& records : streams) {
        const auto p = positions_of(records);
        const auto q = orientations_of(records);
        const auto out = all_of(Subject{}, records);
        for (std::size_t i = 0; i < out.size(); ++i) way.pose(out[i], p[i], q[i]);
    }
    return way;
}

inline Largest strain_error(const std::vector<Records>& streams) {
    Largest error;
    for (const Records& records : streams) {
        std::vector<Pose> motion;
        for (const Record& record : records) motion.push_back(record.pose);
        const auto p = test::strain_positions(motion, 24, 1.0 / 120);
        const auto q = test::StrainOrientations{motion, 24, 1.0 / 120}.solve();
        const auto out = all_of(strain_stage::Subject{}, records);
        for (std::size_t i = 0; i < out.size(); ++i)
            error.pose(out[i], {p[i].x(), p[i].y(), p[i].z()},
                       {q[i].w(), q[i].x(), q[i].y(), q[i].z()});
    }
    return error;
}

}  // namespace fairlead::target
