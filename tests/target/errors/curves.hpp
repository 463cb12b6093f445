#pragma once
// What reduces: the largest distance of the decoded curve from a record that went in, which the
// tolerance bounds.
#include "examples/firmware/config.hpp"
#include "host_sim/curve_store.hpp"
#include "tests/target/errors/streams.hpp"

namespace fairlead::target {

struct Reduced {
    float tol_m[3], tol_rad;
    Largest error;
    bool kept{true};  // every record is covered, within the tolerance

    std::string text() const { return error.text() + (kept ? "" : " (NOT KEPT)"); }
};

/// What a stage that gives bytes makes of the streams. seen(stage): the record that the guarantee
/// speaks of after a push.
template <class Stage, class Make, class Seen>
Reduced reduced(const std::vector<Records>& streams, const EncoderParams& params, const Make& make,
                const Seen& seen) {
    Reduced all{{params.tol_position_m[0], params.tol_position_m[1], params.tol_position_m[2]},
                params.tol_orientation_rad,
                {}};
    for (const Records& records : streams) {
        Stage stage = make();
        sim::CurveStore store;
        std::vector<Pose> in;
        const auto take = [&store](const Bytes& bytes) {
            store.push({reinterpret_cast<const char*>(bytes.data), bytes.size});
        };
        for (const Record& record : records) {
            take(stage.push(record.pose));
            if (const auto pose = seen(stage, record.pose)) in.push_back(*pose);
        }
        for (Bytes bytes = stage.flush(); !bytes.empty(); bytes = stage.flush()) take(bytes);
        store.finish();
        for (const Pose& pose : in) {
            const Pose out = store.at(pose.t_ns);
            if (params.position) {
                const Vec3 e = out.p_w_m - pose.p_w_m;
                all.kept = all.kept && (out.flags & flag::position_valid) != 0 &&
                           approx::absolute(e.x) <= all.tol_m[0] &&
                           approx::absolute(e.y) <= all.tol_m[1] &&
                           approx::absolute(e.z) <= all.tol_m[2];
                for (const float x : {e.x, e.y, e.z}) all.error.position({x, 0, 0}, {});
            }
            if (params.orientation) {
                const float angle = rotation_angle(out.q_wb, pose.q_wb);
                all.kept = all.kept && (out.flags & flag::orientation_valid) != 0 &&
                           angle <= all.tol_rad * 1.0001f;  // the measuring angle rounds, too
                all.error.orientation(out.q_wb, ref::unit(ref::of(pose.q_wb)));
            }
        }
    }
    return all;
}

template <std::size_t N>
Reduced encoder_error(const std::vector<Records>& streams, bool position, bool orientation) {
    EncoderParams params = Config::params().encoder;
    params.position = position;
    params.orientation = orientation;
    params.delay_max = N;
    const auto make = [&params] { return Encoder<N>{params}; };
    const auto every = [](const Encoder<N>&, const Pose& pose) { return std::optional{pose}; };
    return reduced<Encoder<N>>(streams, params, make, every);
}

inline Reduced pipeline_error(const std::vector<Records>& streams) {
    using Whole = Pipeline<Config>;
    const auto make = [] { return Whole{Config::params()}; };
    const auto filtered = [](const Whole& whole, const Pose&) { return whole.filtered(); };
    return reduced<Whole>(streams, Config::params().encoder, make, filtered);
}

}  // namespace fairlead::target
