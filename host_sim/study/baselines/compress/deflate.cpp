#include "host_sim/study/baselines/compress/deflate.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace fairlead::sim {
namespace {

using Words = std::vector<std::uint32_t>;

Words words_of(const Track& track, std::size_t i) {
    const double* x = track.at(i);
    const bool flipped = track.channel == Channel::orientation && x[0] < 0;
    Words out(3);
    for (std::size_t d = 0; d < 3; ++d) {
        const double v = track.channel == Channel::position ? x[d] : x[d + 1];
        const float f = static_cast<float>(flipped ? -v : v);
        std::memcpy(&out[d], &f, sizeof f);
    }
    return out;
}

std::vector<unsigned char> bytes_of(const Words& words, bool planes) {
    std::vector<unsigned char> out(4 * words.size());
    for (std::size_t i = 0; i < words.size(); ++i)
        for (std::size_t b = 0; b < 4; ++b)
            out[planes ? b * words.size() + i : 4 * i + b] =
                static_cast<unsigned char>(words[i] >> (8 * (3 - b)));
    return out;
}

class Deflater {
  public:
    explicit Deflater(int strategy) {
        if (deflateInit2(&stream_, 9, Z_DEFLATED, -15, 9, strategy) != Z_OK)
            throw std::runtime_error("zlib cannot begin");
    }
    Deflater(const Deflater&) = delete;
    Deflater& operator=(const Deflater&) = delete;
    ~Deflater() { deflateEnd(&stream_); }

    void restart() { deflateReset(&stream_); }
    std::size_t add(std::vector<unsigned char> in, bool last) {
        std::vector<unsigned char> out(2 * in.size() + 64);
        stream_.next_in = in.data();
        stream_.avail_in = static_cast<uInt>(in.size());
        stream_.next_out = out.data();
        stream_.avail_out = static_cast<uInt>(out.size());
        deflate(&stream_, last ? Z_FINISH : Z_SYNC_FLUSH);
        const std::size_t flush_mark = last ? 0 : 4;
        return out.size() - stream_.avail_out - flush_mark;
    }

  private:
    z_stream stream_{};
};

}  // namespace

std::size_t deflated_size(const Track& track, const DeflateParams& params, std::size_t delay) {
    constexpr std::size_t record_number = 2;
    Deflater deflater{params.strategy};
    const Schedule schedule{track, delay};
    std::size_t size = 0;
    Words before(3);
    for (std::size_t i = 0; i < track.size();) {
        const std::size_t end = schedule.end(i, track.size());
        if (i % schedule.group == 0) {
            deflater.restart();
            before.assign(3, 0);
            size += record_number;
        }
        Words words;
        for (; i < end; ++i) {
            const Words now = words_of(track, i);
            for (std::size_t d = 0; d < 3; ++d)
                words.push_back(params.differences ? now[d] - before[d] : now[d]);
            before = now;
        }
        const bool last = end % schedule.group == 0 || end == track.size();
        size += frame_overhead + deflater.add(bytes_of(words, params.byte_planes), last);
    }
    return size;
}

}  // namespace fairlead::sim
