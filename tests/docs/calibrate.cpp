// The frame of the example in docs/calibrate.md.
#include "fairlead/sense/calibrate.hpp"
#include "fairlead/sense/attitude.hpp"

#include "example_headers.inc"

bool user_turns_the_board();
fairlead::Vec3 read_magnetometer_uT();
void ask(const char* what);
template <class Saved>
void store(const Saved& saved);

void example(fairlead::Calibration calibration, fairlead::Attitude& attitude,
             const fairlead::Sample& sample) {
#include "example.inc"
}
