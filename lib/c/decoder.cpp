// Decoder, pieces of curves and live window, for C.
#include "lib/c/objects.hpp"

using namespace fairlead::c;
namespace wire = fairlead::wire;

namespace {

using Refused = BoardDecoder::Refused;
static_assert(static_cast<int>(Refused::nothing) == FAIRLEAD_HEADER_GOOD &&
              static_cast<int>(Refused::version) == FAIRLEAD_HEADER_VERSION &&
              static_cast<int>(Refused::content) == FAIRLEAD_HEADER_CONTENT &&
              static_cast<int>(Refused::shape) == FAIRLEAD_HEADER_SHAPE &&
              static_cast<int>(Refused::foreign) == FAIRLEAD_HEADER_FOREIGN);
static_assert(sizeof(HeldPiece) == sizeof(fairlead_piece::opaque) &&
              std::is_trivially_copyable_v<HeldPiece>);

fairlead_axis_motion motion_of(const wire::AxisMotion<float>& motion) noexcept {
    return {motion.value, motion.velocity, motion.acceleration};
}
fairlead_rotation_motion motion_of(const wire::OrientationMotion<float>& turning) noexcept {
    fairlead_rotation_motion out{};
    ToC copy;
    copy(out.q_wb, turning.q_wb);
    copy(out.velocity_rad_s, turning.rates.velocity);
    copy(out.acceleration_rad_s2, turning.rates.acceleration);
    return out;
}
fairlead_position_motion motion_of(const BoardLive::Motion& motion) noexcept {
    fairlead_position_motion out{};
    ToC copy;
    copy(out.p_w_m, motion.p_w_m);
    copy(out.velocity_m_s, motion.velocity_m_s);
    copy(out.acceleration_m_s2, motion.acceleration_m_s2);
    return out;
}

/// The piece for C++, where it is of this kind and holds at t_ns.
fairlead_status take(const fairlead_piece* piece, bool rotates, std::int64_t t_ns, const void* out,
                     HeldPiece& held) noexcept {
    if (piece == nullptr || out == nullptr) return FAIRLEAD_BAD_ARGUMENT;
    std::memcpy(static_cast<void*>(&held), piece->opaque, sizeof held);
    if (held.grid.sub_ns == 0) return FAIRLEAD_CLOSED;  // all zeros: no piece was written there
    if (held.piece.rotates != rotates) return FAIRLEAD_BAD_ARGUMENT;
    return wire::holds_at(held.piece, held.grid, t_ns) ? FAIRLEAD_OK : FAIRLEAD_NOT_FOUND;
}

template <class AnyDecoder>
void count(const AnyDecoder& decoder, fairlead_decoder_statistics& out) noexcept {
    const auto& headers = decoder.counters();
    const auto& frames = decoder.frame_counters();
    out = {};
    out.headers = headers.headers;
    out.refused_headers = headers.refused;
    out.frames = frames.frames;
    out.losses = frames.losses;
    out.nonsense = headers.nonsense;
    out.good_bytes = frames.good_bytes;
    out.events = decoder.event_counters().events;
    out.lost_events = decoder.event_counters().lost;
    out.last_refusal = static_cast<std::int32_t>(decoder.refused());
    out.run_index = decoder.run_index();
    out.stream_id = decoder.stream_id();
    out.in_step = decoder.in_step();
}

template <class ACell, class Opaque>
bool next_event(Opaque* object, fairlead_event* event) noexcept {
    auto* const cell = find<ACell>(object);
    fairlead::Event out;
    if (cell == nullptr || event == nullptr || !cell->value.next_event(out)) return false;
    to_c(*event, out);
    return true;
}

/// Answers a question to the live window.
template <class Out, class Ask>
fairlead_status answer(const fairlead_live* live, Out* out, Ask&& ask) noexcept {
    const auto* const cell = find<LiveCell>(live);
    if (cell == nullptr) return missing(live);
    if (out == nullptr) return FAIRLEAD_BAD_ARGUMENT;
    const auto found = ask(cell->value);
    if (!found) return FAIRLEAD_NOT_FOUND;
    if constexpr (std::is_same_v<Out, std::int64_t>)
        *out = *found;
    else
        *out = motion_of(*found);
    return FAIRLEAD_OK;
}

}  // namespace

