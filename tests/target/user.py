#!/usr/bin/env python3
"""What a user's own configuration costs on a core: instructions, stack, RAM, flash. Exit code 1 above the budget."""
import argparse
import sys

from bounds import TITLES
from measure import Core, count_summary, measure, read_report, read_words, run_words, stream_list


def replay(core, build, recording, out):
    """The summary of the pushes of a recording."""
    core.run("%s/%s/user.elf" % (build, core.name), build, run_words(["recording=" + recording], out), out + ".counts")
    streams = read_report(out + ".report")[1]
    if not streams:
        raise SystemExit("%s holds nothing for this pipeline: poses are in .trk files, samples of an IMU in .imu files" % recording)
    return count_summary(streams, read_words(out + ".counts"))["push"]


def line(name, push):
    print("%-12s instructions of a push: max %s (%s %s), mean %s, min %s" %
          (name, format(push["max"], ","), push["stream"], push["call"], format(round(push["mean"]), ","),
           format(push["min"], ",")))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build/target")
    parser.add_argument("--core", required=True)
    parser.add_argument("--recording")
    parser.add_argument("--budget", type=int, help="instructions that one push may take")
    o = parser.parse_args()
    core, out = Core(o.core), "%s/%s/user" % (o.build, o.core)
    result, broken = measure(core, "user", o.build, ["recipes=" + stream_list(core, "user", out)], out)
    if broken:
        sys.exit("\n".join("FAIL " + b for b in broken))
    print("%s: flash %s bytes, RAM %s bytes, stack %s bytes used, %s at most, latency at most %d records" %
          (TITLES[o.core], *(format(result[k], ",") for k in ("flash", "ram", "stack", "stack_bound")), result["latency"]))
    line("streams", result["push"])
    worst = result["push"]["max"]
    if o.recording:
        push = replay(core, o.build, o.recording, out + ".recording")
        line("recording", push)
        worst = max(worst, push["max"])
    print("%-12s no path through the code that keeps the loop counts takes more than %s" %
          ("bound", format(result["push"]["bound"], ",")))
    if o.budget is None:
        return
    over = worst > o.budget
    print("%s budget: a push took %s instructions, %s are allowed" %
          ("FAIL" if over else "ok", format(worst, ","), format(o.budget, ",")))
    sys.exit(over)


if __name__ == "__main__":
    main()
