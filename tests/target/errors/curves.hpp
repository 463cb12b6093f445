#pragma once
// What reduces: the largest distance of the decoded curve, evaluated in double, from a record that
// went in, which the tolerance bounds.
#include <memory>

#include "examples/firmware/config.hpp"
#include "fairlead/wire/live.hpp"
#include "tests/target/encoder_stage.hpp"
#include "tests/target/errors/streams.hpp"

namespace fairlead::target {

struct Reduced {
    Largest error;
    bool kept{true};  // every record is covered, within the tolerance

    std::string text() const { return error.text() + (kept ? "" : " (NOT KEPT)"); }
};

/// All curves of a stream.
class Curves {
  public:
    void push(const Bytes& bytes) {
        for (const std::uint8_t byte : bytes)
            if (decoder_.push(byte)) take();
    }
    void finish() {
        while (decoder_.finish()) take();
    }
    /// The piece of an axis, or of the rotation, that holds at t_ns; null: none.
    const wire::CurvePiece* at(bool rotates, std::size_t axis, std::int64_t t_ns) const {
        for (const auto& p : pieces_)
            if (p.rotates == rotates && p.axis == axis && wire::holds_at(p, decoder_.grid(), t_ns))
                return &p;
        return nullptr;
    }
    const curve::Grid& grid() const { return decoder_.grid(); }

  private:
    void take() {
        for (wire::CurvePiece piece; decoder_.next(piece);)
            if (piece.end > piece.start || piece.begins) pieces_.push_back(piece);
    }
    wire::Decoder<3, 1> decoder_{};
    std::vector<wire::CurvePiece> pieces_{};
};

/// How far the curves are from what the guarantee speaks of: within tol_m an axis, and tol_rad.
inline void compare(const Curves& curves, const Pose& pose, bool position, bool orientation,
                    double tol_m, double tol_rad, Reduced& all) {
    const std::array<float, 3> p{pose.p_w_m.x, pose.p_w_m.y, pose.p_w_m.z};
    for (std::size_t a = 0; position && a < 3; ++a) {
        const auto* piece = curves.at(false, a, pose.t_ns);
        if (piece == nullptr) {
            all.kept = false;
            continue;
        }
        const double told = wire::axis_motion<double>(*piece, curves.grid(), pose.t_ns).value;
        const double e = told - static_cast<double>(p[a]);
        all.kept = all.kept && std::abs(e) <= tol_m;
        all.error.position({static_cast<float>(e), 0, 0}, {});
    }
    if (!orientation) return;
    const auto* piece = curves.at(true, 0, pose.t_ns);
    if (piece == nullptr) {
        all.kept = false;
        return;
    }
    const auto q = wire::orientation_motion<double>(*piece, curves.grid(), pose.t_ns).q_wb;
    const double angle = ref::angle(ref::unit({q.w, q.x, q.y, q.z}), ref::unit(ref::of(pose.q_wb)));
    all.kept = all.kept && angle <= tol_rad * 1.0001;  // the measuring angle rounds, too
    all.error.angle(angle);
}

/// What an encoder makes of the streams.
template <class Stage>
Reduced encoder_error(const std::vector<Records>& streams) {
    using Chosen = typename Stage::Board::Channels;
    const auto stream = Stage::stream();
    Reduced all;
    for (const Records& records : streams) {
        const auto stage = std::make_unique<Stage>();
        Curves curves;
        std::vector<Pose> in;
        for (const Record& record : records) {
            stage->prepare(record);
            if (stage->accepted) in.push_back(*stage->accepted);
            if (const auto bytes = stage->push(record)) curves.push(*bytes);
        }
        while (const auto bytes = stage->flush()) curves.push(*bytes);
        curves.finish();
        double tol_m = 0, tol_rad = 0;
        if constexpr (Chosen::template has<Position>)
            tol_m = static_cast<double>(stream.tolerance.position_m[0]);
        if constexpr (Chosen::template has<Orientation>)
            tol_rad = static_cast<double>(stream.tolerance.orientation_rad);
        for (const Pose& pose : in)
            compare(curves, pose, tol_m > 0, tol_rad > 0, tol_m, tol_rad, all);
    }
    return all;
}

/// What the firmware's pipeline makes of them: against the filtered records.
inline Reduced pipeline_error(const std::vector<Records>& streams) {
    const auto params = Config::params();
    Reduced all;
    for (const Records& records : streams) {
        const auto whole = std::make_unique<Config::Pipeline>(params);
        Curves curves;
        std::vector<Pose> in;
        const auto note = [&](const Bytes& bytes) {
            curves.push(bytes);
            if (whole->filtered()) in.push_back(*whole->filtered());
            return bytes.status == Status::end;
        };
        for (const Record& record : records) note(whole->push(record.pose));
        while (!note(whole->flush())) continue;
        curves.finish();
        for (const Pose& pose : in)
            compare(curves, pose, true, true, static_cast<double>(params.tolerance.position_m[0]),
                    static_cast<double>(params.tolerance.orientation_rad), all);
    }
    return all;
}

}  // namespace fairlead::target
