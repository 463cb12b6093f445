// Attitude alone, for C: intake, calibration and filter.
#include "lib/c/objects.hpp"

using namespace fairlead::c;
using fairlead::AttitudeMode;
using fairlead::Check;

namespace {

using Front = AttitudeAlone::Front;
struct Params : Front::Params {
    fairlead::IntakeParams intake{};
};

/// Those of the configuration where its input is an IMU; otherwise the library's.
template <class Board>
Params params_of_board(const Board& board) noexcept {
    Params out;
    if constexpr (Kind::samples) {
        out.calibration = board.calibration;
        out.attitude = board.attitude;
        out.intake = board.intake;
    }
    return out;
}
Params default_params() noexcept { return params_of_board(Config::params()); }
Check check(const Params& params) noexcept {
    if (const Check c = Front::check(params); !c) return c;
    return fairlead::check(params.intake);
}
template <class C, class Cpp, class Copy>
void join(C& c, Cpp& cpp, Copy&& copy) noexcept {
    join_intake(c.intake, cpp.intake, copy);
    join_calibration(c.calibration, cpp.calibration, copy);
}

/// A gyro alone takes over its bias; the others all that they know.
template <class Filter, class State>
void restore_knowledge(Filter& filter, const State& known) noexcept {
    if constexpr (mode == AttitudeMode::gyro) {
        State state;
        state.bias_rad_s = known.bias_rad_s;
        state.bias_variance = known.bias_variance;
        filter.restore_all(state);
    } else {
        filter.restore_knowledge(known);
    }
}

template <class Filter>
void estimate_of(const Filter& filter, fairlead_attitude_estimate& out) noexcept {
    const ToC copy;
    copy(out.q_wb, filter.orientation());
    copy(out.rate_rad_s, filter.rate_rad_s());
    copy(out.bias_rad_s, filter.bias_rad_s());
    out.inclination_sigma_rad = out.heading_sigma_rad = -1;
    if constexpr (mode != AttitudeMode::gyro)
        out.inclination_sigma_rad = filter.inclination_sigma();
    if constexpr (mode == AttitudeMode::imu_mag) out.heading_sigma_rad = filter.heading_sigma();
}

}  // namespace

extern "C" {

void fairlead_attitude_defaults(fairlead_attitude_params* params) {
    if (params == nullptr) return;
    *params = {};
    const Params from = default_params();
    join(*params, from, ToC{});
}

fairlead_status fairlead_attitude_init(fairlead_attitude* attitude, size_t size,
                                       const fairlead_attitude_params* params) {
    if (!fits(attitude, size)) return FAIRLEAD_BAD_ARGUMENT;
    Params asked = default_params();
    if (params != nullptr) join(*params, asked, ToCpp{});
    const Check checked = check(asked);
    const Params used = checked ? asked : Params{};
    using Gate = fairlead::Intake<fairlead::Sample, Front::takes>;
    make<AttitudeCell>(attitude, checked, Gate{used.intake}, Front{used});
    return code(checked.status);
}
const char* fairlead_attitude_refused_field(const fairlead_attitude* attitude) {
    const auto* const cell = find<AttitudeCell>(attitude);
    return cell == nullptr ? nullptr : cell->value.checked.field;
}

fairlead_status fairlead_attitude_push(fairlead_attitude* attitude, const fairlead_sample* sample,
                                       fairlead_pose* pose) {
    auto* const cell = find<AttitudeCell>(attitude);
    if (cell == nullptr) return missing(attitude);
    if (sample == nullptr || pose == nullptr || !cell->value.checked) return FAIRLEAD_BAD_ARGUMENT;
    const auto accepted = cell->value.intake.push(to_cpp(*sample));
    const auto out = accepted ? cell->value.front.push(*accepted) : std::nullopt;
    if (out) to_c(*pose, *out);
    if (cell->value.intake.refused()) return FAIRLEAD_REFUSED;
    return out ? FAIRLEAD_OK : FAIRLEAD_NOT_ENOUGH_DATA;
}

fairlead_status fairlead_attitude_now(const fairlead_attitude* attitude,
                                      fairlead_attitude_estimate* estimate) {
    const auto* const cell = find<AttitudeCell>(attitude);
    if (cell == nullptr) return missing(attitude);
    if (estimate == nullptr) return FAIRLEAD_BAD_ARGUMENT;
    estimate_of(cell->value.front.attitude(), *estimate);
    return FAIRLEAD_OK;
}
fairlead_status fairlead_attitude_count(const fairlead_attitude* attitude,
                                        fairlead_fault_counts* faults) {
    const auto* const cell = find<AttitudeCell>(attitude);
    if (cell == nullptr) return missing(attitude);
    if (faults == nullptr) return FAIRLEAD_BAD_ARGUMENT;
    *faults = faults_of(cell->value.intake.faults());
    return FAIRLEAD_OK;
}
fairlead_status fairlead_attitude_reset(fairlead_attitude* attitude) {
    auto* const cell = find<AttitudeCell>(attitude);
    if (cell == nullptr) return missing(attitude);
    cell->value.intake.reset();
    cell->value.front.reset();
    return code(cell->value.checked.status);
}

fairlead_status fairlead_attitude_save(const fairlead_attitude* attitude, void* memory,
                                       size_t size) {
    const auto* const cell = find<AttitudeCell>(attitude);
    if (cell == nullptr) return missing(attitude);
    if (memory == nullptr || size != sizeof(SavedAttitude)) return FAIRLEAD_BAD_ARGUMENT;
    const SavedAttitude saved = fairlead::save(cell->value.front.attitude().state());
    std::memcpy(memory, static_cast<const void*>(&saved), sizeof saved);
    return FAIRLEAD_OK;
}
fairlead_status fairlead_attitude_restore(fairlead_attitude* attitude, const void* memory,
                                          size_t size) {
    auto* const cell = find<AttitudeCell>(attitude);
    if (cell == nullptr) return missing(attitude);
    if (memory == nullptr || size != sizeof(SavedAttitude)) return FAIRLEAD_BAD_ARGUMENT;
    SavedAttitude saved;
    std::memcpy(static_cast<void*>(&saved), memory, sizeof saved);
    const auto known = fairlead::restore(saved);
    if (!known) return code(known.status());
    restore_knowledge(cell->value.front.attitude(), *known);
    return FAIRLEAD_OK;
}
}
