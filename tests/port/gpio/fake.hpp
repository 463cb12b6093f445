#pragma once
// A GPIO line that a test pulls, behind either version of libgpiod's functions.
#include <cstdint>
#include <deque>

namespace fairlead::port::test {

struct FakeLine {
    struct Event {
        std::int64_t t_ns;
        bool rising;
        std::uint64_t sequence;
    };
    std::deque<Event> events;
    std::uint64_t sequence{0};
    int fd{-1};         // an eventfd, readable while events wait
    int open_error{0};  // errno of opening the chip
    int line_error{0};  // errno of requesting the line
    int read_error{0};
    int chips{0}, requests{0};  // handles that are open now
    int edges{0};               // what was asked for: 1 rising, 2 falling, 3 both
    bool monotonic{false};

    void pull(std::int64_t t_ns, bool rising, bool dropped = false);
    void make_readable();
    void made_empty();
};
FakeLine& line();

}  // namespace fairlead::port::test
