// What the firmware image measures (motion.csv), and what its filter makes of it (filtered.csv):
// the records that its guarantee speaks of, computed on the host. usage: firmware-motion FOLDER
#include <string>
#include <vector>

#include "examples/firmware/config.hpp"
#include "examples/firmware/motion.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/writers.hpp"

int main(int argc, char** argv) {
    using namespace fairlead;
    if (argc != 2) return 64;
    auto filter = Config::params().filter;
    std::vector<Pose> measured, filtered;
    for (std::int64_t i = 0; i < motion::records; ++i) {
        measured.push_back(motion::at(i * motion::step_ns));
        if (const auto pose = filter.push(measured.back())) filtered.push_back(*pose);
    }
    while (const auto pose = filter.flush()) filtered.push_back(*pose);
    const std::string folder = argv[1];
    sim::write_bytes(folder + "/motion.csv", sim::to_poses_csv(measured));
    sim::write_bytes(folder + "/filtered.csv", sim::to_poses_csv(filtered));
    return 0;
}
