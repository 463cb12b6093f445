#!/usr/bin/env python3
"""Says whether every stage gave the same bits on every machine; where not, names the first stage (in the data's order),
the stream and the first record that differ."""
import argparse
import json
import sys

from measure import call_name, read_words


def first_difference(a, b):
    for index, (x, y) in enumerate(zip(a, b)):
        if x != y:
            return index
    return None if len(a) == len(b) else min(len(a), len(b))


def compare(build, subject, reference, core):
    """None, or what differs first between two machines."""
    stem = "%s/%s/" + subject
    known = json.load(open((stem + ".result") % (build, reference)))["streams"]
    seen = json.load(open((stem + ".result") % (build, core)))["streams"]
    for k, s in zip(known, seen):
        if k["input"] != s["input"]:
            return "stream %s: the generator itself gives other records" % k["name"]
    at = first_difference(*(read_words((stem + ".digests") % (build, c)) for c in (reference, core)))
    return None if at is None else "stream %s, %s" % call_name(known, at)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build/target")
    parser.add_argument("--subjects", nargs="+", required=True)
    parser.add_argument("--cores", nargs="+", required=True)
    options = parser.parse_args()
    reference, failed, calls = options.cores[0], False, 0
    for subject in options.subjects:
        calls += len(read_words("%s/%s/%s.digests" % (options.build, reference, subject)))
        for core in options.cores[1:]:
            difference = compare(options.build, subject, reference, core)
            if difference:
                failed = True
                print("FAIL same bits: stage %s differs between %s and %s; first at %s" %
                      (subject, reference, core, difference))
        if failed:  # what comes after a stage that differs says nothing new
            sys.exit(1)
        print("ok same bits: %s" % subject)
    print("%d calls of %d stages, one digest on %d machines: %s" %
          (calls, len(options.subjects), len(options.cores), " ".join(options.cores)))


if __name__ == "__main__":
    main()
