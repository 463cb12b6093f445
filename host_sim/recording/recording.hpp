#pragma once
// Recordings on the host: what a file holds, and one reader for all formats. docs/formats.md has
// the layouts. Readers deliver what the file says (NaN, backward time and jumps included): judging
// samples is the intake's work; a reader only refuses what it cannot understand without a guess.
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::sim {

enum class Format { imu, trk, imu_text, pose_text, tum, kitti };
const char* to_string(Format format);

/// Frame of the reference orientation of an IMU's recording.
enum class ReferenceFrame : std::uint32_t { none, east_north_up, level };

struct Recording {
    std::string name;
    Format format{};
    double period_s{};            // nominal, or the median step where the file names none
    std::vector<Pose> poses;      // what a tracker measured; validity per channel in the flags
    std::vector<Sample> samples;  // what an IMU measured; validity per sensor in the flags
    std::vector<Pose> truth;      // of an IMU: the reference, one per sample, never an input
    ReferenceFrame frame{ReferenceFrame::east_north_up};  // of `truth`
    std::vector<Event> events;         // of discrete channels: .imu holds them, or a file beside
    std::vector<std::uint8_t> moving;  // of an IMU: 1 in the movement phase, one per sample
    Vec3 full_scale{};                 // of gyro, accel, mag in their units; 0: not known
    std::string damage;                // why the rest of the file was left out (salvage only)
    std::string columns;               // of a text file: what was read, as --columns takes it
    std::vector<std::string> notes;    // what the reader took where the file does not say it
    bool version2{};                   // of an .imu: version 2

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

/// Called while a long file is read or written: how much is done.
using Steps = std::function<void(std::size_t done, std::size_t total)>;

/// What a user can say about a file that does not say it itself.
struct ReadOptions {
    // NOLINTNEXTLINE: a Salvage alone is a complete set of options
    ReadOptions(Salvage s = Salvage::no) : salvage{s} {}

    Salvage salvage;
    std::string columns;            // --columns t_ns,gx,gy,gz,ax,ay,az: what the columns are
    std::string units;              // --units t=us,gyro=deg/s,accel=g: of columns without a unit
    std::string sensors;            // --sensors gyro,accel: what an .imu of version 1 holds
    double rate_hz{};               // --rate: of records without times; 0: not given
    std::string times;              // --times FILE: times of records without them, one a line
    Steps progress;                 // in bytes; or empty
    std::vector<std::string> with;  // --with FILE...: other sensors of the device, merged by time
};

/// Understands .imu, .trk and text by content, whatever the file is called. Throws BadData (the
/// file) and BadSpec (the options).
Recording read_recording(const std::string& path, const ReadOptions& options = {});
Recording parse_recording(std::string_view bytes, const std::string& name,
                          const ReadOptions& options = {});

std::string read_bytes(const std::string& path);                      // throws BadData
void write_bytes(const std::string& path, std::string_view content);  // throws BadData
std::string stem_of(const std::string& path);  // file name without folder and extension

/// Median step in seconds; 0 where there are no two records.
double median_step_s(const Recording& recording);

/// The recording's poses, or BadData saying that an IMU alone needs the attitude stage first.
const std::vector<Pose>& poses_of(const Recording& recording);

}  // namespace fairlead::sim
