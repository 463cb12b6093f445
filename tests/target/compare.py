#!/usr/bin/env python3
"""Says whether every stage gave the same bits on every machine; where not, names the first stage (in the data's order),
the stream and the first record that differ."""
import argparse
import json
import sys

from measure import call_name, read_words


def first_difference(known, seen):
    """Index of the first word that differs; a shorter sequence may be the beginning of a longer one."""
    return next((i for i, (a, b) in enumerate(zip(known, seen)) if a != b), None)


def load(build, core, subject):
    stem = "%s/%s/%s" % (build, core, subject)
    return {s["name"]: s for s in json.load(open(stem + ".result"))["streams"]}, read_words(stem + ".digests")


def compare(build, subject, reference, core):
    """(None or what differs first between two machines, calls compared)."""
    known_streams, known_digests = load(build, reference, subject)
    seen_streams, seen_digests = load(build, core, subject)
    for name, s in seen_streams.items():
        k = known_streams[name]
        if k["input"] != s["input"]:
            return "stream %s: the generator itself gives other records" % name, 0
        known = known_digests[k["first"]:k["first"] + k["pushes"] + k["flushes"]]
        seen = seen_digests[s["first"]:s["first"] + s["pushes"] + s["flushes"]]
        at = first_difference(known, seen)
        if at is not None:
            return "stream %s, %s" % call_name([k], k["first"] + at), 0
        if len(known) != len(seen):
            return "stream %s: %d calls and %d" % (name, len(known), len(seen)), 0
    return None, len(seen_digests)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build/target")
    parser.add_argument("--subjects", nargs="+", required=True)
    parser.add_argument("--cores", nargs="+", required=True)
    options = parser.parse_args()
    reference, failed, calls = options.cores[0], False, 0
    for subject in options.subjects:
        for core in options.cores[1:]:
            difference, compared = compare(options.build, subject, reference, core)
            calls += compared
            if difference:
                failed = True
                print("FAIL same bits: stage %s differs between %s and %s; first at %s" %
                      (subject, reference, core, difference))
        if failed:  # what comes after a stage that differs says nothing new
            sys.exit(1)
        print("ok same bits: %s" % subject)
    print("%d stages, %d machines, one digest in %s calls: %s" %
          (len(options.subjects), len(options.cores), format(calls, ","), " ".join(options.cores)))


if __name__ == "__main__":
    main()
