#!/usr/bin/env python3
"""Instructions of an attitude sample on a Cortex-M4F over whole recordings, against the budgets of docs/attitude.md.
Exit code 1 above them."""
import argparse
import glob
import os
import sys

from measure import Core, count_summary, read_report, read_words, run_words

BUDGETS = {"attitude": (1100, 2500), "attitude_imu": (None, 2000)}  # mean, largest


def summary(core, build, stage, recording):
    out = "%s/%s/%s.recording" % (build, core.name, stage)
    core.run("%s/%s/%s.elf" % (build, core.name, stage), build, run_words(["recording=" + recording], out),
             out + ".counts", timeout=3600)
    push = count_summary(read_report(out + ".report")[1], read_words(out + ".counts"))["push"]
    for end in (".report", ".digests", ".counts"):
        os.remove(out + end)
    return push


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build/target")
    parser.add_argument("--recordings", default="../shared/recordings")
    o = parser.parse_args()
    recordings = sorted(glob.glob(o.recordings + "/*.imu"))
    if not recordings:
        print("skipped attitude-counts: no recordings in %s" % o.recordings)
        return 0
    core, failed = Core("m4f"), False
    print("%-52s %s" % ("instructions of a sample, Cortex-M4F", "  ".join("%20s" % s for s in BUDGETS)))
    worst = {stage: [0.0, 0] for stage in BUDGETS}
    for recording in recordings:
        cells = []
        for stage, most in worst.items():
            push = summary(core, o.build, stage, recording)
            most[0], most[1] = max(most[0], push["mean"]), max(most[1], push["max"])
            cells.append("%20s" % ("mean %.0f, max %d" % (push["mean"], push["max"])))
        print("%-52s %s" % (os.path.basename(recording), "  ".join(cells)), flush=True)
    for stage, (mean, largest) in BUDGETS.items():
        if (mean and worst[stage][0] > mean) or worst[stage][1] > largest:
            print("FAIL attitude-counts: %s: mean %.0f, max %d" % (stage, *worst[stage]))
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
