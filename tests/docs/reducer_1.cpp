// The board of the example in docs/reducer.md.
#include "fairlead/pipeline2.hpp"

// behind the header, which it needs
#include "example.inc"

fairlead::Bytes example(const fairlead::Pose& pose) {
    fairlead::Pipeline2<Board> pipeline{{}};
    return pipeline.push(pose);
}
