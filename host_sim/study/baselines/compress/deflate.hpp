#pragma once
// Raw float32 and zlib: what one would do without thinking of the motion. Lossless; a restart
// begins a new deflate stream, a frame in between ends with a flush whose 4 constant bytes are left
// out. Positions are 3 floats, orientations the 3 of the vector part (scalar part not negative).
#include "host_sim/study/baselines/compress/coder.hpp"

namespace fairlead::sim {

struct DeflateParams {
    int strategy{};      // of zlib: default, filtered, Huffman only, run lengths
    bool byte_planes{};  // the floats' first bytes together, then the second, ...
    bool differences{};  // floats as integers, each minus the one before in its axis
};

std::size_t deflated_size(const Track& track, const DeflateParams& params, std::size_t delay);

}  // namespace fairlead::sim
