#pragma once
#include "tests/target/encoder_stage.hpp"

using Stage = fairlead::target::EncoderStage<fairlead::target::JustPosition, 120,
                                             fairlead::Beam::medium, fairlead::curve::Cubics>;

struct Subject : Stage {
    static constexpr const char* text = "encoder: position, C2 cubics, medium beam, delay 120";
};
