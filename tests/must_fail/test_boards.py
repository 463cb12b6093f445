#!/usr/bin/python3
"""Boards that must not compile: each lacks a member, misspells one, or gives it a wrong kind. The compiler must say the
sentence that tells the user what to do. The board without a fault must compile. CXX chooses the compiler."""
import concurrent.futures
import os
import re
import subprocess
import sys

BOARD = """#include "fairlead/pipeline.hpp"
using namespace fairlead;
template <class Board>
struct Codec {
    using Stream = StreamParams<typename Board::Channels, Board::delay_records_max>;
    using Record = typename detail::InputTraits<typename Board::Input>::Record;
    static constexpr Check check(const Stream&) { return {}; }
    static constexpr IntakeLimits limits(const Stream&, std::int64_t) { return {}; }
    Codec(const Stream&, std::uint32_t) {}
    void set_period(std::int64_t) {}
    Bytes push(const Record&) { return {}; }
    Bytes idle() { return {}; }
    Bytes flush() { return {}; }
    static constexpr bool busy() { return false; }
    bool push_event(const Event&) { return true; }
    void reset() {}
};
struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, Orientation>;
    using Filter = PoseFilter<9>;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::medium;
    static constexpr std::size_t events_max = 0;
};
int main() {
    using Chain = BasicPipeline<Board, Codec>;
    Chain::Params params;
    params.tolerance.position_m = 0.001f;
    static_assert(Chain::check(Chain::Params{}));
    Chain chain{params};
    return static_cast<int>(chain.push({}).size);
}
"""

# what is changed, into what, and what the compiler must say
LACKS = "the board lacks `"
FAULTS = [
    ("using Input = Pose;", "", LACKS + "using Input"),
    ("using Input = Pose;", "using Inptu = Pose;", LACKS + "using Input"),
    ("using Input = Pose;", "using Input = Sample;", "Input must be Pose, Imu<mode> or VectorSample<D>"),
    ("using Input = Pose;", "using Input = Imu<>;", "these Channels do not come from this Input"),
    ("using Channels = fairlead::Channels<Position, Orientation>;", "", LACKS + "using Channels"),
    ("Channels<Position, Orientation>;", "Channels<Position, Vector<3>>;", "these Channels do not come from this Input"),
    ("using Filter =", "using Fliter =", LACKS + "using Filter"),
    ("PoseFilter<9>;", "int;", "Filter is no filter for the records of this Input"),
    ("delay_records_max = 120", "delay_record_max = 120", LACKS + "static constexpr std::size_t delay_records_max"),
    ("std::size_t delay_records_max = 120", "int delay_records_max = -5", "delay_records_max must be of type std::size_t"),
    ("std::size_t delay_records_max = 120", "double delay_records_max = 120",
     "delay_records_max must be of type std::size_t"),
    ("delay_records_max = 120", "delay_records_max = 15", "delay_records_max must be 16 to 240 records"),
    ("events_max = 0;", "events_max = 0;\n    using Kind = int;", "Kind must be curve::Smooth"),
    ("Channels<Position, Orientation>;", "Channels<Orientation>;\n    using Kind = curve::Cubics;",
     "Kind = curve::Cubics needs a channel Position or Vector<D>"),
    ("delay_records_max = 120", "delay_records_max = 241", "delay_records_max must be 16 to 240 records"),
    ("static constexpr Beam beam = Beam::medium;", "", LACKS + "static constexpr Beam beam"),
    ("Beam beam = Beam::medium;", "int beam = 2;", "beam must be of type fairlead::Beam"),
    ("events_max = 0", "events = 0", LACKS + "static constexpr std::size_t events_max"),
    ("events_max = 0", "events_max = 7", "events_max must be 0 to 6"),
    ("params.tolerance.position_m", "params.tolerance.positoin_m", "positoin_m"),
    ("params.tolerance.position_m = 0.001f", "params.delay_max = 60", "delay_max"),
    ("check(Chain::Params{})", "check([] { Chain::Params p; p.delay_records = 121; return p; }())", "static assertion|static_assert"),
]
# channels that a board does not choose have no parameters either
CHOSEN = [
    ("Channels<Position, Orientation>;", "Channels<Orientation>;", "position_m"),
]


def compiles(text):
    command = [os.environ.get("CXX", "g++"), "-std=c++17", "-fsyntax-only", "-Ilib/include", "-x", "c++", "-"]
    done = subprocess.run(command, input=text, capture_output=True, text=True)
    return done.returncode == 0, done.stderr


def case(fault):
    before, after, sentence = fault
    if BOARD.count(before) != 1:
        return f"FAIL {before!r} stands {BOARD.count(before)} times in the board"
    passes, said = compiles(BOARD.replace(before, after))
    if passes:
        return f"FAIL compiles with {after or 'nothing'!r} for {before!r}"
    flat = " ".join(said.split())
    if not re.search(sentence if sentence.startswith("static ") else re.escape(sentence), flat):
        return f"FAIL {after!r} for {before!r}: the compiler does not say {sentence!r}:\n{said[:2000]}"
    return None


def main():
    passes, said = compiles(BOARD)
    failures = [] if passes else ["FAIL the board without a fault does not compile:\n" + said[:2000]]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        failures += [line for line in pool.map(case, FAULTS + CHOSEN) if line]
    print("\n".join(failures) or f"ok {len(FAULTS) + len(CHOSEN)} boards that must not compile do not, and say why")
    sys.exit(bool(failures))


main()
