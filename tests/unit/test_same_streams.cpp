// Whole pipelines give the same bytes on every machine, and a reader tells the same of them, also
// where frames are damaged (same_bits.hpp).
#include <memory>

#include "fairlead/wire/decoder.hpp"
#include "tests/target/pipeline_stage.hpp"
#include "tests/unit/same_bits.hpp"

namespace fairlead::test {
namespace {

template <class In, class Chosen, std::size_t Delay, Beam Width, class AFilter = NoFilter>
struct BoardOf {
    using Input = In;
    using Channels = Chosen;
    using Filter = AFilter;
    static constexpr std::size_t delay_records_max = Delay;
    static constexpr Beam beam = Width;
    static constexpr std::size_t events_max = 2;
};

/// Curves whose acceleration is continuous, too.
template <class Board>
struct CubicsOf : Board {
    using Kind = curve::Cubics;
};

/// What a reader tells of a stream: every piece, at its ends and in its middle.
class Readings {
  public:
    explicit Readings(Digest& digest) : digest_{digest} {}
    void take(std::uint8_t byte) {
        if (decoder_.push(byte)) drain();
    }
    void finish() {
        while (decoder_.finish()) drain();
        mix(digest_, decoder_.frame_counters().frames);
        mix(digest_, decoder_.counters().breaks);
    }

  private:
    using Decoder = wire::Decoder<3, 1, wire::KindSet<curve::Smooth, curve::Cubics>>;

    void drain() {
        Decoder::Piece piece;
        Event event;
        while (decoder_.next(piece)) {
            mix(digest_, std::uint32_t{piece.channel});
            mix(digest_, piece.start);
            mix(digest_, piece.end);
            const auto ticks = piece.ticks<float>();
            for (const float at : {0.0f, ticks / 2, ticks}) {
                if (piece.rotates) mix(digest_, wire::rotation_at(piece, at));
                mix(digest_, piece.steps_at(at));
                mix(digest_, piece.rate_at(at));
            }
        }
        while (decoder_.next_event(event)) mix(digest_, event.t_ns);
    }

    Decoder decoder_{};
    Digest& digest_;
};

template <class Input>
Input input(const Record& record) {
    if constexpr (std::is_same_v<Input, Sample>) {
        return record.sample;
    } else if constexpr (std::is_same_v<Input, Pose>) {
        return record.pose;
    } else {
        Input vector;
        vector.t_ns = record.pose.t_ns;
        vector.value = {record.pose.p_w_m.x, record.sample.gyro_rad_s.y};
        if ((record.pose.flags & flag::position_valid) != 0) vector.flags = flag::vector_valid;
        return vector;
    }
}

/// The bytes of a board, and what is read of them where every eleventh frame is damaged.
template <class Board>
void run(std::int64_t period_ns, std::int64_t restart_ns, const Records& records, Digest& digest) {
    using Whole = Pipeline<Board>;
    typename Whole::Params params;
    params.sample_period_ns = period_ns;
    params.restart_interval_ns = restart_ns;
    const auto pipeline = std::make_unique<Whole>(params);
    Readings readings{digest};
    std::uint32_t portions = 0;
    const auto send = [&](const Bytes& bytes) {
        mix(digest, bytes);
        const bool damage = !bytes.empty() && ++portions % 11 == 0;
        for (std::size_t i = 0; i < bytes.size; ++i)
            readings.take(static_cast<std::uint8_t>(bytes.data[i] ^ (damage && i == 3 ? 16 : 0)));
        return bytes.status != Status::end;
    };
    std::uint16_t count = 0;
    for (const Record& record : records) {
        send(pipeline->push(input<typename Whole::Raw>(record)));
        if (++count % 100 == 50) pipeline->push_event({record.pose.t_ns, 7, count, 0});
        if (count % 250 == 0) send(pipeline->idle());
    }
    for (int i = 0; i < 1000 && send(pipeline->flush()); ++i) continue;
    readings.finish();
}

TEST(SameBits, Boards) {
    using Both = Channels<Position, Orientation>;
    using Turning = Channels<Orientation>;
    constexpr std::int64_t hz120 = 8'333'333, often = 300'000'000;
    Bits bits{"boards"};
    for (const NamedStream& s : streams()) {
        const auto add = [&](const char* board, auto run_board, std::int64_t period_ns,
                             std::int64_t restart_ns) {
            bits.add(board, s.name,
                     [&](Digest& digest) { run_board(period_ns, restart_ns, s.all, digest); });
        };
        add("both_narrow", run<BoardOf<Pose, Both, 48, Beam::narrow>>, hz120, often);
        add("both_medium", run<BoardOf<Pose, Both, 120, Beam::medium, PoseFilter<9>>>, hz120, 0);
        add("measured", run<BoardOf<Pose, Both, 64, Beam::narrow>>, 0, never_ns);
        add("position", run<BoardOf<Pose, Channels<Position>, 24, Beam::wide, PoseFilter<3>>>,
            hz120, often);
        add("orientation", run<BoardOf<Pose, Turning, 32, Beam::wide>>, hz120, 0);
        add("vector", run<BoardOf<VectorSample<2>, Channels<Vector<2>>, 16, Beam::medium>>, hz120,
            often);
        add("cubics", run<CubicsOf<BoardOf<Pose, Channels<Position>, 64, Beam::medium>>>, hz120,
            often);
        add("cubics_vector",
            run<CubicsOf<BoardOf<VectorSample<2>, Channels<Vector<2>>, 32, Beam::narrow>>>, hz120,
            0);
        add("imu", run<BoardOf<Imu<AttitudeMode::imu_mag>, Turning, 32, Beam::narrow>>, hz120,
            often);
    }
}

}  // namespace
}  // namespace fairlead::test
