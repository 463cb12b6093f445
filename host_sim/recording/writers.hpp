#pragma once
// The other direction of recording.hpp: recordings and poses as the bytes of a file. Layouts:
// docs/formats.md. Reading back what is written here gives the same records, bit for bit, but for
// TUM, which has no place for a missing channel.
#include <string>
#include <vector>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// t_ns,px,py,pz,qw,qx,qy,qz with 9 significant digits; an invalid channel has empty fields.
std::string to_poses_csv(const std::vector<Pose>& poses, const Steps& progress = {});

/// t tx ty tz qx qy qz qw. Lines for the poses in which every channel that occurs in `poses` at all
/// is valid; a channel that never occurs is written as zero position or identity.
std::string to_tum(const std::vector<Pose>& poses, const Steps& progress = {});

/// Text of an IMU, in parts for recorders that write as they go: the header names the sensors of
/// `fields` (imu_field in imu2.hpp) and their units; a sensor that has no measurement in a record
/// has empty fields there.
std::string imu_csv_header(std::uint32_t fields, bool moving = false);
void append_imu_csv(std::string& out, std::uint32_t fields, const Sample& sample,
                    const Pose& reference = {}, const bool* moving = nullptr);
std::string to_imu_csv(const Recording& recording, const Steps& progress = {});

/// #timestamp [ns],w...,a...: gyroscope and accelerometer alone, for programs that know no other.
std::string to_euroc_imu(const std::vector<Sample>& samples);

/// .imu. Version 1 where it can hold the recording: all three sensors valid in every record, times
/// in whole microseconds without long pauses, no temperature, events, gaps or clipped readings.
/// Else version 2. `version` 1 or 2 asks for one; throws BadData where 1 cannot hold it.
std::string to_imu(const Recording& recording, int version = 0);

std::string to_trk(const Recording& recording);  // poses

/// Chooses by the extension: .imu .trk .tum .csv (IMU or poses, whichever the recording holds).
/// Throws BadSpec where the format cannot hold such a recording.
/// `progress`: called with records, of text.
std::string to_file(const Recording& recording, const std::string& path,
                    const Steps& progress = {});

/// What the file of such a name leaves out of the recording, in words; empty: nothing.
std::string left_out(const Recording& recording, const std::string& path);

}  // namespace fairlead::sim
