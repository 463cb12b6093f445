// The board of the example in docs/reducer.md.
#include "fairlead/pipeline.hpp"

// behind the header, which it needs
#include "example.inc"

fairlead::Bytes example(const fairlead::Pose& pose) {
    fairlead::Pipeline<Board> pipeline{{}};
    return pipeline.push(pose);
}
