// Compiled once a stage: FAIRLEAD_SUBJECT names the header.
#include FAIRLEAD_SUBJECT

#include <new>

using namespace fairlead::target;

namespace {

alignas(Subject) unsigned char storage[sizeof(Subject)];
std::optional<Subject::Output> output;

Subject& subject() { return *std::launder(reinterpret_cast<Subject*>(storage)); }

template <class S>
auto prepare(S& stage, const Record& in) -> decltype(stage.prepare(in)) {
    stage.prepare(in);
}
template <class S>
void prepare(S&, ...) {}

}  // namespace

extern "C" {
void subject_start(const void*) {
    ::new (static_cast<void*>(storage)) Subject{};
    output.reset();
}
void subject_prepare(const void* record) {
    prepare(subject(), *static_cast<const Record*>(record));
}
void subject_push(const void* record) {
    output = subject().push(*static_cast<const Record*>(record));
}
void subject_flush(const void*) { output = subject().flush(); }
bool subject_output(Digest* digest) {
    if (output) mix(*digest, *output);
    return output.has_value();
}
const char* const subject_text = Subject::text;
const unsigned subject_latency = Subject::latency;
const unsigned subject_size = sizeof(Subject);
const bool subject_takes_samples = Subject::takes_samples;
const bool subject_takes_anything = Subject::takes_anything;
}
