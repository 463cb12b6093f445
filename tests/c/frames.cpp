// The frames of records.h from the pipeline in C++, for the comparison with those of checks.c.
//   usage: frames FILE     (FAIRLEAD_CONFIG names the configuration)
#include <fstream>

#include FAIRLEAD_CONFIG
#include "tests/c/records.h"

namespace {

using namespace fairlead;

void fill(Pose& r, int i) {
    r.p_w_m = {0.1f * record_wave(i), 0.2f * record_wave(i + 20), 0.3f * record_wave(i + 40)};
    r.q_wb = {1, 0.004f * record_wave(i), 0, 0};
    r.flags = flag::position_valid | flag::orientation_valid;
}
void fill(Sample& r, int i) {
    r.gyro_rad_s = {0.3f * record_wave(i), 0.3f * record_wave(i + 20), 0.3f * record_wave(i + 40)};
    r.accel_m_s2 = {0, 0, 9.80665f};
    r.flags = flag::gyro_valid | flag::accel_valid;
}
template <std::size_t D>
void fill(VectorSample<D>& r, int i) {
    for (std::size_t a = 0; a < D; ++a) r.value[a] = record_wave(i + 20 * static_cast<int>(a));
    r.flags = flag::vector_valid;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    using Board = Pipeline<Config>;
    static Board pipeline{Config::params()};
    std::ofstream file{argv[1], std::ios::binary};
    const auto write = [&](const Bytes& bytes) {
        file.write(reinterpret_cast<const char*>(bytes.data),
                   static_cast<std::streamsize>(bytes.size));
        return bytes.status;
    };
    for (int i = 0; i < record_count; ++i) {
        Board::Raw record{};
        record.t_ns = record_time(i);
        fill(record, i);
        if (!record_is_valid(i)) record.flags = 0;
        (void)write(pipeline.push(record));
        if (i == 100 && Config::events_max > 0) {
            for (std::size_t n = 0; n <= Config::events_max; ++n)
                (void)pipeline.push_event({record.t_ns, 3, 1, 0});
            (void)write(pipeline.idle());
        }
    }
    while (write(pipeline.flush()) != Status::end) continue;
}
