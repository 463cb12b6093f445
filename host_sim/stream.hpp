#pragma once
#include "host_sim/recording/recording.hpp"
