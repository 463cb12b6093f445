// Real GPIO edges: a child pulls a gpio-sim line, we wait for the kernel's events.
// usage: edges /dev/gpiochipN LINE PULL_FILE
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "port/linux/clock.hpp"
#include "port/linux/gpio.hpp"

using namespace fairlead;
using namespace fairlead::port;

namespace {

int failures = 0;
void check(bool good, const char* what) {
    std::printf("%s linux_vm.%s\n", good ? "ok" : "FAIL", what);
    if (!good) ++failures;
}
void pull(int fd, bool up) {
    static_cast<void>(!::pwrite(fd, up ? "pull-up" : "pull-down", up ? 7 : 9, 0));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) return 2;
    const auto line = static_cast<unsigned>(std::atoi(argv[2]));
    const int fd = ::open(argv[3], O_WRONLY | O_CLOEXEC);
    GpioEdges edges;
    check(edges.open("/dev/gpiochip99", line) == Status::not_found, "gpio-absent-chip");
    check(edges.open(argv[1], line, EdgeKind::both) == Status::ok, "gpio-open");
    GpioEdges other;
    check(other.open(argv[1], line) == Status::busy, "gpio-line-in-use");
    const std::int64_t start = now_ns();
    check(edges.wait(start + 50 * ms).status() == Status::timeout && now_ns() - start >= 50 * ms,
          "gpio-wait-ends-at-its-deadline");
    const pid_t child = ::fork();
    if (child == 0) {
        for (int i = 0; i < 5; ++i) {
            ::usleep(20000);
            pull(fd, true);
            ::usleep(20000);
            pull(fd, false);
        }
        ::_exit(0);
    }
    bool alternating = true, in_time = true;
    std::int64_t last = start;
    for (int i = 0; i < 10; ++i) {
        const auto edge = edges.wait(now_ns() + 2000 * ms);
        if (!edge) alternating = false;
        if (!edge) break;
        alternating = alternating && edge->rising == (i % 2 == 0);
        in_time = in_time && edge->t_ns > last && edge->t_ns <= now_ns();
        last = edge->t_ns;
    }
    ::waitpid(child, nullptr, 0);
    check(alternating, "gpio-edges-alternate");
    check(in_time, "gpio-times-are-monotonic-and-ours");
    for (int i = 0; i < 20; ++i) {
        pull(fd, true);
        pull(fd, false);
    }
    int kept = 0;
    while (edges.wait(now_ns() + 20 * ms)) ++kept;
    std::printf("gpio: 40 unread edges, %d kept, dropped() %llu\n", kept,
                static_cast<unsigned long long>(edges.dropped()));
    check(kept == 16 && edges.dropped() == 1, "gpio-full-queue-is-noticed");
    return failures == 0 ? 0 : 1;
}
