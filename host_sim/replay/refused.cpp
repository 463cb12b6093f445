#include "host_sim/replay/refused.hpp"

#include "fairlead/sense/intake.hpp"
#include "host_sim/replay/replay.hpp"

namespace fairlead::sim {
namespace {

template <class Record>
std::size_t refused(const std::vector<Record>& records, const IntakeParams& params) {
    constexpr std::uint32_t channels = flag::position_valid | flag::orientation_valid |
                                       flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    Intake<Record> intake{params};
    std::size_t count = 0;
    for (const Record& record : records) {
        const auto out = intake.push(record);
        if (!out || (record.flags & ~out->flags & channels) != 0) ++count;
    }
    return count;
}

}  // namespace

std::size_t refused_records(const Recording& recording) {
    const IntakeParams params = intake_params(recording);
    return recording.samples.empty() ? refused(recording.poses, params)
                                     : refused(recording.samples, params);
}

}  // namespace fairlead::sim
