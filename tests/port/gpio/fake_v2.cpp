// libgpiod 2's functions, as far as the port calls them, over the fake line.
#include <gpiod.h>

#include <cerrno>
#include <vector>

#include "tests/port/gpio/fake.hpp"

using fairlead::port::test::FakeLine;
using fairlead::port::test::line;

struct gpiod_edge_event {
    FakeLine::Event event;
};
struct gpiod_edge_event_buffer {
    std::vector<gpiod_edge_event> events;
    std::size_t capacity;
};
struct gpiod_line_settings {
    int edges{0};
    bool input{false}, monotonic{false};
};
struct gpiod_line_config {
    gpiod_line_settings settings;
    unsigned offset{0};
};
struct gpiod_request_config {
    std::size_t buffer{0};
};

namespace {
char chip, handle;
}

extern "C" {
gpiod_chip* gpiod_chip_open(const char*) {
    if (line().open_error != 0) return errno = line().open_error, nullptr;
    ++line().chips;
    return reinterpret_cast<gpiod_chip*>(&chip);
}
void gpiod_chip_close(gpiod_chip*) { --line().chips; }
gpiod_line_request* gpiod_chip_request_lines(gpiod_chip*, gpiod_request_config*,
                                             gpiod_line_config* lines) {
    if (lines->offset > 7 || !lines->settings.input) return errno = EINVAL, nullptr;
    if (line().line_error != 0) return errno = line().line_error, nullptr;
    line().edges = lines->settings.edges;
    line().monotonic = lines->settings.monotonic;
    ++line().requests;
    return reinterpret_cast<gpiod_line_request*>(&handle);
}
gpiod_line_settings* gpiod_line_settings_new() { return new gpiod_line_settings; }
void gpiod_line_settings_free(gpiod_line_settings* s) { delete s; }
int gpiod_line_settings_set_direction(gpiod_line_settings* s, gpiod_line_direction d) {
    s->input = d == GPIOD_LINE_DIRECTION_INPUT;
    return 0;
}
int gpiod_line_settings_set_edge_detection(gpiod_line_settings* s, gpiod_line_edge e) {
    s->edges = e == GPIOD_LINE_EDGE_RISING ? 1 : e == GPIOD_LINE_EDGE_FALLING ? 2 : 3;
    return 0;
}
int gpiod_line_settings_set_event_clock(gpiod_line_settings* s, gpiod_line_clock c) {
    s->monotonic = c == GPIOD_LINE_CLOCK_MONOTONIC;
    return 0;
}
gpiod_line_config* gpiod_line_config_new() { return new gpiod_line_config; }
void gpiod_line_config_free(gpiod_line_config* c) { delete c; }
int gpiod_line_config_add_line_settings(gpiod_line_config* c, const unsigned* offsets,
                                        std::size_t n, gpiod_line_settings* s) {
    if (n != 1) return -1;
    c->settings = *s;
    c->offset = offsets[0];
    return 0;
}
gpiod_request_config* gpiod_request_config_new() { return new gpiod_request_config; }
void gpiod_request_config_free(gpiod_request_config* c) { delete c; }
void gpiod_request_config_set_consumer(gpiod_request_config*, const char*) {}
void gpiod_request_config_set_event_buffer_size(gpiod_request_config* c, std::size_t n) {
    c->buffer = n;
}
void gpiod_line_request_release(gpiod_line_request*) { --line().requests; }
int gpiod_line_request_get_fd(gpiod_line_request*) { return line().fd; }
gpiod_edge_event_buffer* gpiod_edge_event_buffer_new(std::size_t capacity) {
    return new gpiod_edge_event_buffer{{}, capacity};
}
void gpiod_edge_event_buffer_free(gpiod_edge_event_buffer* b) { delete b; }
int gpiod_line_request_read_edge_events(gpiod_line_request*, gpiod_edge_event_buffer* b,
                                        std::size_t n) {
    if (line().read_error != 0) return errno = line().read_error, -1;
    b->events.clear();
    while (b->events.size() < n && b->events.size() < b->capacity && !line().events.empty()) {
        b->events.push_back({line().events.front()});
        line().events.pop_front();
    }
    line().made_empty();
    return static_cast<int>(b->events.size());
}
gpiod_edge_event* gpiod_edge_event_buffer_get_event(gpiod_edge_event_buffer* b, unsigned long i) {
    return &b->events[i];
}
gpiod_edge_event_type gpiod_edge_event_get_event_type(gpiod_edge_event* e) {
    return e->event.rising ? GPIOD_EDGE_EVENT_RISING_EDGE : GPIOD_EDGE_EVENT_FALLING_EDGE;
}
std::uint64_t gpiod_edge_event_get_timestamp_ns(gpiod_edge_event* e) {
    return static_cast<std::uint64_t>(e->event.t_ns);
}
unsigned long gpiod_edge_event_get_line_seqno(gpiod_edge_event* e) { return e->event.sequence; }
}
