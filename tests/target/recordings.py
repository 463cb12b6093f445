#!/usr/bin/env python3
"""The same bits on recordings: whole ones on the reference machine, on clang and on M4F, their first 10 s on the other
machines. By default the stages that a board runs, and two recordings where floats are emulated; with --soak every stage
and every recording."""
import argparse
import concurrent.futures
import glob
import os
import sys

from compare import first_difference
from measure import Core, call_name, read_report, read_words, run_words

DAILY = ("pipeline_32", "attitude")
WHOLE = ("gcc-O2", "clang-O2", "m4f")


def takes_samples(subject):
    return "takes_samples = true" in open("tests/target/subjects/%s.hpp" % subject).read()


def run(build, core_name, subject, recording):
    """(streams, digests) of one run; on the machines of WHOLE over all of the recording."""
    core = Core(core_name)
    out = "%s/%s/%s.%s" % (build, core_name, subject, os.path.basename(recording))
    words = ["recording=" + recording] + ([] if core_name in WHOLE else ["seconds=10"])
    core.run("%s/%s/%s.elf" % (build, core_name, subject), build, run_words(words, out), timeout=3600)
    result = read_report(out + ".report")[1], read_words(out + ".digests")
    for end in (".report", ".digests"):
        os.remove(out + end)
    return result


def compare(build, subject, recording, cores):
    """Lines that say what differs."""
    known_streams, known = run(build, cores[0], subject, recording)
    failures = []
    for core in cores[1:]:
        streams, seen = run(build, core, subject, recording)
        pushes = streams[0]["pushes"]  # a shorter run ends with other flushes: its pushes are compared
        whole = pushes == known_streams[0]["pushes"]
        n = len(seen) if whole else pushes
        at = first_difference(known[:n], seen[:n])
        if at is not None:
            failures.append("FAIL same bits: stage %s differs between %s and %s; first at %s of %s" %
                            (subject, cores[0], core, call_name(known_streams, at)[1], os.path.basename(recording)))
    return failures, known_streams[0]["pushes"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build/target")
    parser.add_argument("--recordings", default="../shared/recordings")
    parser.add_argument("--soak", action="store_true")
    parser.add_argument("--subjects", nargs="+", required=True)
    parser.add_argument("--cores", nargs="+", required=True)
    o = parser.parse_args()
    tracker, imu = (sorted(glob.glob(o.recordings + p)) for p in ("/tracker120/*.trk", "/*.imu"))
    if not tracker or not imu:
        print("skipped recordings: none in %s" % o.recordings)
        return
    reference = "gcc-O2"
    jobs = []
    for subject in o.subjects:
        if not o.soak and subject not in DAILY:
            continue
        for n, recording in enumerate(imu if takes_samples(subject) else tracker):
            cores = [c for c in o.cores if c != reference and (o.soak or n < 2 or c in WHOLE)]
            jobs.append((subject, recording, [reference] + cores))
    failed, records = False, 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for job, (failures, pushes) in zip(jobs, pool.map(lambda j: compare(o.build, *j), jobs)):
            records += pushes
            for f in failures:
                failed = True
                print(f)
    if failed:
        sys.exit(1)
    print("ok recordings: %d runs of stages over recordings, %s records, one digest on %d machines" %
          (len(jobs), format(records, ","), len(o.cores)))


if __name__ == "__main__":
    main()
