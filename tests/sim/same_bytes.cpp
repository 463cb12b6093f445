// Reduces recordings and prints a hash of each stream: to be built by several compilers.
#include <cstdio>
#include <memory>

#include "fairlead/pipeline.hpp"
#include "host_sim/generate/generate.hpp"
#include "host_sim/recording/recording.hpp"

using namespace fairlead;

namespace {

struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, Orientation>;
    using Filter = PoseFilter<9>;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::medium;
    static constexpr std::size_t events_max = 0;
};

std::uint64_t hash_of(const sim::Recording& recording, float tol_m, float tol_rad) {
    Pipeline<Board>::Params params;
    params.filter = Board::Filter{binomial_mask<9>()};
    params.tolerance.position_m = PerAxis<3>{tol_m};
    params.tolerance.orientation_rad = tol_rad;
    const auto pipeline = std::make_unique<Pipeline<Board>>(params);
    std::uint64_t hash = 14695981039346656037u;  // FNV-1a
    const auto take = [&](const Bytes& bytes) {
        for (std::size_t i = 0; i < bytes.size; ++i) hash = (hash ^ bytes.data[i]) * 1099511628211u;
        return bytes.status;
    };
    for (const Pose& pose : recording.poses) static_cast<void>(take(pipeline->push(pose)));
    while (take(pipeline->flush()) != Status::end) {
    }
    return hash;
}

void print(const sim::Recording& recording) {
    std::printf("%s %016llx %016llx\n", recording.name.c_str(),
                static_cast<unsigned long long>(hash_of(recording, 0.001f, 0.0043633f)),
                static_cast<unsigned long long>(hash_of(recording, 0.005f, 0.0174533f)));
}

}  // namespace

int main(int argc, char** argv) {
    print(sim::generate("rest:1+reach:0.8:5+gap:0.3+oscillate:3:2+jump+turn:1:12+rest:2", 1));
    for (int i = 1; i < argc; ++i) print(sim::read_recording(argv[i]));
}
