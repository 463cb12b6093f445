// The frame of the first example in docs/bounds.md.
#include "fairlead/pipeline2.hpp"

#include "example.inc"

fairlead::Pipeline2<Config> pipeline{Config::params()};
