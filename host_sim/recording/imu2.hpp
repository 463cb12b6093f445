#pragma once
// .imu, version 2 (docs/imu.md): a header of 128 bytes that says which sensors a device has, then
// records of one size, each with its own validity; events among them.
#include <cstdint>
#include <string>
#include <string_view>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// What a record holds, as bits of the header's `fields` and of a record's flags.
namespace imu_field {
inline constexpr std::uint32_t gyro = 1, accel = 2, mag = 4, temperature = 8;
inline constexpr std::uint32_t reference_orientation = 16, reference_position = 32;
}  // namespace imu_field

struct Imu2Header {
    static constexpr std::uint64_t open = ~std::uint64_t{0};  // records up to the end of the file
    static constexpr std::size_t size = 128, count_offset = 16;

    std::string name;
    std::uint64_t count{open};
    std::uint32_t fields{};
    ReferenceFrame frame{ReferenceFrame::none};
    double rate_hz{};
    Vec3 full_scale{};
};

std::size_t imu2_record_size(std::uint32_t fields);

/// Parts of a file, for recorders that write as they go: a header, then records in time order.
std::string imu2_header(const Imu2Header& header);
void append_imu2(std::string& out, std::uint32_t fields, const Sample& sample,
                 const Pose& reference = {}, bool moving = false);
void append_imu2(std::string& out, std::uint32_t fields, const Event& event);

/// The fields that a recording needs.
std::uint32_t imu_fields(const Recording& recording);

/// A whole recording. Throws BadData for a time before zero, which the format does not have.
std::string to_imu2(const Recording& recording);

/// Fills the recording; throws BadData with the byte at the first damage, leaving all complete
/// records before it in place.
void parse_imu2(std::string_view bytes, Recording& recording, const Steps& progress = {});

}  // namespace fairlead::sim
