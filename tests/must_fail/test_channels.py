#!/usr/bin/python3
"""What a board does not choose costs no code: a pipeline of positions has no function that knows a quaternion, one of
orientations has no search of axes. Both are compiled without inlining, and their functions listed. CXX chooses the compiler."""
import os
import re
import subprocess
import sys
import tempfile

PROGRAM = """#include "fairlead/pipeline.hpp"
struct Board {
    using Input = fairlead::%s;
    using Channels = fairlead::Channels<fairlead::%s>;
    using Filter = fairlead::NoFilter;
    static constexpr std::size_t delay_records_max = 32;
    static constexpr fairlead::Beam beam = fairlead::Beam::narrow;
    static constexpr std::size_t events_max = %d;
};
fairlead::Pipeline<Board>* made;
fairlead::Bytes push(const fairlead::Pipeline<Board>::Raw& record) { return made->push(record); }
fairlead::Bytes flush() { return made->flush(); }
fairlead::Pipeline<Board> make() { return fairlead::Pipeline<Board>{{}}; }
"""

# input, channel, events; what no function's own name or owner may say; what must be there, so that the test sees something
CASES = [
    ("Pose", "Position", 0, r"^(?!.*NoGate).*(BasicQuat|Rotation|rotation_|Attitude|exp\(|log\(|atan2|Event\b)", r"Interval"),
    ("Pose", "Orientation", 0, r"Interval|VectorChannel|ChannelGate<.*BasicVec3|Attitude|Event\b", r"Ball"),
    ("Imu<fairlead::AttitudeMode::gyro>", "Orientation", 0, r"Interval|VectorChannel|Kalman|Event\b", r"BasicAttitude"),
]


def functions(text):
    """Names of the functions without their parameters: Pose itself holds a quaternion."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "board.o")
        subprocess.run([os.environ.get("CXX", "g++"), "-std=c++17", "-O0", "-fno-exceptions", "-fno-rtti", "-Ilib/include", "-x",
                        "c++", "-c", "-", "-o", out], input=text, text=True, check=True)
        said = subprocess.run(["nm", "-C", "--defined-only", out], capture_output=True, text=True, check=True).stdout
    names = [line.split(" ", 2)[2] for line in said.splitlines() if line.split(" ", 2)[1] in "tTwW"]
    return [name for name in names if "std::" not in name.split("(")[0] and "fairlead" in name]


def own_name(name):
    """The name before the parameters, brackets of templates kept."""
    depth = 0
    for i, c in enumerate(name):
        depth += {"<": 1, ">": -1}.get(c, 0)
        if c == "(" and depth == 0 and i > 0 and not name.startswith("operator", i - 8):
            return name[:i]
    return name


def main():
    failed = False
    for source, channel, events, never, always in CASES:
        names = [own_name(n) for n in functions(PROGRAM % (source, channel, events))]
        wrong = [n for n in names if re.search(never, n)]
        seen = any(re.search(always, n) for n in names)
        good = not wrong and seen
        failed |= not good
        print(f"{'ok' if good else 'FAIL'} a board of {source} with {channel}: {len(names)} functions, {len(wrong)} that it does not need"
              + ("" if seen else f"; none is named {always}"))
        for name in wrong[:20]:
            print("    " + name[:200])
    sys.exit(failed)


main()
