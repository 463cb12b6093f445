// Reads the bytes that the firmware sent, as a host on the other end of the UART would, and
// compares the decoded curves with the motion that the tracker saw.   usage: check_frames FILE
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "examples/firmware/config.hpp"
#include "examples/firmware/motion.hpp"
#include "fairlead/reduce/evaluate.hpp"
#include "fairlead/wire/decoder.hpp"

namespace {

using fairlead::Decoder;

float error(const std::array<float, 3>& p, const fairlead::Pose& truth) {
    return norm(fairlead::Vec3{p[0], p[1], p[2]} - truth.p_w_m);
}
float error(const fairlead::Quat& q, const fairlead::Pose& truth) {
    return rotation_angle(q, truth.q_wb);
}

/// The pieces of one channel's curve, each with the time up to which it is final.
template <class Channel>
class Track {
  public:
    void take(const fairlead::wire::Link<Channel>& link, const Decoder::Update& update,
              std::uint32_t tick_ns) {
        const std::int64_t t0_ns = link.curve.span.t0_ns;
        if (update.piece) {
            if (!update.begins && !update.rejoined && !pieces_.empty())
                pieces_.back().until_ns = t0_ns;
            pieces_.push_back({link.curve, t0_ns});
        }
        pieces_.back().until_ns = t0_ns + std::int64_t{link.cover_ticks} * tick_ns;
    }

    /// Largest error over the tracker's records; -1 where some record is not covered.
    float worst(const Decoder& decoder, const fairlead::wire::Link<Channel>& link) const {
        float worst = 0;
        for (std::int64_t n = 0; n < motion::records; ++n) {
            const std::int64_t t_ns = n * motion::step_ns;
            auto piece = pieces_.rbegin();
            while (piece != pieces_.rend() && piece->curve.span.t0_ns > t_ns) ++piece;
            if (piece == pieces_.rend() || t_ns >= piece->until_ns) return -1;
            const auto& curve = piece->curve;
            const auto value = fairlead::value_at(curve, link.scale, decoder.tick_ns(), t_ns);
            const float e = error(value, motion::at(t_ns));
            worst = e > worst ? e : worst;
        }
        return worst;
    }

  private:
    struct Piece {
        fairlead::Curve<Channel> curve;
        std::int64_t until_ns;
    };
    std::vector<Piece> pieces_;
};

}  // namespace

int main(int argc, char** argv) {
    std::ifstream file{argc > 1 ? argv[1] : "", std::ios::binary};
    const std::vector<char> bytes{std::istreambuf_iterator<char>{file}, {}};
    Decoder decoder;
    Track<Decoder::Position> position;
    Track<Decoder::Orientation> orientation;
    for (const char byte : bytes) {
        if (!decoder.push(static_cast<std::uint8_t>(byte))) continue;
        Decoder::Update update;
        while (decoder.next(update)) {
            if (update.channel == Decoder::Channel::position)
                position.take(decoder.position(), update, decoder.tick_ns());
            else
                orientation.take(decoder.orientation(), update, decoder.tick_ns());
        }
    }
    const auto& seen = decoder.counters();
    const float worst_m = position.worst(decoder, decoder.position());
    const float worst_rad = orientation.worst(decoder, decoder.orientation());
    std::printf("%zu bytes, %u frames, %u damaged; worst error %.2f mm, %.3f deg\n", bytes.size(),
                seen.frames, seen.damaged, static_cast<double>(worst_m) * 1e3,
                static_cast<double>(worst_rad) * 57.29578);
    // sqrt(3) tolerances per axis, and what the filter itself takes off a motion of this speed
    const auto params = Config::params().encoder;
    const float limit_m = 1.8f * params.tol_position_m[0];
    const float limit_rad = 1.2f * params.tol_orientation_rad;
    const bool fine = seen.damaged == 0 && worst_m >= 0 && worst_m < limit_m && worst_rad >= 0 &&
                      worst_rad < limit_rad;
    std::puts(fine ? "ok the frames tell the motion" : "FAIL the frames do not tell the motion");
    return fine ? 0 : 1;
}
