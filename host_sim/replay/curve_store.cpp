#include "host_sim/replay/curve_store.hpp"

#include <algorithm>
#include <limits>

#include "fairlead/math/quat.hpp"

namespace fairlead::sim {
namespace {

constexpr std::size_t head_size = 64;  // bytes of the start that are kept: a header's version

/// Sum of something over the tracks of a channel.
template <class Count>
std::size_t total(const std::vector<CurveTrack>& tracks, Count count) {
    std::size_t sum = 0;
    for (const CurveTrack& track : tracks) sum += count(track);
    return sum;
}

std::uint8_t byte_at(std::string_view bytes, std::size_t i) {
    return static_cast<std::uint8_t>(bytes[i]);
}

/// Streams of the versions before 4 begin with a restart frame; its third byte is 0xF1 or 0xF2.
bool begins_as_earlier(std::string_view bytes) {
    return bytes.size() > 2 && byte_at(bytes, 0) >= 0x80 && byte_at(bytes, 0) <= 0xDF &&
           (byte_at(bytes, 2) == 0xF1 || byte_at(bytes, 2) == 0xF2);
}

}  // namespace

CurvePoint CurvePoint::of(const Pose& pose) {
    const auto wide = [](float x) { return static_cast<double>(x); };
    const Vec3& p = pose.p_w_m;
    const Quat& q = pose.q_wb;
    return {{wide(p.x), wide(p.y), wide(p.z)},
            {wide(q.w), wide(q.x), wide(q.y), wide(q.z)},
            pose.flags};
}

Pose CurvePoint::rounded(std::int64_t t_ns) const {
    const auto narrow = [](double x) { return static_cast<float>(x); };
    Pose pose;
    pose.t_ns = t_ns;
    pose.flags = flags;
    pose.p_w_m = {narrow(p_m.x), narrow(p_m.y), narrow(p_m.z)};
    pose.q_wb = {narrow(q.w), narrow(q.x), narrow(q.y), narrow(q.z)};
    return pose;
}

// ---- tracks

void CurveTrack::add(const wire::BasicCurvePiece<true>& piece, const curve::Grid& grid) {
    const bool ended_before = piece.ends && !piece.begins && piece.start == piece.end;
    if (ended_before) return;  // says that the curve is over, and holds nothing
    pieces_.push_back({piece, grid.time_ns(piece.start), grid.time_ns(piece.end),
                       static_cast<double>(grid.tick_ns())});
}

const CurveTrack::Piece* CurveTrack::at(std::int64_t t_ns) const {
    const auto ends_before = [](const Piece& p, std::int64_t t) { return p.end_ns < t; };
    const auto found = std::lower_bound(pieces_.begin(), pieces_.end(), t_ns, ends_before);
    if (found == pieces_.end()) return nullptr;
    return wire::holds_at(found->of.begins, found->start_ns, found->end_ns, t_ns) ? &*found
                                                                                  : nullptr;
}

std::size_t CurveTrack::curves() const {
    return static_cast<std::size_t>(
        std::count_if(pieces_.begin(), pieces_.end(), [](const Piece& p) { return p.of.begins; }));
}

std::size_t CurveTrack::breaks() const {
    return static_cast<std::size_t>(
        std::count_if(pieces_.begin(), pieces_.end(),
                      [](const Piece& p) { return p.of.jumps && p.of.start != p.of.end; }));
}

// ---- channels

bool StoredChannel::empty() const { return pieces() == 0; }

bool StoredChannel::covers(std::int64_t t_ns) const {
    return !tracks.empty() && std::all_of(tracks.begin(), tracks.end(), [t_ns](const auto& track) {
        return track.at(t_ns) != nullptr;
    });
}

std::vector<double> StoredChannel::value(std::int64_t t_ns) const {
    std::vector<double> out;
    for (const CurveTrack& track : tracks) {
        const CurveTrack::Piece& piece = *track.at(t_ns);
        out.push_back(piece.of.steps_at(piece.ticks(t_ns)) * piece.of.scale.step());
    }
    return out;
}

BasicQuat<double> StoredChannel::rotation(std::int64_t t_ns) const {
    const CurveTrack::Piece& piece = *tracks.at(0).at(t_ns);
    return normalised(wire::rotation_at(piece.of, piece.ticks(t_ns)));
}

std::size_t StoredChannel::curves() const { return tracks.empty() ? 0 : tracks[0].curves(); }
std::size_t StoredChannel::breaks() const {
    return total(tracks, [](const CurveTrack& t) { return t.breaks(); });
}
std::size_t StoredChannel::pieces() const {
    return total(tracks, [](const CurveTrack& t) { return t.pieces().size(); });
}

std::size_t StoredChannel::knots() const {
    if (tracks.empty()) return 0;
    const std::size_t sum = total(tracks, [this](const CurveTrack& t) {
        return t.pieces().size() - t.curves() + (order - 1) * t.breaks();
    });
    return (sum + tracks.size() - 1) / tracks.size();
}

std::int64_t StoredChannel::begin_ns() const {
    std::int64_t t = std::numeric_limits<std::int64_t>::max();
    for (const CurveTrack& track : tracks)
        if (!track.pieces().empty()) t = std::min(t, track.pieces().front().start_ns);
    return t;
}

std::int64_t StoredChannel::end_ns() const {
    std::int64_t t = std::numeric_limits<std::int64_t>::min();
    for (const CurveTrack& track : tracks)
        if (!track.pieces().empty()) t = std::max(t, track.pieces().back().end_ns);
    return t;
}

// ---- runs

const StoredChannel& CurveRun::position() const {
    static const StoredChannel none{};
    for (const StoredChannel& channel : channels)
        if (!channel.rotates && channel.tracks.size() == 3) return channel;
    return none;
}

const StoredChannel& CurveRun::orientation() const {
    static const StoredChannel none{};
    for (const StoredChannel& channel : channels)
        if (channel.rotates) return channel;
    return none;
}

CurvePoint CurveRun::point_at(std::int64_t t_ns) const {
    CurvePoint point;
    if (const StoredChannel& channel = position(); channel.covers(t_ns)) {
        const std::vector<double> p = channel.value(t_ns);
        point.p_m = {p[0], p[1], p[2]};
        point.flags |= flag::position_valid;
    }
    if (const StoredChannel& channel = orientation(); channel.covers(t_ns)) {
        point.q = channel.rotation(t_ns);
        point.flags |= flag::orientation_valid;
    }
    return point;
}

Pose CurveRun::at(std::int64_t t_ns) const { return point_at(t_ns).rounded(t_ns); }

bool CurveRun::empty() const {
    return std::all_of(channels.begin(), channels.end(), [](const auto& c) { return c.empty(); });
}

std::int64_t CurveRun::begin_ns() const {
    std::int64_t t = std::numeric_limits<std::int64_t>::max();
    for (const StoredChannel& channel : channels) t = std::min(t, channel.begin_ns());
    return t;
}

std::int64_t CurveRun::end_ns() const {
    std::int64_t t = std::numeric_limits<std::int64_t>::min();
    for (const StoredChannel& channel : channels) t = std::max(t, channel.end_ns());
    return t;
}

// ---- the bytes as frames

StreamBytes stream_bytes(std::string_view stream) {
    StreamBytes out;
    out.earlier_format = begins_as_earlier(stream);
    std::size_t at = 0;
    while (at < stream.size()) {
        const std::uint8_t head = byte_at(stream, at);
        const bool header = head == 0xF8, event = head == 0xF9;
        const bool data = head >= 1 && head <= wire::payload_max;
        if (!(header || event || data) || (!data && at + 1 >= stream.size())) break;
        const std::size_t size =
            data ? 1u + head + wire::check_size : 2u + byte_at(stream, at + 1) + wire::crc_size;
        if (at + size > stream.size()) break;
        if (header && !out.version) out.version = byte_at(stream, at + 2);
        (header ? out.headers : event ? out.events : out.data) += size;
        out.frames += data;
        at += size;
    }
    out.counted = at;
    out.whole = at == stream.size();
    return out;
}

// ---- the store

void CurveStore::begin_run() {
    if (!runs_.back().channels.empty()) runs_.emplace_back();
    CurveRun& run = runs_.back();
    run.index = decoder_.run_index();
    run.number = decoder_.run();
    run.tick_ns = decoder_.grid().tick_ns();
    const Decoder::Layout& layout = decoder_.layout();
    for (std::size_t c = 0; c < layout.channels; ++c) {
        const wire::TrackRange& range = layout.channel[c];
        StoredChannel channel;
        channel.rotates = range.rotates;
        channel.order = range.kind == curve::Cubics::id ? 4 : 3;
        double step = 0;  // the largest: axes may have their own
        for (std::size_t i = 0; i < range.count; ++i)
            step = std::max(step, layout.scale_of(range, i).step());
        channel.tolerance = static_cast<double>(decoder_.tolerance_steps(c)) * step;
        channel.tracks.resize(range.count);
        run.channels.push_back(std::move(channel));
    }
}

void CurveStore::take_frame() {
    std::size_t before = decoder_.payload_read();
    const auto keep = [&](const Decoder::Piece& piece) {
        if (run_begins_) begin_run();
        run_begins_ = false;
        StoredChannel& channel = runs_.back().channels.at(piece.channel);
        channel.tracks.at(piece.axis).add(piece, decoder_.grid());
        const std::size_t now = decoder_.payload_read();
        if (piece_bytes_.size() <= piece.channel) piece_bytes_.resize(piece.channel + 1u);
        piece_bytes_[piece.channel] += now - before;
        before = now;
    };
    follow_(
        decoder_, [this](bool) { run_begins_ = true; }, keep);
    Event event;
    while (decoder_.next_event(event)) events_.push_back(event);
}

std::size_t CurveStore::piece_bytes(std::size_t channel) const {
    return channel < piece_bytes_.size() ? piece_bytes_[channel] : 0;
}

void CurveStore::note_damage() {
    if (damaged_at_) return;
    const auto& c = decoder_.counters();
    const bool unread = finished_ && frame_counters().good_bytes < byte_count_;
    if (frame_counters().losses > 0 || c.nonsense > 0 || c.refused > 0 || unread)
        damaged_at_ = byte_count_;
}

void CurveStore::push(std::string_view bytes) {
    if (head_.size() < head_size) head_ += bytes.substr(0, head_size - head_.size());
    for (const char byte : bytes) {
        ++byte_count_;
        if (decoder_.push(static_cast<std::uint8_t>(byte))) take_frame();
        note_damage();
    }
}

void CurveStore::finish() {
    while (decoder_.finish()) take_frame();
    finished_ = true;
    note_damage();
}

const CurveRun* CurveStore::run(std::uint32_t index) const {
    for (const CurveRun& run : runs_)
        if (run.index == index && !run.channels.empty()) return &run;
    return nullptr;
}

CurvePoint CurveStore::point_at(std::uint32_t run_index, std::int64_t t_ns) const {
    const CurveRun* const of = run(run_index);
    return of != nullptr ? of->point_at(t_ns) : CurvePoint{};
}

Pose CurveStore::at(std::int64_t t_ns) const {
    for (auto run = runs_.rbegin(); run != runs_.rend(); ++run)
        if (const Pose pose = run->at(t_ns); pose.flags != 0) return pose;
    Pose pose;
    pose.t_ns = t_ns;
    return pose;
}

std::string CurveStore::why_empty() const {
    const StreamBytes start = stream_bytes(head_);
    if (start.earlier_format)
        return "a stream of an earlier format (versions 1 to 3); this is version " +
               std::to_string(wire::stream_version) +
               ". fairlead-sim decode --earlier reads it if it is of version 3";
    if (decoder_.refused() == Decoder::Refused::version)
        return "a stream of format version " +
               (start.version ? std::to_string(*start.version) : std::string{"unknown"}) +
               "; this program reads version " + std::to_string(wire::stream_version);
    if (decoder_.refused() == Decoder::Refused::shape)
        return "a stream of more channels than this program holds";
    return "byte 0: no frame of a fairlead stream";
}

std::string CurveStore::damage() const {
    if (empty()) return why_empty();
    if (!damaged_at_) return {};
    const auto& frames = frame_counters();
    return "damage noticed at byte " + std::to_string(*damaged_at_) + ": " +
           std::to_string(frames.losses) + " place(s), " +
           std::to_string(byte_count_ - std::min<std::size_t>(byte_count_, frames.good_bytes)) +
           " bytes passed over, " + std::to_string(counters().nonsense) + " frame(s) of nonsense";
}

}  // namespace fairlead::sim
