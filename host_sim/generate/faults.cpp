#include "host_sim/generate/faults.hpp"

#include <algorithm>
#include <limits>

#include "host_sim/generate/random.hpp"

namespace fairlead::sim {

const char* const faults_help =
    "SPEC = ITEM { '+' ITEM }, for example nan:5+gap:2:40+backward:1; places are random\n"
    "  records:\n"
    "    nan:COUNT            one value becomes not a number\n"
    "    inf:COUNT            one value becomes infinite\n"
    "    spike:COUNT[:VALUE]  one value jumps to VALUE   [1e6]\n"
    "    repeat:COUNT         a record comes twice\n"
    "    backward:COUNT       a record carries the time of ten records before\n"
    "    gap:COUNT:LENGTH     LENGTH records in a row are missing\n"
    "    stuck:COUNT:LENGTH   the values of LENGTH records repeat the first of them\n"
    "    zero:COUNT           all values of a record are zero, the quaternion included\n"
    "  bytes of the file, after all records (any file, a stream.flr too):\n"
    "    cut:SIZE             only SIZE bytes are left\n"
    "    flip:COUNT           one bit changes";

namespace {

std::size_t place(Random& random, std::size_t n) {
    return static_cast<std::size_t>(random.below(n));
}

/// The values of record i, as an array of floats: 7 of a pose, 9 of a sample.
float* values_of(Recording& recording, std::size_t i, std::size_t& count) {
    static_assert(sizeof(Pose) == 40 && sizeof(Sample) == 56);
    if (!recording.samples.empty()) {
        count = 9;
        return &recording.samples[i].gyro_rad_s.x;
    }
    count = 7;
    return &recording.poses[i].p_w_m.x;
}

template <class T>
void erase(std::vector<T>& items, std::size_t first, std::size_t count) {
    if (first >= items.size()) return;
    const auto begin = items.begin() + static_cast<std::ptrdiff_t>(first);
    items.erase(begin, begin + static_cast<std::ptrdiff_t>(std::min(count, items.size() - first)));
}

template <class T>
void repeat(std::vector<T>& items, std::size_t i) {
    if (i < items.size()) {
        const T copy = items[i];
        items.insert(items.begin() + static_cast<std::ptrdiff_t>(i), copy);
    }
}

void set_value(Recording& recording, Random& random, float value) {
    std::size_t count{};
    float* values = values_of(recording, place(random, recording.size()), count);
    values[random.below(count)] = value;
}

void set_time(Recording& recording, std::size_t i, std::int64_t t_ns) {
    if (recording.samples.empty())
        recording.poses[i].t_ns = t_ns;
    else
        recording.samples[i].t_ns = t_ns;
}

void stick(Recording& recording, std::size_t first, std::size_t length) {
    std::size_t count{};
    const float* source = values_of(recording, first, count);
    for (std::size_t i = first + 1; i < std::min(first + length, recording.size()); ++i)
        std::copy_n(source, count, values_of(recording, i, count));
}

void spoil_once(Recording& recording, const SpecItem& item, Random& random, std::size_t length) {
    if (item.name == "nan") {
        set_value(recording, random, std::numeric_limits<float>::quiet_NaN());
    } else if (item.name == "inf") {
        set_value(recording, random, std::numeric_limits<float>::infinity());
    } else if (item.name == "spike") {
        set_value(recording, random, static_cast<float>(item.number(1, -1e30, 1e30, 1e6)));
    } else if (item.name == "zero") {
        std::size_t count{};
        std::fill_n(values_of(recording, place(random, recording.size()), count), count, 0.0f);
    } else if (item.name == "repeat") {
        const std::size_t i = place(random, recording.size());
        repeat(recording.samples, i);
        repeat(recording.poses, i);
        repeat(recording.truth, i);
        repeat(recording.moving, i);
    } else if (item.name == "backward") {
        if (recording.size() < 11) return;
        const std::size_t i = 10 + place(random, recording.size() - 10);
        set_time(recording, i, recording.t_ns(i - 10));
    } else if (item.name == "stuck") {
        stick(recording, place(random, recording.size()), length);
    } else {  // gap: never the whole recording
        if (recording.size() <= length) return;
        const std::size_t i = place(random, recording.size() - length);
        erase(recording.samples, i, length);
        erase(recording.poses, i, length);
        erase(recording.truth, i, length);
        erase(recording.moving, i, length);
    }
}

}  // namespace

bool is_byte_fault(const SpecItem& item) {
    for (const char* name : {"cut", "flip"})
        if (item.name == name) return true;
    for (const char* name : {"nan", "inf", "spike", "zero", "repeat", "backward", "stuck", "gap"})
        if (item.name == name) return false;
    item.refuse("unknown item; see fairlead-sim faults --help");
}

void spoil_records(Recording& recording, const SpecItem& item, std::uint64_t seed) {
    const bool has_length = item.name == "gap" || item.name == "stuck";
    item.expect_arguments(has_length ? 2 : 1, has_length || item.name == "spike" ? 2 : 1);
    const long count = item.whole(0, 0, 1000000);
    const long length = has_length ? item.whole(1, 1, 1000000) : 1;
    Random random{seed};
    for (long i = 0; i < count; ++i)
        spoil_once(recording, item, random, static_cast<std::size_t>(length));
}

void spoil_bytes(std::string& bytes, const SpecItem& item, std::uint64_t seed) {
    item.expect_arguments(1, 1);
    const auto n = static_cast<std::size_t>(item.whole(0, 0, 2000000000));
    if (item.name == "cut") {
        bytes.resize(std::min(bytes.size(), n));
        return;
    }
    Random random{seed};
    for (std::size_t i = 0; i < n && !bytes.empty(); ++i) {
        const std::size_t at = place(random, bytes.size());
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
    }
}

}  // namespace fairlead::sim
