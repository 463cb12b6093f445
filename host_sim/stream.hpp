#pragma once
// Recordings on the host: what a file holds, and one reader for all formats. docs/formats.md has
// the layouts. Readers deliver what the file says (NaN, backward time and jumps included): judging
// samples is Intake's work; a reader only refuses bytes it cannot understand.
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::sim {

enum class Format { imu, trk, euroc_imu, poses_csv, tum };
const char* to_string(Format format);

struct Recording {
    std::string name;
    Format format{};
    double period_s{};            // nominal, or the median step where the file names none
    std::vector<Pose> poses;      // what a tracker measured; validity per channel in the flags
    std::vector<Sample> samples;  // what an IMU measured
    std::vector<Pose> truth;      // of an .imu: the reference, one per sample, never an input
    std::vector<Event> events;    // of discrete channels; no format holds them (event_file.hpp)
    std::vector<std::uint8_t> moving;  // of an .imu: 1 in the movement phase, one per sample
    std::string damage;                // why the rest of the file was left out (salvage only)
    std::string note;                  // something odd, yet readable

    std::size_t size() const { return samples.empty() ? poses.size() : samples.size(); }
    std::int64_t t_ns(std::size_t i) const {
        return samples.empty() ? poses[i].t_ns : samples[i].t_ns;
    }
};

/// Content that cannot be used: exit code 1. The text names the file and the byte or line.
struct BadData : std::runtime_error {
    using std::runtime_error::runtime_error;
};

enum class Salvage { no, yes };  // yes: keep the complete records before the damage

/// Understands .imu, .trk, EuRoC IMU CSV, pose CSV (EuRoC ground truth and fairlead-sim's own) and
/// TUM by content, whatever the file is called. Throws BadData.
Recording read_recording(const std::string& path, Salvage salvage = Salvage::no);
Recording parse_recording(std::string_view bytes, const std::string& name,
                          Salvage salvage = Salvage::no);

std::string read_bytes(const std::string& path);                      // throws BadData
void write_bytes(const std::string& path, std::string_view content);  // throws BadData
std::string stem_of(const std::string& path);  // file name without folder and extension

/// The recording's poses, or BadData saying that an IMU alone needs the attitude stage first.
const std::vector<Pose>& poses_of(const Recording& recording);

}  // namespace fairlead::sim
