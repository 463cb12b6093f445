#pragma once
// The loop of a firmware: a record in, the frames that it completed out; at the end what is still
// inside.
#include "examples/firmware/retarget.hpp"
#include "fairlead/base/bytes.hpp"

namespace board {

/// Record: fairlead::Pose or fairlead::Sample, as the pipeline takes it. Does not return.
template <class Record, class Pipeline>
[[noreturn]] void run(Pipeline& pipeline) {
    start();
    if (!pipeline.check()) stop();  // a parameter is refused; check().field names it
    Record record;
    while (next(record)) {
        const fairlead::Bytes frames = pipeline.push(record);
        if (!frames.empty()) send(frames.data, frames.size);
    }
    for (;;) {
        const fairlead::Bytes frames = pipeline.flush();
        if (!frames.empty()) send(frames.data, frames.size);
        if (frames.status == fairlead::Status::end) stop();
    }
}

}  // namespace board
