#include "host_sim/study/baselines/earlier/curve_store.hpp"

namespace fairlead::sim::earlier {
namespace {

/// Takes what a frame says of one channel; where its clock has started anew, into a new run.
template <class List, class Link>
void follow(std::vector<CurveRun>& runs, List CurveRun::*list, const Link& link,
            const Decoder::Update& update, std::uint32_t tick_ns) {
    if (update.piece) {
        const typename List::Piece piece{link.curve,
                                         link.scale,
                                         tick_ns,
                                         update.begins,
                                         update.breaks,
                                         !update.begins && !update.rejoined,
                                         0,
                                         0,
                                         0};
        if ((runs.back().*list).starts_anew(piece)) runs.emplace_back();
        (runs.back().*list).add(piece);
    }
    if (!update.piece || (update.rejoined && link.cover_ticks > 0))
        (runs.back().*list).cover(link.cover_ticks);
}

}  // namespace

Pose CurveRun::at(std::int64_t t_ns) const {
    Pose pose;
    pose.t_ns = t_ns;
    if (const auto p = position.at(t_ns)) {
        pose.p_w_m = {(*p)[0], (*p)[1], (*p)[2]};
        pose.flags |= flag::position_valid;
    }
    if (const auto q = orientation.at(t_ns)) {
        pose.q_wb = *q;
        pose.flags |= flag::orientation_valid;
    }
    return pose;
}

std::int64_t CurveRun::begin_ns() const {
    std::int64_t t = INT64_MAX;
    if (!position.pieces().empty()) t = std::min(t, position.pieces().front().t0_ns());
    if (!orientation.pieces().empty()) t = std::min(t, orientation.pieces().front().t0_ns());
    return t;
}

std::int64_t CurveRun::end_ns() const {
    std::int64_t t = INT64_MIN;
    if (!position.pieces().empty()) t = std::max(t, position.pieces().back().end_ns());
    if (!orientation.pieces().empty()) t = std::max(t, orientation.pieces().back().end_ns());
    return t;
}

void CurveStore::take_frame() {
    Decoder::Update update;
    while (decoder_.next(update)) {
        if (update.channel == Decoder::Channel::position)
            follow(runs_, &CurveRun::position, decoder_.position(), update, decoder_.tick_ns());
        else
            follow(runs_, &CurveRun::orientation, decoder_.orientation(), update,
                   decoder_.tick_ns());
    }
    Event event;
    while (decoder_.next_event(event)) events_.push_back(event);
}

void CurveStore::note_damage() {
    if (!damaged_at_ && (counters().damaged > 0 || counters().skipped_bytes > 0))
        damaged_at_ = byte_count_;
}

void CurveStore::push(std::string_view bytes) {
    for (const char byte : bytes) {
        ++byte_count_;
        if (decoder_.push(static_cast<std::uint8_t>(byte))) take_frame();
        note_damage();
    }
}

void CurveStore::finish() {
    while (decoder_.finish()) take_frame();
    note_damage();
}

Pose CurveStore::at(std::int64_t t_ns) const {
    for (auto run = runs_.rbegin(); run != runs_.rend(); ++run)
        if (const Pose pose = run->at(t_ns); pose.flags != 0) return pose;
    Pose pose;
    pose.t_ns = t_ns;
    return pose;
}

std::string CurveStore::damage() const {
    const auto& c = counters();
    if (empty()) return "byte 0: no frame of a fairlead stream";
    if (!damaged_at_) return {};
    return "damage noticed at byte " + std::to_string(*damaged_at_) + ": " +
           std::to_string(c.damaged) + " place(s), " + std::to_string(c.skipped_bytes) +
           " bytes passed over, " + std::to_string(c.lost_frames) + " frame(s) lost";
}

}  // namespace fairlead::sim::earlier
