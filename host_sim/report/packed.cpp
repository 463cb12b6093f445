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

/// In parts, so that the work can be told: it takes longer than all the rest of a report.
std::string deflated(std::string bytes, const Steps& progress) {
    constexpr std::size_t part = std::size_t{1} << 16;
    z_stream z{};
    bool good = deflateInit(&z, Z_BEST_COMPRESSION) == Z_OK;
    std::string out(deflateBound(&z, static_cast<uLong>(bytes.size())), '\0');
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = static_cast<uInt>(out.size());
    for (std::size_t done = 0; good && done < bytes.size(); done += part) {
        if (progress) progress(done, bytes.size());
        z.next_in = reinterpret_cast<Bytef*>(bytes.data() + done);
        z.avail_in = static_cast<uInt>(std::min(part, bytes.size() - done));
        good = deflate(&z, Z_NO_FLUSH) == Z_OK;
    }
    good = good && deflate(&z, Z_FINISH) == Z_STREAM_END;
    out.resize(z.total_out);
    deflateEnd(&z);
    if (!good) throw std::runtime_error("zlib cannot compress the report's data");
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

std::string Packed::text(const Steps& progress) const { return base64(deflated(bytes_, progress)); }

}  // namespace fairlead::sim
