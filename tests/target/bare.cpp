// The smallest image that holds a stage: what it adds to the same image without one is what the
// stage costs in flash. Linked without any system calls, it also proves that nothing asks for heap.
#include "tests/target/subject.hpp"

extern fairlead::target::Record bare_record;
fairlead::target::Record bare_record;
extern fairlead::target::Digest bare_digest;
fairlead::target::Digest bare_digest;

int main(int, char**) {
    subject_start(nullptr);
    subject_push(&bare_record);
    subject_flush(nullptr);
    return static_cast<int>(bare_digest.value());
}
