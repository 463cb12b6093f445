#pragma once
#include "tests/target/encoder_stage.hpp"

using Stage = fairlead::target::EncoderStage<fairlead::target::Both, 120, fairlead::Beam::medium,
                                             fairlead::curve::Cubics>;

struct Subject : Stage {
    static constexpr const char* text =
        "encoder: both channels, C2 cubics for positions, medium beam, delay 120";
};
