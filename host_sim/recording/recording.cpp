#include "host_sim/recording/recording.hpp"

#include <algorithm>
#include <fstream>

#include "host_sim/recording/binary.hpp"
#include "host_sim/recording/encoding.hpp"
#include "host_sim/recording/layout.hpp"
#include "host_sim/recording/merge.hpp"
#include "host_sim/recording/text.hpp"

namespace fairlead::sim {

const char* to_string(Format format) {
    switch (format) {
        case Format::imu: return ".imu";
        case Format::trk: return ".trk";
        case Format::imu_text: return "text of an IMU";
        case Format::pose_text: return "text of poses";
        case Format::tum: return "TUM";
        case Format::kitti: return "KITTI poses";
    }
    return "?";
}

double median_step_s(const Recording& recording) {
    std::vector<std::int64_t> steps;
    for (std::size_t i = 1; i < recording.size(); ++i)  // a step beyond int64 is no step
        if (std::int64_t step{};
            !__builtin_sub_overflow(recording.t_ns(i), recording.t_ns(i - 1), &step))
            steps.push_back(step);
    if (steps.empty()) return 0;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return static_cast<double>(*middle) * 1e-9;
}

Recording parse_recording(std::string_view bytes, const std::string& name,
                          const ReadOptions& options) {
    Recording recording;
    recording.name = stem_of(name);
    try {
        if (!looks_utf16(bytes) && looks_binary(bytes))
            parse_binary(bytes, options, recording);
        else
            parse_text(bytes, options, sensor_of_name(name), recording);
    } catch (const BadData& damage) {
        const std::string where = name + ": " + damage.what();
        if (options.salvage == Salvage::no || recording.size() == 0) throw BadData(where);
        recording.damage = where;
    }
    if (recording.size() == 0) throw BadData(name + ": holds no records");
    if (!(recording.period_s > 0)) recording.period_s = median_step_s(recording);
    return recording;
}

Recording read_recording(const std::string& path, const ReadOptions& options) {
    Recording recording = parse_recording(read_bytes(path), path, options);
    if (options.with.empty()) return recording;
    ReadOptions others = options;
    others.columns.clear();  // they describe the first file
    others.with.clear();
    std::vector<Recording> parts{std::move(recording)};
    for (const std::string& other : options.with)
        parts.push_back(parse_recording(read_bytes(other), other, others));
    return merged(parts);
}

std::string read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw BadData(path + ": cannot be opened");
    std::string bytes, part(std::size_t{1} << 20, '\0');  // in parts: the file may be a pipe
    while (file.read(part.data(), static_cast<std::streamsize>(part.size())) || file.gcount() > 0)
        bytes.append(part, 0, static_cast<std::size_t>(file.gcount()));
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
