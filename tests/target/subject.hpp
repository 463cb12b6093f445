#pragma once
// The seam between a stage under test and the program that runs it. A stage is one small header in
// tests/target/subjects/ that defines
//
//     struct Subject {
//         static constexpr const char* text = "what it is, with its configuration";
//         static constexpr unsigned latency = 4;        // records
//         static constexpr bool takes_samples = false;  // true: it reads in.sample, not in.pose
//         static constexpr bool takes_anything = false; // true: bad input is its own affair
//         using Output = Pose;                          // anything that mix() takes
//         std::optional<Output> push(const Record& in);
//         std::optional<Output> flush();                // called until it is empty
//         void prepare(const Record& in);               // may be left out: before each push, not
//     };                                                // counted, not part of the stage's image
//
// subject.cpp turns it into these functions, one object file a stage.
#include "tests/target/digest.hpp"

namespace fairlead::target {

/// One record of a stream, as an IMU and as a tracker would have told it.
struct Record {
    Sample sample;
    Pose pose;
};

}  // namespace fairlead::target

extern "C" {
void subject_start(const void* unused);
void subject_prepare(const void* record);
void subject_push(const void* record);
void subject_flush(const void* unused);
/// Mixes what the last push or flush gave into the digest; false where it gave nothing.
bool subject_output(fairlead::target::Digest* digest);
extern const char* const subject_text;
extern const unsigned subject_latency, subject_size;
extern const bool subject_takes_samples, subject_takes_anything;
}
