#pragma once
#include "fairlead/smooth/fairing_window.hpp"
#include "tests/target/pose_stage.hpp"

using Stage = fairlead::FairingWindow<3, 4, true>;

struct Subject : fairlead::target::PoseStage<Stage> {
    static constexpr const char* text =
        "FairingWindow<3, 4, true>: rho_3 alternating, 4 rounds, bounded";
    static fairlead::FairingParams bounded() {
        fairlead::FairingParams params;
        params.bound_m = 0.002f;
        params.bound_rad = 0.0087266f;  // 0.5 deg
        return params;
    }
    Subject() : PoseStage{Stage{bounded()}} {}
};
