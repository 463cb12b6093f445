#include "port/linux/gpio.hpp"

#include <gpiod.h>
#include <poll.h>

#include <cerrno>
#include <utility>

#include "port/linux/clock.hpp"

// Version 2 has no macro that says so; version 1 has this one.
#ifdef GPIOD_LINE_BULK_MAX_LINES
#define FAIRLEAD_GPIOD_V1
#endif

namespace fairlead::port {

Status GpioEdges::fail() noexcept {
    errno_ = errno;
    switch (errno_) {
        case ENOENT:
        case ENODEV:
        case ENXIO: return Status::not_found;
        case EACCES:
        case EPERM: return Status::no_permission;
        case EBUSY: return Status::busy;
        case EINVAL: return Status::bad_argument;
        default: return Status::io_error;
    }
}

void GpioEdges::swap(GpioEdges& other) noexcept {
    std::swap(chip_, other.chip_);
    std::swap(request_, other.request_);
    std::swap(buffer_, other.buffer_);
    std::swap(fd_, other.fd_);
    std::swap(errno_, other.errno_);
    std::swap(queue_, other.queue_);
    std::swap(head_, other.head_);
    std::swap(size_, other.size_);
    std::swap(dropped_, other.dropped_);
    std::swap(sequence_, other.sequence_);
}

Result<Edge> GpioEdges::wait(std::int64_t deadline_ns) noexcept {
    if (request_ == nullptr) return Status::closed;
    if (size_ == 0) {
        pollfd p{fd_, POLLIN, 0};
        int ready = 0;
        do {
            const timespec left = remaining(deadline_ns);
            ready = ::ppoll(&p, 1, &left, nullptr);
        } while (ready < 0 && errno == EINTR);
        if (ready < 0) return fail();
        if (ready == 0) return Status::timeout;
        if ((p.revents & POLLIN) == 0) return Status::disconnected;  // the chip is gone
        if (const Status s = fill(); s != Status::ok) return s;
    }
    const Edge edge = queue_[head_];
    ++head_;
    --size_;
    return edge;
}

#ifdef FAIRLEAD_GPIOD_V1

Status GpioEdges::open(const char* chip_path, unsigned line, EdgeKind kind,
                       const char* consumer) noexcept {
    close();
    chip_ = gpiod_chip_open(chip_path);
    if (chip_ == nullptr) return fail();
    gpiod_line* const handle = gpiod_chip_get_line(chip_, line);
    int done = -1;
    if (handle != nullptr) {
        switch (kind) {
            case EdgeKind::rising:
                done = gpiod_line_request_rising_edge_events(handle, consumer);
                break;
            case EdgeKind::falling:
                done = gpiod_line_request_falling_edge_events(handle, consumer);
                break;
            case EdgeKind::both:
                done = gpiod_line_request_both_edges_events(handle, consumer);
                break;
        }
    }
    if (done < 0) {
        const Status s = fail();
        close();
        return s;
    }
    request_ = handle;
    fd_ = gpiod_line_event_get_fd(handle);
    return Status::ok;
}

void GpioEdges::close() noexcept {
    if (request_ != nullptr) gpiod_line_release(static_cast<gpiod_line*>(request_));
    if (chip_ != nullptr) gpiod_chip_close(chip_);
    request_ = nullptr;
    chip_ = nullptr;
    fd_ = -1;
    head_ = size_ = 0;
}

Status GpioEdges::fill() noexcept {
    std::array<gpiod_line_event, queue_max> events{};
    const int n = gpiod_line_event_read_multiple(static_cast<gpiod_line*>(request_), events.data(),
                                                 queue_max);
    if (n <= 0) return fail();
    head_ = 0;
    size_ = static_cast<std::size_t>(n);
    if (size_ == queue_max) ++dropped_;
    for (std::size_t i = 0; i < size_; ++i) {
        const gpiod_line_event& e = events[i];
        queue_[i] = {static_cast<std::int64_t>(e.ts.tv_sec) * second + e.ts.tv_nsec,
                     e.event_type == GPIOD_LINE_EVENT_RISING_EDGE};
    }
    return Status::ok;
}

#else

Status GpioEdges::open(const char* chip_path, unsigned line, EdgeKind kind,
                       const char* consumer) noexcept {
    close();
    chip_ = gpiod_chip_open(chip_path);
    if (chip_ == nullptr) return fail();
    gpiod_line_settings* const settings = gpiod_line_settings_new();
    gpiod_line_config* const lines = gpiod_line_config_new();
    gpiod_request_config* const request = gpiod_request_config_new();
    gpiod_line_request* handle = nullptr;
    if (settings != nullptr && lines != nullptr && request != nullptr) {
        const auto edge = kind == EdgeKind::rising    ? GPIOD_LINE_EDGE_RISING
                          : kind == EdgeKind::falling ? GPIOD_LINE_EDGE_FALLING
                                                      : GPIOD_LINE_EDGE_BOTH;
        gpiod_request_config_set_consumer(request, consumer);
        gpiod_request_config_set_event_buffer_size(request, 4 * queue_max);
        const bool configured =
            gpiod_line_settings_set_direction(settings, GPIOD_LINE_DIRECTION_INPUT) == 0 &&
            gpiod_line_settings_set_edge_detection(settings, edge) == 0 &&
            gpiod_line_settings_set_event_clock(settings, GPIOD_LINE_CLOCK_MONOTONIC) == 0 &&
            gpiod_line_config_add_line_settings(lines, &line, 1, settings) == 0;
        if (configured) handle = gpiod_chip_request_lines(chip_, request, lines);
    }
    if (handle != nullptr) {
        request_ = handle;
        buffer_ = gpiod_edge_event_buffer_new(queue_max);
    }
    const Status s = handle == nullptr || buffer_ == nullptr ? fail() : Status::ok;
    gpiod_line_settings_free(settings);
    gpiod_line_config_free(lines);
    gpiod_request_config_free(request);
    if (s == Status::ok)
        fd_ = gpiod_line_request_get_fd(handle);
    else
        close();
    return s;
}

void GpioEdges::close() noexcept {
    if (buffer_ != nullptr)
        gpiod_edge_event_buffer_free(static_cast<gpiod_edge_event_buffer*>(buffer_));
    if (request_ != nullptr) gpiod_line_request_release(static_cast<gpiod_line_request*>(request_));
    if (chip_ != nullptr) gpiod_chip_close(chip_);
    buffer_ = request_ = nullptr;
    chip_ = nullptr;
    fd_ = -1;
    head_ = size_ = 0;
    sequence_ = 0;
}

Status GpioEdges::fill() noexcept {
    auto* const buffer = static_cast<gpiod_edge_event_buffer*>(buffer_);
    const int n = gpiod_line_request_read_edge_events(static_cast<gpiod_line_request*>(request_),
                                                      buffer, queue_max);
    if (n <= 0) return fail();
    head_ = 0;
    size_ = static_cast<std::size_t>(n);
    for (std::size_t i = 0; i < size_; ++i) {
        gpiod_edge_event* const e = gpiod_edge_event_buffer_get_event(buffer, i);
        queue_[i] = {static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(e)),
                     gpiod_edge_event_get_event_type(e) == GPIOD_EDGE_EVENT_RISING_EDGE};
        const std::uint64_t sequence = gpiod_edge_event_get_line_seqno(e);
        if (sequence > sequence_ + 1) dropped_ += sequence - sequence_ - 1;
        sequence_ = sequence;
    }
    return Status::ok;
}

#endif

}  // namespace fairlead::port
