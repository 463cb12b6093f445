#pragma once
// Every elementary function, on the stream's numbers and on arbitrary bit patterns.
#include "fairlead/math/approx.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "sin cos atan2 asin acos exp log sqrt, one of each";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = true;
    using Output = std::array<float, 16>;

    std::optional<Output> push(const fairlead::target::Record& in) {
        const fairlead::Vec3& p = in.pose.p_w_m;
        Output out{};
        evaluate(p.x, p.y, &out[0]);
        std::uint32_t bits[2];
        __builtin_memcpy(bits, &p.y, sizeof bits);
        float any[2];
        for (std::uint32_t& b : bits) b = (b ^ (b >> 15)) * 2654435769u;
        __builtin_memcpy(any, bits, sizeof any);
        evaluate(any[0], any[1], &out[8]);
        return out;
    }
    std::optional<Output> flush() { return std::nullopt; }

  private:
    static void evaluate(float x, float y, float* out) {
        namespace approx = fairlead::approx;
        const auto sc = approx::sin_cos(x);
        out[0] = sc.sin;
        out[1] = sc.cos;
        out[2] = approx::atan2(y, x);
        out[3] = approx::asin(x);
        out[4] = approx::acos(y);
        out[5] = approx::exp(x);
        out[6] = approx::log(y);
        out[7] = approx::sqrt(approx::absolute(x));
    }
};