extern "C" {

fairlead_status fairlead_piece_axis(const fairlead_piece* piece, int64_t t_ns,
                                    fairlead_axis_motion* motion) {
    HeldPiece held;
    const fairlead_status status = take(piece, false, t_ns, motion, held);
    if (status != FAIRLEAD_OK) return status;
    *motion = motion_of(wire::axis_motion(held.piece, held.grid, t_ns));
    return FAIRLEAD_OK;
}
fairlead_status fairlead_piece_rotation(const fairlead_piece* piece, int64_t t_ns,
                                        fairlead_rotation_motion* motion) {
    HeldPiece held;
    const fairlead_status status = take(piece, true, t_ns, motion, held);
    if (status != FAIRLEAD_OK) return status;
    *motion = motion_of(wire::orientation_motion(held.piece, held.grid, t_ns));
    return FAIRLEAD_OK;
}

// ---- decoder
fairlead_status fairlead_decoder_init(fairlead_decoder* decoder, size_t size, int32_t stream_id) {
    if (!fits(decoder, size) || stream_id < FAIRLEAD_ANY_STREAM || stream_id > 0xffff)
        return FAIRLEAD_BAD_ARGUMENT;
    if (stream_id == FAIRLEAD_ANY_STREAM)
        make<DecoderCell>(decoder);
    else
        make<DecoderCell>(decoder, static_cast<std::uint16_t>(stream_id));
    return FAIRLEAD_OK;
}
bool fairlead_decoder_push(fairlead_decoder* decoder, uint8_t byte) {
    auto* const cell = find<DecoderCell>(decoder);
    return cell != nullptr && cell->value.push(byte);
}
bool fairlead_decoder_finish(fairlead_decoder* decoder) {
    auto* const cell = find<DecoderCell>(decoder);
    return cell != nullptr && cell->value.finish();
}
bool fairlead_decoder_next(fairlead_decoder* decoder, fairlead_piece* piece) {
    auto* const cell = find<DecoderCell>(decoder);
    HeldPiece held;
    if (cell == nullptr || piece == nullptr || !cell->value.next(held.piece)) return false;
    held.grid = cell->value.grid();
    const wire::CurvePiece& p = held.piece;
    *piece = {};
    piece->start_ns = held.grid.time_ns(p.start);
    piece->end_ns = held.grid.time_ns(p.end);
    piece->channel = p.channel;
    piece->axis = p.axis;
    piece->rotates = p.rotates;
    piece->begins = p.begins;
    piece->jumps = p.jumps;
    piece->ends = p.ends;
    std::memcpy(piece->opaque, static_cast<const void*>(&held), sizeof held);
    return true;
}
bool fairlead_decoder_next_event(fairlead_decoder* decoder, fairlead_event* event) {
    return next_event<DecoderCell>(decoder, event);
}
fairlead_status fairlead_decoder_count(const fairlead_decoder* decoder,
                                       fairlead_decoder_statistics* statistics) {
    const auto* const cell = find<DecoderCell>(decoder);
    if (cell == nullptr) return missing(decoder);
    if (statistics == nullptr) return FAIRLEAD_BAD_ARGUMENT;
    count(cell->value, *statistics);
    return FAIRLEAD_OK;
}

// ---- live window
fairlead_status fairlead_live_init(fairlead_live* live, size_t size) {
    if (!fits(live, size)) return FAIRLEAD_BAD_ARGUMENT;
    make<LiveCell>(live);
    return FAIRLEAD_OK;
}
bool fairlead_live_push(fairlead_live* live, uint8_t byte) {
    auto* const cell = find<LiveCell>(live);
    return cell != nullptr && cell->value.push(byte);
}
bool fairlead_live_finish(fairlead_live* live) {
    auto* const cell = find<LiveCell>(live);
    return cell != nullptr && cell->value.finish();
}
bool fairlead_live_next_event(fairlead_live* live, fairlead_event* event) {
    return next_event<LiveCell>(live, event);
}
fairlead_status fairlead_live_axis(const fairlead_live* live, size_t channel, size_t axis,
                                   int64_t t_ns, fairlead_axis_motion* motion) {
    return answer(live, motion,
                  [&](const BoardLive& l) noexcept { return l.axis(channel, axis, t_ns); });
}
fairlead_status fairlead_live_position(const fairlead_live* live, int64_t t_ns,
                                       fairlead_position_motion* motion) {
    return answer(live, motion, [&](const BoardLive& l) noexcept { return l.position(t_ns); });
}
fairlead_status fairlead_live_orientation(const fairlead_live* live, int64_t t_ns,
                                          fairlead_rotation_motion* motion) {
    return answer(live, motion, [&](const BoardLive& l) noexcept { return l.orientation(t_ns); });
}
fairlead_status fairlead_live_position_until(const fairlead_live* live, int64_t* t_ns) {
    return answer(live, t_ns, [](const BoardLive& l) noexcept { return l.position_until_ns(); });
}
fairlead_status fairlead_live_orientation_until(const fairlead_live* live, int64_t* t_ns) {
    return answer(live, t_ns, [](const BoardLive& l) noexcept { return l.orientation_until_ns(); });
}
fairlead_status fairlead_live_count(const fairlead_live* live,
                                    fairlead_decoder_statistics* statistics) {
    const auto* const cell = find<LiveCell>(live);
    if (cell == nullptr) return missing(live);
    if (statistics == nullptr) return FAIRLEAD_BAD_ARGUMENT;
    count(cell->value.decoder(), *statistics);
    return FAIRLEAD_OK;
}
}
