#include "tests/port/gpio/fake.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

namespace fairlead::port::test {

FakeLine& line() {
    static FakeLine the_line;
    if (the_line.fd < 0) the_line.fd = eventfd(0, EFD_NONBLOCK);
    return the_line;
}

void FakeLine::pull(std::int64_t t_ns, bool rising, bool dropped) {
    ++sequence;
    if (dropped) return;
    events.push_back({t_ns, rising, sequence});
    make_readable();
}

void FakeLine::make_readable() {
    const std::uint64_t one = 1;
    static_cast<void>(!write(fd, &one, sizeof one));
}

void FakeLine::made_empty() {
    std::uint64_t value = 0;
    if (events.empty()) static_cast<void>(!read(fd, &value, sizeof value));
}

}  // namespace fairlead::port::test
