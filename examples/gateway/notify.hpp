#pragma once
// What systemd is told (Type=notify-reload): one datagram to the socket that NOTIFY_SOCKET names.
//
// The protocol is stable and meant to be spoken without a library (sd_notify(3), "Notes"). The
// library's own function waits while the receiver's queue is full; this one never waits.
#include <cstdint>

namespace fairlead::gateway {

/// Without NOTIFY_SOCKET, or when nobody takes it: nothing happens.
void notify(const char* state) noexcept;
/// RELOADING=1 with the time that systemd wants beside it.
void notify_reloading(std::int64_t monotonic_ns) noexcept;
/// How often the watchdog must be fed, from WATCHDOG_USEC; 0: there is none for this process.
std::int64_t watchdog_period_ns() noexcept;

}  // namespace fairlead::gateway
