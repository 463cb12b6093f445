#include "host_sim/stream.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "host_sim/stream_binary.hpp"
#include "host_sim/stream_text.hpp"

namespace fairlead::sim {

const char* to_string(Format format) {
    switch (format) {
        case Format::imu: return "imu";
        case Format::trk: return "trk";
        case Format::euroc_imu: return "EuRoC IMU CSV";
        case Format::poses_csv: return "pose CSV";
        case Format::tum: return "TUM";
    }
    return "?";
}

namespace {

double median_step_s(const Recording& recording) {
    std::vector<std::int64_t> steps;
    for (std::size_t i = 1; i < recording.size(); ++i)
        steps.push_back(recording.t_ns(i) - recording.t_ns(i - 1));
    if (steps.empty()) return 0;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return static_cast<double>(*middle) * 1e-9;
}

}  // namespace

Recording parse_recording(std::string_view bytes, const std::string& name, Salvage salvage) {
    Recording recording;
    recording.name = stem_of(name);
    try {
        if (looks_binary(bytes))
            parse_binary(bytes, recording);
        else
            parse_text(bytes, recording);
    } catch (const BadData& damage) {
        const std::string where = name + ": " + damage.what();
        if (salvage == Salvage::no || recording.size() == 0) throw BadData(where);
        recording.damage = where;
    }
    if (recording.size() == 0) throw BadData(name + ": holds no records");
    if (!(recording.period_s > 0)) recording.period_s = median_step_s(recording);
    return recording;
}

Recording read_recording(const std::string& path, Salvage salvage) {
    return parse_recording(read_bytes(path), path, salvage);
}

std::string read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw BadData(path + ": cannot be opened");
    std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (file.bad()) throw BadData(path + ": cannot be read");
    return bytes;
}

void write_bytes(const std::string& path, std::string_view content) {
    std::ofstream file(path, std::ios::binary);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    file.close();
    if (!file) throw BadData(path + ": cannot be written");
}

std::string stem_of(const std::string& path) {
    const std::size_t slash = path.find_last_of('/');
    const std::string file = slash == std::string::npos ? path : path.substr(slash + 1);
    const std::size_t dot = file.find_last_of('.');
    return dot == std::string::npos || dot == 0 ? file : file.substr(0, dot);
}

const std::vector<Pose>& poses_of(const Recording& recording) {
    if (recording.poses.empty() && !recording.samples.empty())
        throw BadData(recording.name +
                      ": an IMU recording holds no poses; it needs the attitude stage first "
                      "(its reference poses are truth, not input)");
    return recording.poses;
}

}  // namespace fairlead::sim
