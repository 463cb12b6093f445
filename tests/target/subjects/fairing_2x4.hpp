#pragma once
#include "fairlead/smooth/fairing_window.hpp"
#include "tests/target/pose_stage.hpp"

using Stage = fairlead::FairingWindow<2, 4>;

struct Subject : fairlead::target::PoseStage<Stage> {
    static constexpr const char* text = "FairingWindow<2, 4>: rho_2, 4 rounds";
    Subject() : PoseStage{Stage{fairlead::FairingParams{}}} {}
};
