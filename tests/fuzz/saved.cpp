// What a board keeps over a power-down, with any damage. Held: bytes that were changed are refused;
// what was saved comes back, and a filter that takes it over goes on with finite numbers.
#include "fairlead/sense/saved.hpp"

#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/calibrate.hpp"
#include "fairlead/sense/intake.hpp"
#include "tests/fuzz/input.hpp"

namespace {

using namespace fairlead;
using fuzz::Input;

template <class T>
bool same(const T& a, const T& b) {
    return std::memcmp(static_cast<const void*>(&a), static_cast<const void*>(&b), sizeof a) == 0;
}

/// Bytes that a store gives back instead of what was put into it.
template <class T>
void damage(const T& value, Input& in) {
    const Saved<T> good = save(value);
    Saved<T> read = good;
    std::array<std::uint8_t, sizeof read> bytes{};
    std::memcpy(bytes.data(), static_cast<const void*>(&read), sizeof read);
    const std::size_t edits = in.below(4);
    for (std::size_t i = 0; i < edits; ++i) bytes[in.below(sizeof read)] = in.byte();
    if (in.flag()) {  // a store that was cut off, or never written
        const std::size_t from = in.below(sizeof read);
        std::memset(bytes.data() + from, in.flag() ? 0xff : 0, sizeof read - from);
    }
    std::memcpy(static_cast<void*>(&read), bytes.data(), sizeof read);
    const auto found = restore(read);
    const bool whole = same(read.value, good.value) && read.version == good.version &&
                       read.size == good.size && read.crc == good.crc;
    FUZZ_EXPECT(static_cast<bool>(found) == whole);
    if (found) FUZZ_EXPECT(same(*found, good.value));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input in{data, size};
    const bool board = in.flag();
    if (board) {
        Calibration calibration;
        calibration.gyro.offset = in.vector(0.1f);
        calibration.mag.matrix.x = in.vector(1);
        damage(calibration, in);
        return 0;
    }
    using Filter = BasicAttitude<float, AttitudeMode::imu_mag>;
    Filter first;
    std::int64_t t = 0;
    // levelled after half a second; now and then what takes longer has happened, too
    const std::size_t before = in.below(in.byte() % 16 == 0 ? 600 : 80);
    Sample still = fuzz::sample(in);
    Intake<Sample> intake;  // what filters get is finite and in range
    if (const auto accepted = intake.push(still)) still = *accepted;
    for (std::size_t i = 0; i < before; ++i) {
        Sample s = still;
        s.t_ns = t += 10'000'000;
        static_cast<void>(first.push(s));
    }
    const auto kept = restore(save(first.state()));
    FUZZ_EXPECT(kept);
    Filter all, knowledge;
    all.restore_all(*kept);
    knowledge.restore_knowledge(*kept);
    for (int i = 0; i < 20; ++i) {
        Sample s = still;
        s.t_ns = t += 10'000'000;
        const auto a = first.push(s), b = all.push(s);
        static_cast<void>(knowledge.push(s));
        FUZZ_EXPECT(static_cast<bool>(a) == static_cast<bool>(b));
        if (a) FUZZ_EXPECT(same(a->q_wb, b->q_wb) && a->flags == b->flags);
    }
    FUZZ_EXPECT(is_finite(knowledge.orientation()));
    damage(first.state(), in);
    return 0;
}
