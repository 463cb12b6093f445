// The frame of the first example in docs/bounds.md.
#include "fairlead/pipeline.hpp"

#include "example.inc"

fairlead::Pipeline<Config> pipeline{Config::params()};
