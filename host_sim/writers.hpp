#pragma once
// The other direction of stream.hpp: recordings and poses as the bytes of a file. Layouts:
// docs/formats.md. Reading back what is written here gives the same records, bit for bit, but for
// TUM, which has no place for a missing channel.
#include <string>
#include <vector>

#include "host_sim/stream.hpp"

namespace fairlead::sim {

/// t_ns,px,py,pz,qw,qx,qy,qz with 9 significant digits; an invalid channel has empty fields.
std::string to_poses_csv(const std::vector<Pose>& poses);

/// t tx ty tz qx qy qz qw. Lines for the poses in which every channel that occurs in `poses` at all
/// is valid; a channel that never occurs is written as zero position or identity.
std::string to_tum(const std::vector<Pose>& poses);

std::string to_euroc_imu(const std::vector<Sample>& samples);  // #timestamp [ns],w...,a...
std::string to_imu(const Recording& recording);                // samples, truth, moving
std::string to_trk(const Recording& recording);                // poses

/// Chooses by the extension: .imu .trk .tum .csv (IMU or poses, whichever the recording holds).
/// Throws BadSpec where the format cannot hold such a recording.
std::string to_file(const Recording& recording, const std::string& path);

}  // namespace fairlead::sim
