#include "examples/gateway/log.hpp"

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>

namespace fairlead::gateway {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::string_view, 4> names{"error", "warning", "info", "debug"};
constexpr std::array<std::string_view, 4> priorities{"<3>", "<4>", "<6>", "<7>"};  // as syslog's

/// JOURNAL_STREAM holds device and inode of the journal's socket; another standard error than that
/// one (a file, a terminal) gets no prefix.
bool under_journal() noexcept {
    static const bool there = [] {
        const char* stream = std::getenv("JOURNAL_STREAM");
        struct stat info {};
        if (stream == nullptr || fstat(STDERR_FILENO, &info) != 0) return false;
        char ours[64] = {};
        std::snprintf(ours, sizeof ours, "%llu:%llu", static_cast<unsigned long long>(info.st_dev),
                      static_cast<unsigned long long>(info.st_ino));
        return std::strcmp(stream, ours) == 0;
    }();
    return there;
}

/// Never destroyed: a thread that hangs in a write may outlive main().
struct Queue {
    std::mutex mutex;
    std::condition_variable changed;
    std::array<std::array<char, LogLine::size_max>, LogWriter::lines_max> lines;
    std::array<std::uint16_t, LogWriter::lines_max> sizes;
    std::size_t first{};
    std::size_t count{};
    bool active{};   // a writer exists
    bool running{};  // its thread has not ended
    std::atomic<std::uint32_t> dropped{0};

    /// False: no writer exists.
    bool push(const char* line, std::size_t size) noexcept {
        const std::lock_guard<std::mutex> lock{mutex};
        if (!active) return false;
        if (count == LogWriter::lines_max) {
            ++dropped;
            return true;
        }
        const std::size_t place = (first + count) % LogWriter::lines_max;
        std::copy_n(line, size, lines[place].begin());
        sizes[place] = static_cast<std::uint16_t>(size);
        ++count;
        changed.notify_all();
        return true;
    }
};
Queue& queue() noexcept {
    static Queue& one = *new Queue;
    return one;
}

/// Waits until fd takes bytes. False: the writer ends, or nobody will ever read.
bool wait_until_writable(Queue& q, int fd) noexcept {
    for (;;) {
        pollfd out{fd, POLLOUT, 0};
        const int ready = ::poll(&out, 1, 50);
        if (ready > 0) return (out.revents & POLLOUT) != 0 && (out.revents & POLLERR) == 0;
        const std::lock_guard<std::mutex> lock{q.mutex};
        if (!q.active) return false;
    }
}

/// One write at a time, and only into a pipe, terminal or file that says that it has room. False:
/// the line is lost.
bool write_line(Queue& q, int fd, const char* line, std::size_t size) noexcept {
    for (std::size_t from = 0; from < size;) {
        if (!wait_until_writable(q, fd)) return false;
        const ssize_t put = ::write(fd, line + from, size - from);
        if (put < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (put <= 0) return false;
        from += static_cast<std::size_t>(put);
    }
    return true;
}

void tell_dropped(Queue& q, int fd, std::uint32_t& told) noexcept {
    const std::uint32_t dropped = q.dropped;
    if (dropped == told) return;
    char line[96] = {};
    const int size = std::snprintf(line, sizeof line, "%swarning log lines dropped count=%u\n",
                                   under_journal() ? "<4>" : "", dropped - told);
    if (write_line(q, fd, line, static_cast<std::size_t>(size))) told = dropped;
}

void write_lines(int fd) noexcept {
    Queue& q = queue();
    std::uint32_t told = q.dropped;
    std::array<char, LogLine::size_max> line{};
    for (;;) {
        std::size_t size = 0;
        {
            std::unique_lock<std::mutex> lock{q.mutex};
            q.changed.wait(lock, [&] { return q.count > 0 || !q.active; });
            if (q.count == 0) break;
            size = q.sizes[q.first];
            std::copy_n(q.lines[q.first].begin(), size, line.begin());
            q.first = (q.first + 1) % LogWriter::lines_max;
            --q.count;
        }
        if (!write_line(q, fd, line.data(), size)) ++q.dropped;
        tell_dropped(q, fd, told);
    }
    const std::lock_guard<std::mutex> lock{q.mutex};
    q.running = false;
    q.changed.notify_all();
}

}  // namespace

std::atomic<Level> LogLine::threshold_{Level::info};

LogLine::LogLine(Level level, std::string_view event) noexcept : wanted_{level <= threshold_} {
    if (!wanted_) return;
    const auto i = static_cast<std::size_t>(level);
    if (under_journal()) put(priorities[i]);
    put(names[i]);
    put(' ');
    put(event);
}

LogLine::~LogLine() {
    if (!wanted_) return;
    line_[used_++] = '\n';
    if (queue().push(line_.data(), used_)) return;
    if (::write(STDERR_FILENO, line_.data(), used_) < 0) return;  // nobody is left to be told
}

LogLine& LogLine::add(std::string_view key, std::string_view text) noexcept {
    if (!wanted_) return *this;
    put(' ');
    put(key);
    put('=');
    const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
        const auto letter = static_cast<unsigned char>(c);
        return letter > ' ' && letter != 0x7F && c != '"' && c != '=' && c != '\\';
    });
    if (plain) {
        put(text);
        return *this;
    }
    put('"');
    for (const char c : text) {
        const auto letter = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') put('\\');
        put(letter < ' ' || letter == 0x7F ? '?' : c);
    }
    put('"');
    return *this;
}

LogLine& LogLine::add_number(std::string_view key, std::int64_t number) noexcept {
    std::array<char, 24> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return add(key, std::string_view{digits.data(), static_cast<std::size_t>(end - digits.data())});
}

void LogLine::put(std::string_view text) noexcept {
    const std::size_t n = std::min(text.size(), line_.size() - 1 - used_);
    std::copy_n(text.begin(), n, line_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ += n;
}

LogWriter::LogWriter(int fd) {
    Queue& q = queue();
    {
        const std::lock_guard<std::mutex> lock{q.mutex};
        q.active = q.running = true;
        q.first = q.count = 0;
    }
    std::thread{write_lines, fd}.detach();
}

LogWriter::~LogWriter() {
    Queue& q = queue();
    std::unique_lock<std::mutex> lock{q.mutex};
    // first what is queued, then the end of the thread
    q.changed.wait_for(lock, 200ms, [&] { return q.count == 0; });
    q.active = false;
    q.changed.notify_all();
    q.changed.wait_for(lock, 100ms, [&] { return !q.running; });
}

std::uint32_t LogWriter::dropped() noexcept { return queue().dropped; }

}  // namespace fairlead::gateway
