#pragma once
// The only error vocabulary. Three kinds of trouble, three mechanisms, never mixed:
//   programmer mistake -> FAIRLEAD_ASSERT or static_assert;  device trouble -> Status or Result<T>;
//   doubtful data -> a flag in the data (base/types.hpp).
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

enum class [[nodiscard]] Status : std::uint8_t{
    ok,
    timeout,           // the deadline passed
    end,               // no more data
    busy,              // somebody else holds the resource
    not_found,         // no such device, file or address
    no_permission,     // the system refused access
    not_supported,     // the device or the system cannot do this
    no_acknowledge,    // a device on a bus did not answer its address or a byte
    bus_error,         // the bus itself failed: arbitration, short circuit, controller fault
    unexpected_id,     // a device answered, but is not the expected part
    bad_argument,      // a value that the call cannot take
    bad_data,          // damaged content: checksum, format, range
    overrun,           // data was lost because it was not read in time
    io_error,          // anything else that the operating system reported
    disconnected,      // the peer or the device went away
    not_enough_data,   // a fit or an estimate needs more before it can answer
    arbitration_lost,  // another controller won the bus
    checksum,          // a packet error code or a checksum does not match
    address_in_use,    // a driver of the system owns this bus address
    protocol_error,    // the peer broke the protocol, for instance by an impossible length
    closed,            // the handle is not open
    refused,           // the intake refused the record; its fault counts say why
    no_valid_data,     // the record was taken, but none of its values can be used: valid bits?
};

/// A short name for messages; never null.
constexpr const char* to_string(Status s) noexcept {
    switch (s) {
        case Status::ok: return "ok";
        case Status::timeout: return "timeout";
        case Status::end: return "end";
        case Status::busy: return "busy";
        case Status::not_found: return "not found";
        case Status::no_permission: return "no permission";
        case Status::not_supported: return "not supported";
        case Status::no_acknowledge: return "no acknowledge";
        case Status::bus_error: return "bus error";
        case Status::unexpected_id: return "unexpected id";
        case Status::bad_argument: return "bad argument";
        case Status::bad_data: return "bad data";
        case Status::overrun: return "overrun";
        case Status::io_error: return "io error";
        case Status::disconnected: return "disconnected";
        case Status::not_enough_data: return "not enough data";
        case Status::arbitration_lost: return "arbitration lost";
        case Status::checksum: return "checksum";
        case Status::address_in_use: return "address in use";
        case Status::protocol_error: return "protocol error";
        case Status::closed: return "closed";
        case Status::refused: return "refused";
        case Status::no_valid_data: return "no valid data";
        default: break;
    }
    return "unknown";
}

/// A value or the reason why there is none. `if (const auto r = f()) use(*r);`
template <class T>
class [[nodiscard]] Result {
  public:
    constexpr Result(const T& value) noexcept : value_{value} {}  // NOLINT(*-explicit-*)
    constexpr Result(Status why) noexcept : status_{why} {}       // NOLINT(*-explicit-*)

    constexpr explicit operator bool() const noexcept { return status_ == Status::ok; }
    constexpr Status status() const noexcept { return status_; }
    constexpr const T& operator*() const noexcept { return value_; }
    constexpr const T* operator->() const noexcept { return &value_; }

  private:
    T value_{};
    Status status_{Status::ok};
};

}  // namespace fairlead

/// Checks what only a mistake in the program can break. On by default where assertions are cheap to
/// report; define FAIRLEAD_ASSERT before the first include to route it to the board's own handler.
#ifndef FAIRLEAD_ASSERT
#ifdef NDEBUG
#define FAIRLEAD_ASSERT(condition) static_cast<void>(0)
#else
#define FAIRLEAD_ASSERT(condition) ((condition) ? static_cast<void>(0) : __builtin_trap())
#endif
#endif
