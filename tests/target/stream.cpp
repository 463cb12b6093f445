#include "tests/target/stream.hpp"

namespace fairlead::target {
namespace {

constexpr std::int32_t far = 1 << 23;  // of a position, 128 m: exact in a float
constexpr float metre = 1.0f / 65536, radian = 1.0f / 1048576;

Vec3 scaled(const std::array<std::int32_t, 3>& v, float unit) noexcept {
    return {static_cast<float>(v[0]) * unit, static_cast<float>(v[1]) * unit,
            static_cast<float>(v[2]) * unit};
}

// a rotation of about |half_angle| without any transcendental function
Quat turned(const Quat& q, const Vec3& half_angle) noexcept {
    return normalised(q * Quat{1, half_angle.x, half_angle.y, half_angle.z});
}

float clamped(float x, float limit) noexcept { return x > limit ? limit : x < -limit ? -limit : x; }
Vec3 clamped(const Vec3& v, float limit) noexcept {
    return {clamped(v.x, limit), clamped(v.y, limit), clamped(v.z, limit)};
}

float from_bits(std::uint32_t bits) noexcept {
    float x;
    __builtin_memcpy(&x, &bits, sizeof x);
    return x;
}

// ---- the text of a recipe
const char* skip_blanks(const char* at) noexcept {
    while (*at == ' ' || *at == '\t') ++at;
    return at;
}

bool read_number(const char*& at, std::int64_t& value) noexcept {
    at = skip_blanks(at);
    if (*at < '0' || *at > '9') return false;
    for (value = 0; *at >= '0' && *at <= '9' && value < (std::int64_t{1} << 40); ++at)
        value = value * 10 + (*at - '0');
    return true;
}

bool read_kind(const char*& at, Kind& kind) noexcept {
    for (std::size_t i = 0; i < kind_names.size(); ++i) {
        std::size_t n = 0;
        while (kind_names[i][n] != '\0' && kind_names[i][n] == at[n]) ++n;
        if (kind_names[i][n] != '\0' || at[n] != ':') continue;
        kind = static_cast<Kind>(i);
        at += n;
        return true;
    }
    return false;
}

bool read_segment(const char*& at, Segment& segment) noexcept {
    if (!read_kind(at, segment.kind)) return false;
    for (std::int32_t* field : {&segment.length, &segment.move, &segment.turn, &segment.pace}) {
        std::int64_t value = 0;
        if (*at != ':' || !read_number(++at, value) || value > far) return false;
        *field = static_cast<std::int32_t>(value);
    }
    return segment.length > 0 && segment.pace > 0;
}

}  // namespace

bool parse(const char* line, Recipe& recipe) noexcept {
    recipe = {};
    const char* at = skip_blanks(line);
    std::size_t n = 0;
    for (; *at > ' ' && *at != '#' && n + 1 < sizeof recipe.name; ++at) recipe.name[n++] = *at;
    std::int64_t seed = 0, rate_hz = 0;
    if (n == 0 || !read_number(at, seed) || !read_number(at, rate_hz)) return false;
    if (rate_hz < 1 || rate_hz > 100000) return false;
    recipe.seed = static_cast<std::uint32_t>(seed);
    recipe.rate_hz = static_cast<std::int32_t>(rate_hz);
    for (at = skip_blanks(at); *at > ' '; at = skip_blanks(at)) {
        if (recipe.segments_size == Recipe::segments_max) return false;
        if (!read_segment(at, recipe.segments[recipe.segments_size++])) return false;
    }
    return recipe.segments_size > 0;
}

Generator::Generator(const Recipe& recipe) noexcept : recipe_{recipe}, dice_{recipe.seed} {}

Generator::Ints Generator::draw(std::int32_t scale) noexcept {
    Ints drawn{};
    for (std::int32_t& x : drawn) x = dice_.around_zero(scale);
    return drawn;
}

void Generator::enter_segment() noexcept {
    const Segment& s = recipe_.segments[segment_];
    const bool straight = s.kind == Kind::line || s.kind == Kind::zigzag;
    v_ = straight ? draw(s.move / 4) : Ints{};
    w_ = straight ? draw(s.turn / 4) : Ints{};
}

void Generator::move_on() noexcept {
    const Segment& s = recipe_.segments[segment_];
    const bool walks = s.kind == Kind::walk || s.kind == Kind::flip || s.kind == Kind::gap ||
                       s.kind == Kind::jitter;
    v_old_ = v_;
    if (walks && at_ % s.pace == 0) {
        const bool lost_time = s.kind == Kind::gap;  // there MOVE is a time
        const Ints dv = draw(lost_time ? 256 : s.move), dw = draw(s.turn);
        for (std::size_t i = 0; i < 3; ++i) {
            v_[i] += dv[i] - v_[i] / 8;
            w_[i] += dw[i] - w_[i] / 8;
        }
    }
    if (s.kind == Kind::huge) {
        p_ = draw(far);
        w_ = draw(far);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        p_[i] += v_[i];
        if (p_[i] > far || p_[i] < -far) {
            p_[i] = p_[i] > 0 ? far : -far;
            v_[i] = -v_[i];
        }
    }
    q_ = turned(q_, scaled(w_, radian));
}

std::int64_t Generator::step_ns() noexcept {
    const Segment& s = recipe_.segments[segment_];
    const std::int64_t even = 1'000'000'000 / recipe_.rate_hz;
    if (s.kind == Kind::gap && at_ % s.pace == 0) return even * (1 + s.move);
    if (s.kind == Kind::jitter) {
        const std::int32_t percent = s.pace < 90 ? s.pace : 90;
        return even + even * dice_.around_zero(percent) / 100;
    }
    return even;
}

Pose Generator::shape() noexcept {
    const Segment& s = recipe_.segments[segment_];
    Pose pose{t_ns_, scaled(p_, metre), q_, flag::position_valid | flag::orientation_valid};
    const bool odd_pace = (at_ / s.pace) % 2 != 0;
    if (s.kind == Kind::noise) {
        pose.p_w_m += scaled(draw(s.move), metre);
        pose.q_wb = turned(q_, scaled(draw(s.turn), radian));
    } else if (s.kind == Kind::zigzag && odd_pace) {
        pose.p_w_m += scaled({s.move, -s.move, s.move}, metre);
        pose.q_wb = turned(q_, scaled({s.turn, 0, -s.turn}, radian));
    } else if (s.kind == Kind::flip && odd_pace) {
        pose.q_wb = -q_;
    } else if (s.kind == Kind::tiny) {
        pose.p_w_m = {from_bits(dice_.next() & 0x807FFFFF), from_bits(dice_.next() & 0x807FFFFF),
                      from_bits(dice_.next() & 0x81FFFFFF)};
        pose.q_wb = {1, from_bits(dice_.next() & 0x807FFFFF), from_bits(dice_.next() & 0x80FFFFFF),
                     from_bits(dice_.next() & 0x8FFFFFFF)};
    } else if (s.kind == Kind::gap && at_ % s.pace == 0 && s.move > 0) {
        pose.flags |= flag::gap_before;
    } else if (s.kind == Kind::gap && s.turn % 2 != 0 && at_ % s.pace < s.pace / 2) {
        pose.flags &= ~std::uint32_t{odd_pace ? flag::position_valid : flag::orientation_valid};
    }
    return pose;
}

Sample Generator::sense(const Pose& pose, std::int64_t dt_ns) noexcept {
    const Segment& s = recipe_.segments[segment_];
    const float rate = 1e9f / static_cast<float>(dt_ns);
    Sample sample;
    sample.t_ns = pose.t_ns;
    sample.flags =
        flag::gyro_valid | flag::accel_valid | flag::mag_valid | (pose.flags & flag::gap_before);
    const Quat to_body = conj(q_);
    const Ints dv{v_[0] - v_old_[0], v_[1] - v_old_[1], v_[2] - v_old_[2]};
    const Vec3 accel_w = rate * rate * scaled(dv, metre) + Vec3{0, 0, 9.81f};
    sample.gyro_rad_s = 2 * rate * scaled(w_, radian);
    sample.accel_m_s2 = rotate(to_body, accel_w);
    sample.mag_uT = rotate(to_body, Vec3{0, 20, -40});
    if (s.kind == Kind::noise) {
        sample.gyro_rad_s += scaled(draw(s.turn), 16 * radian);
        sample.accel_m_s2 += scaled(draw(s.move), 16 * metre);
        sample.mag_uT += scaled(draw(s.move), 16 * metre);
    } else if (s.kind == Kind::zigzag && (at_ / s.pace) % 2 != 0) {
        sample.gyro_rad_s += scaled({s.turn, -s.turn, s.turn}, 4 * radian);
        sample.accel_m_s2 += scaled({s.move, s.move, -s.move}, 4 * metre);
        sample.mag_uT += scaled({s.move, 0, s.move}, 64 * metre);
    } else if (s.kind == Kind::tiny) {
        sample.gyro_rad_s = pose.p_w_m;
        sample.accel_m_s2 = vec(pose.q_wb);
    }
    sample.gyro_rad_s = clamped(sample.gyro_rad_s, 35);
    sample.accel_m_s2 = clamped(sample.accel_m_s2, 160);
    sample.mag_uT = clamped(sample.mag_uT, 1000);
    return sample;
}

void Generator::spoil(Record& record) noexcept {
    const std::uint32_t draw = dice_.next();
    const float bad = from_bits(dice_.next() | 0x7F000000);  // huge, infinite or NaN, any sign
    const float any = from_bits(dice_.next());
    switch (draw % 10) {
        case 0: record.pose.p_w_m.y = record.sample.accel_m_s2.x = bad; break;
        case 1: record.pose.q_wb.x = record.sample.gyro_rad_s.z = bad; break;
        case 2: record.pose.q_wb = {0, 0, 0, 0}; break;
        case 3: record.pose.q_wb.w = record.sample.mag_uT.y = any; break;
        case 4: record.pose.p_w_m.z = record.sample.gyro_rad_s.y = any; break;
        case 5: record.pose.t_ns -= static_cast<std::int64_t>(dice_.next()); break;
        case 6: record.pose.t_ns += static_cast<std::int64_t>(dice_.next()) << 31; break;
        case 7: record.pose.flags = record.sample.flags = dice_.next(); break;
        default: break;
    }
    record.sample.t_ns = record.pose.t_ns;
}

bool Generator::next(Record& record, bool with_wild) noexcept {
    for (++at_; segment_ < recipe_.segments_size; at_ = 0, ++segment_) {
        const Segment& s = recipe_.segments[segment_];
        if (at_ < s.length && (with_wild || s.kind != Kind::wild)) break;
    }
    if (segment_ == recipe_.segments_size) return false;
    if (at_ == 0) enter_segment();
    const std::int64_t dt_ns = step_ns();
    t_ns_ += dt_ns;
    move_on();
    record.pose = shape();
    record.sample = sense(record.pose, dt_ns);
    if (recipe_.segments[segment_].kind == Kind::wild) spoil(record);
    return true;
}

}  // namespace fairlead::target
