#pragma once
#include "host_sim/recording/writers.hpp"
