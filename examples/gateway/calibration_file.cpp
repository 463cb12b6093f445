#include "examples/gateway/calibration_file.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <sstream>

#include "examples/gateway/config_section.hpp"
#include "examples/gateway/text_file.hpp"

namespace fairlead::gateway {
namespace {

constexpr double entry_max = 100;  // of a matrix; a sensor's are near 0 and 1
constexpr float determinant_min = 1e-3f;

float determinant(const Mat3& m) noexcept {
    return dot(m * Vec3{1, 0, 0}, cross(m * Vec3{0, 1, 0}, m * Vec3{0, 0, 1}));
}

void read_affine(Section& section, const char* offset, const char* matrix, double offset_max,
                 Affine& out) {
    std::array<float, 3> o{out.offset.x, out.offset.y, out.offset.z};
    section.numbers(offset, o, offset_max);
    out.offset = {o[0], o[1], o[2]};
    std::array<float, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};
    section.numbers(matrix, m, entry_max);
    out.matrix = Mat3{{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}};
    if (std::fabs(determinant(out.matrix)) < determinant_min)
        section.fail(section.source(), matrix, "has no inverse: it would lose an axis");
}

Calibration from_toml(const std::string& text, const std::string& path, Errors& errors) {
    Calibration c;
    parse_toml(text, path, errors, [&](const toml::table& root) {
        Section section{root, "", path, errors};
        double temperature_C = 25;
        section.real("temperature_C", temperature_C, -100, 200);
        c.temperature_C = static_cast<float>(temperature_C);
        read_affine(section, "gyro_offset_rad_s", "gyro_matrix", 10, c.gyro);
        read_affine(section, "accel_offset_m_s2", "accel_matrix", 100, c.accel);
        read_affine(section, "mag_offset_uT", "mag_matrix", 10000, c.mag);
        std::array<float, 3> slope{};
        section.numbers("gyro_offset_per_K", slope, 1);
        c.gyro_offset_per_K = {slope[0], slope[1], slope[2]};
        section.finish();
    });
    return c;
}

bool is_finite(const Calibration& c) noexcept {
    const auto all = [](const Vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    for (const Affine* a : {&c.gyro, &c.accel, &c.mag}) {
        const float d = determinant(a->matrix);
        if (!all(a->offset) || !std::isfinite(d) || std::fabs(d) < determinant_min) return false;
    }
    const float square = dot(c.q_bs, c.q_bs);
    return all(c.gyro_offset_per_K) && std::isfinite(c.temperature_C) && square > 0.99f &&
           square < 1.01f;
}

}  // namespace

void read_calibration(const std::string& path, Calibration& out, Errors& errors) {
    std::string text, why;
    if (!read_small_file(path, toml_size_max, text, why)) {
        errors.push_back(path + ": " + why);
        return;
    }
    Saved<Calibration> saved;
    const bool begins_saved = text.size() == sizeof saved && text.find('=') == std::string::npos;
    if (begins_saved || text.find('\0') != std::string::npos) {
        if (text.size() != sizeof saved) {
            errors.push_back(path + ": is neither TOML nor a saved calibration of " +
                             std::to_string(sizeof saved) + " bytes");
            return;
        }
        std::memcpy(static_cast<void*>(&saved), text.data(), sizeof saved);
        const auto got = restore(saved);
        if (got && is_finite(*got))
            out = *got;
        else
            errors.push_back(path + ": is damaged, or was saved by another version");
        return;
    }
    const std::size_t before = errors.size();
    const Calibration c = from_toml(text, path, errors);
    if (errors.size() == before) out = c;
}

bool same_calibration(const Calibration& a, const Calibration& b) noexcept {
    const auto left = save(a), right = save(b);
    return std::memcmp(&left, &right, sizeof left) == 0;
}

bool parse_mounting(const std::string& text, Quat& q_bs) noexcept {
    std::istringstream words{text};
    std::array<Vec3, 3> rows{};  // of the matrix that takes the sensor's axes to the body's
    for (Vec3& row : rows) {
        std::string word;
        if (!(words >> word)) return false;
        const float sign = word[0] == '-' ? -1.0f : 1.0f;
        if (word[0] == '-' || word[0] == '+') word.erase(0, 1);
        if (word == "x")
            row = {sign, 0, 0};
        else if (word == "y")
            row = {0, sign, 0};
        else if (word == "z")
            row = {0, 0, sign};
        else
            return false;
    }
    std::string rest;
    if (words >> rest) return false;
    if (dot(rows[0], cross(rows[1], rows[2])) < 0.5f) return false;  // mirrored, or an axis twice
    // the rotation of this matrix, by the component that is largest (all are 0, 1/2 or larger)
    const float m[3][3] = {{rows[0].x, rows[0].y, rows[0].z},
                           {rows[1].x, rows[1].y, rows[1].z},
                           {rows[2].x, rows[2].y, rows[2].z}};
    const float trace = m[0][0] + m[1][1] + m[2][2];
    if (trace > -0.5f) {
        const float w = 0.5f * std::sqrt(1 + trace);
        const float k = 0.25f / w;
        q_bs = {w, k * (m[2][1] - m[1][2]), k * (m[0][2] - m[2][0]), k * (m[1][0] - m[0][1])};
        return true;
    }
    const int i = m[0][0] > m[1][1] ? (m[0][0] > m[2][2] ? 0 : 2) : (m[1][1] > m[2][2] ? 1 : 2);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    float v[3] = {};
    v[i] = 0.5f * std::sqrt(1 + m[i][i] - m[j][j] - m[k][k]);
    v[j] = (m[j][i] + m[i][j]) / (4 * v[i]);
    v[k] = (m[k][i] + m[i][k]) / (4 * v[i]);
    q_bs = {(m[k][j] - m[j][k]) / (4 * v[i]), v[0], v[1], v[2]};
    return true;
}

}  // namespace fairlead::gateway
