#pragma once
// Writes data frames: head, content, check; keeps the states and the chain from frame to frame.
//
// A frame is written in portions: open(), then piece() for each piece in the order that place()
// tells, then close(). The memory of a frame is here; close() gives its bytes, good until the next
// open().
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/crc32.hpp"
#include "fairlead/wire/content.hpp"

namespace fairlead::wire {

template <std::size_t Axes, std::size_t Rotations, class Kinds>
class FrameWriter {
  public:
    using Layout = Tracks<Axes, Rotations>;
    using States = TrackStates<Axes, Rotations, Kinds>;
    using Coder = Content<code::RangeEncoder, Axes, Rotations, Kinds>;

    /// A run begins: its first frame follows this header.
    void begin_run(const StreamShape& shape, std::uint32_t digest, std::int64_t end) noexcept {
        static_cast<void>(layout_.take(shape));
        timing_ = shape.timing;
        states = {};
        header_ = digest;
        link_ = {end, 0, 0};
    }

    /// What the frame to open says of the channels; the caller fills channel, told and
    /// first of it, and sets `states` of curves that start to their first vertices.
    Coder& prepare() noexcept {
        coder_ = {};
        return coder_;
    }
    bool open(const FrameHead& head) noexcept {
        head_ = head;
        io_ = {bytes_.data() + 1, payload_max};
        return code_head(io_, head_, timing_, link_.end, link_.since) &&
               coder_.open(io_, layout_, states, head_, timing_.independent, Reading::in_step,
                           first);
    }
    bool done() const noexcept { return coder_.done(layout_); }
    const typename Coder::Place& place() const noexcept { return coder_.place(); }
    bool rotates() const noexcept { return layout_.channel[place().channel].rotates; }
    template <std::size_t N>
    bool piece(curve::Piece<N>& p) noexcept {
        return piece(p.code, p.subs, p.k.data());
    }
    /// Seals the frame. @return its size; 0: it did not fit into a frame.
    std::size_t close() noexcept {
        const std::size_t size = io_.finish();
        if (!io_.ok() || size > payload_max) return 0;
        coder_.close(layout_, states);
        bytes_[0] = static_cast<std::uint8_t>(size);
        append_crc16(bytes_.data(), 1 + size, seed(header_, link_));
        const std::size_t all = 1 + size + check_size;
        link_ = {head_.end, digest_of(bytes_.data(), all, head_.restart, header_, link_),
                 since_behind(link_.since, head_.restart)};
        return all;
    }
    const std::uint8_t* data() const noexcept { return bytes_.data(); }
    const Link& link() const noexcept { return link_; }
    const Layout& layout() const noexcept { return layout_; }
    const FrameHead& head() const noexcept { return head_; }
    /// Where the curves of the frame end, as far as it tells that.
    const Places<Axes, Rotations>& told() const noexcept { return coder_.told; }

    States states{};
    Places<Axes, Rotations> first{};

  private:
    /// One code for axes and rotations.
    [[gnu::noinline]] bool piece(std::uint8_t& code, std::uint16_t& subs,
                                 std::int32_t* k) noexcept {
        return coder_.piece(io_, layout_, states, code, subs, k) && io_.ok();
    }

    Layout layout_{};
    FrameTiming timing_{};
    std::uint32_t header_{0};  // digest of the run's header
    Link link_{};
    FrameHead head_{};
    Coder coder_{};
    code::RangeEncoder io_{};
    std::array<std::uint8_t, data_frame_max> bytes_{};
};

}  // namespace fairlead::wire
