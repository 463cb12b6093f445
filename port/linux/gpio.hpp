#pragma once
// Edges of a GPIO line with the kernel's own time stamps: data-ready lines, triggers, buttons.
//
// libgpiod 1.6 and 2.x, chosen when compiled by the header that is found. Every wait has a
// deadline: an edge can be lost for ever (the kernel keeps 16 a line under version 1 and drops the
// newest without a word; version 2 tells by sequence numbers), so no caller may depend on one.
// Times are CLOCK_MONOTONIC; kernels before 5.7 stamp version 1's events with CLOCK_REALTIME, which
// the sampling loop notices (sampler.hpp). libgpiod allocates in open(), nothing does after.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"

struct gpiod_chip;

namespace fairlead::port {

struct Edge {
    std::int64_t t_ns{};
    bool rising{};
};

enum class EdgeKind : std::uint8_t { rising, falling, both };

class GpioEdges {
  public:
    static constexpr std::size_t queue_max = 16;  // what one read takes over from the kernel

    GpioEdges() noexcept = default;
    GpioEdges(GpioEdges&& other) noexcept { swap(other); }
    GpioEdges& operator=(GpioEdges&& other) noexcept {
        swap(other);
        return *this;
    }
    GpioEdges(const GpioEdges&) = delete;
    GpioEdges& operator=(const GpioEdges&) = delete;
    ~GpioEdges() { close(); }

    Status open(const char* chip_path, unsigned line, EdgeKind kind = EdgeKind::rising,
                const char* consumer = "fairlead") noexcept;
    void close() noexcept;
    bool is_open() const noexcept { return request_ != nullptr; }
    int last_errno() const noexcept { return errno_; }

    /// The next edge, or timeout at the deadline. Edges that have already come are never delayed.
    Result<Edge> wait(std::int64_t deadline_ns) noexcept;
    /// Edges that the kernel dropped: exact under version 2; under version 1 the number of times
    /// that its queue was found full, since it tells no more.
    std::uint64_t dropped() const noexcept { return dropped_; }

  private:
    Status fail() noexcept;
    Status fill() noexcept;
    void swap(GpioEdges& other) noexcept;

    gpiod_chip* chip_{};
    void* request_{};  // gpiod_line (1), gpiod_line_request (2)
    void* buffer_{};   // gpiod_edge_event_buffer (2)
    int fd_{-1};
    int errno_{0};
    std::array<Edge, queue_max> queue_{};
    std::size_t head_{0};
    std::size_t size_{0};
    std::uint64_t dropped_{0};
    std::uint64_t sequence_{0};
};

/// Rising edges as bare times, the form that the sampling loop takes.
class DataReady {
  public:
    Status open(const char* chip_path, unsigned line) noexcept {
        return edges_.open(chip_path, line, EdgeKind::rising);
    }
    void close() noexcept { edges_.close(); }
    Result<std::int64_t> wait(std::int64_t deadline_ns) noexcept {
        const auto edge = edges_.wait(deadline_ns);
        if (!edge) return edge.status();
        return edge->t_ns;
    }
    std::uint64_t dropped() const noexcept { return edges_.dropped(); }
    int last_errno() const noexcept { return edges_.last_errno(); }

  private:
    GpioEdges edges_;
};

}  // namespace fairlead::port
