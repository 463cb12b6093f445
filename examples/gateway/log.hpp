#pragma once
// One line per event on standard error: level, event, then key=value. No allocation.
//
//   LogLine{Level::info, "listening"}.add("address", "127.0.0.1:1502");
//   -> info listening address=127.0.0.1:1502
// Under systemd the line carries the journal's priority prefix; the journal adds the time.
//
// While a LogWriter exists, a line goes into a bounded queue and the writer's own thread prints it.
// So a log that nobody reads never delays the thread that speaks: what does not fit is dropped and
// counted, and the count is printed as soon as there is room. Without a LogWriter (tests, the time
// before serving) a line is written at once.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace fairlead::gateway {

enum class Level : std::uint8_t { error, warning, info, debug };

class LogLine {
  public:
    static constexpr std::size_t size_max = 512;  // bytes; a longer line is cut

    LogLine(Level level, std::string_view event) noexcept;
    ~LogLine();
    LogLine(const LogLine&) = delete;
    LogLine& operator=(const LogLine&) = delete;

    /// Text with a space, a quote or an equals sign in it is quoted; control characters become '?'.
    LogLine& add(std::string_view key, std::string_view text) noexcept;
    LogLine& add(std::string_view key, const char* text) noexcept {
        return add(key, std::string_view{text});
    }
    template <class Number, std::enable_if_t<std::is_integral_v<Number>, int> = 0>
    LogLine& add(std::string_view key, Number number) noexcept {
        return add_number(key, static_cast<std::int64_t>(number));
    }

    static void set_threshold(Level level) noexcept { threshold_ = level; }

  private:
    LogLine& add_number(std::string_view key, std::int64_t number) noexcept;
    void put(std::string_view text) noexcept;
    void put(char letter) noexcept { put(std::string_view{&letter, 1}); }

    static std::atomic<Level> threshold_;

    bool wanted_;
    std::array<char, size_max> line_{};
    std::size_t used_{};
};

/// The queue and the thread behind it. At most one exists at a time.
class LogWriter {
  public:
    static constexpr std::size_t lines_max = 256;

    /// `fd` is where the lines go; it stays the caller's.
    explicit LogWriter(int fd = 2);
    /// Lines that are still queued are written if that takes at most 0.3 s.
    ~LogWriter();
    LogWriter(const LogWriter&) = delete;
    LogWriter& operator=(const LogWriter&) = delete;

    /// Lines that were dropped since the program started.
    static std::uint32_t dropped() noexcept;
};

}  // namespace fairlead::gateway
