#include "host_sim/report/packed.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>

namespace fairlead::sim {
namespace {

constexpr std::uint32_t no_value = 65535;

std::string base64(const std::string& bytes) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve(bytes.size() / 3 * 4 + 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word =
                word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 4; ++k)
            out += k <= have ? digits[word >> (18 - 6 * k) & 63u] : '=';
    }
    return out;
}

std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::string out(size, '\0');
    if (compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                  reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                  9) != Z_OK)
        throw std::runtime_error("zlib cannot compress the report's data");
    out.resize(size);
    return out;
}

}  // namespace

/// The low bytes of all words, then the next ones: differences are small, so that most planes are
/// nearly empty.
void Packed::put_planes(const std::vector<std::uint32_t>& words, int bytes) {
    for (int plane = 0; plane < bytes; ++plane)
        for (const std::uint32_t w : words)
            bytes_ += static_cast<char>(static_cast<unsigned char>(w >> (8 * plane) & 255u));
}

std::string Packed::add_values(const std::vector<double>& values) {
    double low = INFINITY, high = -INFINITY;
    for (const double v : values)
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    if (!(low <= high)) low = 0, high = 1;
    const double step = high > low ? (high - low) / levels : 0;
    const std::size_t at = bytes_.size();
    std::vector<std::uint32_t> words;
    std::uint32_t last = 0;
    for (const double v : values) {
        const std::uint32_t level = !std::isfinite(v) ? no_value
                                    : step > 0
                                        ? static_cast<std::uint32_t>(std::lround((v - low) / step))
                                        : 0;
        words.push_back((level - last) & 65535u);
        last = level;
    }
    put_planes(words, 2);
    char text[160];
    std::snprintf(text, sizeof text, R"({"at":%zu,"n":%zu,"zero":%.9g,"step":%.9g})", at,
                  values.size(), low, step);
    return text;
}

std::string Packed::add_times(const std::vector<double>& seconds) {
    std::vector<std::uint32_t> words;
    std::int64_t last = 0, last_step = 0;
    for (const double s : seconds) {  // the change of the step: zero at an even rate
        const std::int64_t us = std::llround(s * 1e6), step = us - last;
        words.push_back(static_cast<std::uint32_t>(step - last_step));
        last = us;
        last_step = step;
    }
    const std::size_t at = bytes_.size();
    put_planes(words, 4);
    char text[80];
    std::snprintf(text, sizeof text, R"({"at":%zu,"n":%zu})", at, seconds.size());
    const auto [found, added] = times_.emplace(bytes_.substr(at), text);
    if (!added) bytes_.resize(at);
    return found->second;
}

std::string Packed::text() const { return base64(deflated(bytes_)); }

}  // namespace fairlead::sim
