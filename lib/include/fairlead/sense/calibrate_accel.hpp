#pragma once
// Six-face calibration of an accelerometer: the board lies still on each of its faces in turn, in
// any order; twelve unknowns (offset, scale and misalignment) from eighteen means. Mean readings
// are a = A g + offset: opposite faces cancel the offset, their differences are the columns of A.
// Cost: one pass; a 3 x 3 inverse in result().
#include <array>

#include "fairlead/base/status.hpp"
#include "fairlead/sense/calibrate.hpp"
#include "fairlead/sense/calibrate_fit.hpp"

namespace fairlead {

struct AccelCalibration {
    Affine correction{};
    float residual_m_s2{};    // quality: RMS of |corrected| - g over the faces
    float opposition_m_s2{};  // how well the three pairs of faces agree on the offset
};

class AccelFit {
  public:
    static constexpr std::uint32_t samples_min = 50;  // of each face
    static constexpr float moved_m_s2 = 0.3f;         // a larger deviation on a face is motion
    static constexpr float opposition_max = 0.5f;     // m/s^2: beyond it a face was not straight
    static constexpr float determinant_error_max = 0.3f;

    explicit AccelFit(float g_m_s2 = 9.80665f) noexcept : g_{g_m_s2} {}

    /// False: the reading belongs to no face, for it leans more than 25 degrees or is no gravity.
    bool push(const Vec3& accel_m_s2) noexcept {
        const int face = face_of(accel_m_s2);
        if (face < 0) return false;
        faces_[static_cast<std::size_t>(face)].push(accel_m_s2);
        return true;
    }
    /// Bit i is set where face i is complete: +x, -x, +y, -y, +z, -z up.
    std::uint32_t faces_done() const noexcept {
        std::uint32_t done = 0;
        for (std::size_t i = 0; i < 6; ++i)
            if (faces_[i].count() >= samples_min) done |= 1u << i;
        return done;
    }

    Result<AccelCalibration> result() const noexcept {
        if (faces_done() != 0x3Fu) return Status::not_enough_data;
        for (const Moments& face : faces_)
            if (!(face.deviation() <= moved_m_s2)) return Status::bad_data;
        std::array<Vec3, 3> middle{}, column{};
        Vec3 offset{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 plus = faces_[2 * k].mean(), minus = faces_[2 * k + 1].mean();
            middle[k] = 0.5f * (plus + minus);
            column[k] = (0.5f / g_) * (plus - minus);
            offset += (1.0f / 3) * middle[k];
        }
        const Mat3 a{{column[0].x, column[1].x, column[2].x},
                     {column[0].y, column[1].y, column[2].y},
                     {column[0].z, column[1].z, column[2].z}};
        AccelCalibration out;
        for (const Vec3& m : middle) {
            const float off = norm(m - offset);
            if (off > out.opposition_m_s2) out.opposition_m_s2 = off;
        }
        if (!(approx::absolute(determinant(a) - 1) <= determinant_error_max) ||
            !(out.opposition_m_s2 <= opposition_max))
            return Status::bad_data;
        out.correction.offset = offset;
        out.correction.matrix = inverse(a);
        float sum = 0;
        for (const Moments& face : faces_) {
            const float off = norm(out.correction(face.mean())) - g_;
            sum += off * off;
        }
        out.residual_m_s2 = approx::sqrt(sum / 6);
        return out;
    }

  private:
    int face_of(const Vec3& a) const noexcept {
        constexpr float upright = 0.906f;  // cosine of 25 degrees
        const float n = norm(a);
        if (!(n > 0.7f * g_ && n < 1.3f * g_)) return -1;
        for (int k = 0; k < 3; ++k) {
            const float c = component(a, static_cast<std::size_t>(k));
            if (approx::absolute(c) > upright * n) return 2 * k + (c > 0 ? 0 : 1);
        }
        return -1;
    }

    float g_;
    std::array<Moments, 6> faces_{};
};

}  // namespace fairlead
