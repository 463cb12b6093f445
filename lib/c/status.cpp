// Status codes, flags and version of fairlead.h, held to those of the library.
#include "lib/c/objects.hpp"

namespace fairlead::c {

static_assert(FAIRLEAD_C_VERSION == FAIRLEAD_VERSION_NUMBER);

constexpr bool is(int code, Status status) noexcept { return code == static_cast<int>(status); }
static_assert(is(FAIRLEAD_OK, Status::ok) && is(FAIRLEAD_TIMEOUT, Status::timeout) &&
              is(FAIRLEAD_END, Status::end) && is(FAIRLEAD_BUSY, Status::busy) &&
              is(FAIRLEAD_NOT_FOUND, Status::not_found) &&
              is(FAIRLEAD_NO_PERMISSION, Status::no_permission) &&
              is(FAIRLEAD_NOT_SUPPORTED, Status::not_supported) &&
              is(FAIRLEAD_NO_ACKNOWLEDGE, Status::no_acknowledge) &&
              is(FAIRLEAD_BUS_ERROR, Status::bus_error) &&
              is(FAIRLEAD_UNEXPECTED_ID, Status::unexpected_id) &&
              is(FAIRLEAD_BAD_ARGUMENT, Status::bad_argument) &&
              is(FAIRLEAD_BAD_DATA, Status::bad_data) && is(FAIRLEAD_OVERRUN, Status::overrun) &&
              is(FAIRLEAD_IO_ERROR, Status::io_error) &&
              is(FAIRLEAD_DISCONNECTED, Status::disconnected) &&
              is(FAIRLEAD_NOT_ENOUGH_DATA, Status::not_enough_data) &&
              is(FAIRLEAD_ARBITRATION_LOST, Status::arbitration_lost) &&
              is(FAIRLEAD_CHECKSUM, Status::checksum) &&
              is(FAIRLEAD_ADDRESS_IN_USE, Status::address_in_use) &&
              is(FAIRLEAD_PROTOCOL_ERROR, Status::protocol_error) &&
              is(FAIRLEAD_CLOSED, Status::closed) && is(FAIRLEAD_REFUSED, Status::refused) &&
              is(FAIRLEAD_NO_VALID_DATA, Status::no_valid_data));
// the text of every code is known, and there is no code beyond them
constexpr bool has_text(int code) noexcept {
    const char *text = to_string(static_cast<Status>(code)), *none = "unknown";
    for (; *text != '\0' && *text == *none; ++text) ++none;
    return *text != *none;
}
static_assert(has_text(FAIRLEAD_STATUS_COUNT - 1) && !has_text(FAIRLEAD_STATUS_COUNT),
              "Status has codes that fairlead.h lacks");

static_assert(
    FAIRLEAD_POSITION_VALID == flag::position_valid &&
    FAIRLEAD_ORIENTATION_VALID == flag::orientation_valid &&
    FAIRLEAD_GAP_BEFORE == flag::gap_before && FAIRLEAD_POSITION_GAP == flag::position_gap &&
    FAIRLEAD_ORIENTATION_GAP == flag::orientation_gap && FAIRLEAD_CLIPPED == flag::clipped &&
    FAIRLEAD_STUCK == flag::stuck && FAIRLEAD_SETTLING == flag::settling &&
    FAIRLEAD_MAG_REJECTED == flag::mag_rejected && FAIRLEAD_REST == flag::rest &&
    FAIRLEAD_GYRO_VALID == flag::gyro_valid && FAIRLEAD_ACCEL_VALID == flag::accel_valid &&
    FAIRLEAD_MAG_VALID == flag::mag_valid && FAIRLEAD_GYRO_CLIPPED == flag::gyro_clipped &&
    FAIRLEAD_ACCEL_CLIPPED == flag::accel_clipped && FAIRLEAD_MAG_CLIPPED == flag::mag_clipped &&
    FAIRLEAD_TEMPERATURE_VALID == flag::temperature_valid && FAIRLEAD_NEW_RUN == flag::new_run &&
    FAIRLEAD_VECTOR_VALID == flag::vector_valid && FAIRLEAD_VECTOR_GAP == flag::vector_gap);

}  // namespace fairlead::c

extern "C" {

const char* fairlead_status_text(fairlead_status status) {
    const bool known = status >= 0 && status < FAIRLEAD_STATUS_COUNT;
    return known ? fairlead::to_string(static_cast<fairlead::Status>(status)) : "unknown";
}
uint32_t fairlead_version(void) { return FAIRLEAD_VERSION_NUMBER; }
}
