#pragma once
#include "tests/target/encoder_stage.hpp"

using Stage =
    fairlead::target::EncoderStage<fairlead::target::JustOrientation, 32, fairlead::Beam::medium>;

struct Subject : Stage {
    static constexpr const char* text = "encoder: orientation, medium beam, delay 32";
};
