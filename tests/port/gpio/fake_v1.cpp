// libgpiod 1.6's functions, as far as the port calls them, over the fake line.
#include <gpiod.h>

#include <cerrno>

#include "tests/port/gpio/fake.hpp"

using fairlead::port::test::line;

namespace {
char chip, handle;

int request(int edges) {
    if (line().line_error != 0) return errno = line().line_error, -1;
    line().edges = edges;
    line().monotonic = true;  // version 1 has no choice of clock
    ++line().requests;
    return 0;
}
}  // namespace

extern "C" {
gpiod_chip* gpiod_chip_open(const char*) {
    if (line().open_error != 0) return errno = line().open_error, nullptr;
    ++line().chips;
    return reinterpret_cast<gpiod_chip*>(&chip);
}
void gpiod_chip_close(gpiod_chip*) { --line().chips; }
gpiod_line* gpiod_chip_get_line(gpiod_chip*, unsigned offset) {
    if (offset > 7) return errno = EINVAL, nullptr;
    return reinterpret_cast<gpiod_line*>(&handle);
}
int gpiod_line_request_rising_edge_events(gpiod_line*, const char*) { return request(1); }
int gpiod_line_request_falling_edge_events(gpiod_line*, const char*) { return request(2); }
int gpiod_line_request_both_edges_events(gpiod_line*, const char*) { return request(3); }
int gpiod_line_event_get_fd(gpiod_line*) { return line().fd; }
void gpiod_line_release(gpiod_line*) { --line().requests; }
int gpiod_line_event_read_multiple(gpiod_line*, gpiod_line_event* events, unsigned n) {
    if (line().read_error != 0) return errno = line().read_error, -1;
    unsigned i = 0;
    for (; i < n && !line().events.empty(); ++i) {
        const auto& e = line().events.front();
        events[i].ts = {e.t_ns / 1000000000, e.t_ns % 1000000000};
        events[i].event_type =
            e.rising ? GPIOD_LINE_EVENT_RISING_EDGE : GPIOD_LINE_EVENT_FALLING_EDGE;
        line().events.pop_front();
    }
    line().made_empty();
    return static_cast<int>(i);
}
}
