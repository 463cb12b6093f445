#pragma once
#include "tests/target/encoder_stage.hpp"

using Stage = fairlead::target::EncoderStage<fairlead::target::Both, 120, fairlead::Beam::narrow>;

struct Subject : Stage {
    static constexpr const char* text = "encoder: both channels, narrow beam, delay 120";
};
