#pragma once
// One unit's registers, kept by the server's thread alone.
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "examples/gateway/feed.hpp"
#include "examples/gateway/register_map.hpp"

namespace fairlead::gateway {

class UnitTable {
  public:
    /// A unit's first run; further ones come through the feed.
    void begin(std::uint8_t id, std::string_view name, SourceKind kind, std::uint32_t epoch,
               std::int64_t stale_ns) noexcept;

    /// Moves what the source has handed over into the history and the event pages.
    void collect(UnitFeed& feed) noexcept;
    /// Writes the live, stream and health blocks as they are now.
    void refresh(const ServerState& server, std::int64_t now_ns) noexcept;

    std::uint16_t* registers() noexcept { return registers_.data(); }

  private:
    void restart(std::uint32_t epoch) noexcept;
    void append(const SpanItem& item) noexcept;
    void append(const FeedEvent& item) noexcept;

    std::array<std::uint16_t, port::registers::map_length> registers_{};
    std::array<std::uint32_t, 2> spans_{};  // so far, per channel
    std::uint32_t events_{};
    std::int64_t stale_ns_{};
    UnitState state_{};
    std::string name_;
    View view_{};
};

}  // namespace fairlead::gateway
