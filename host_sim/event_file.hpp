#pragma once
#include "host_sim/recording/event_file.hpp"
