#!/usr/bin/python3
"""Line coverage of lib by the committed corpora: runs each target once over its corpus, and counts the lines that ran.

    tests/fuzz/coverage.py BUILD TARGET...     BUILD/fuzz/TARGET: built with -fprofile-instr-generate -fcoverage-mapping

Lines are those that clang counts: in functions that a target compiles, each line once, whatever types it is compiled for.
Prints a row for each folder of lib, then the files below --below percent."""
import argparse
import collections
import json
import os
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
LIB = HERE.parents[1] / "lib/include/fairlead"


def profile(build, target):
    out = build / "fuzz" / f"{target}.profraw"
    subprocess.run([build / "fuzz" / target, "-runs=0", HERE / "corpus" / target], check=True, capture_output=True,
                   env={**os.environ, "LLVM_PROFILE_FILE": str(out)})
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("targets", nargs="+")
    parser.add_argument("--below", type=float, default=70)
    args = parser.parse_args()
    merged = args.build / "fuzz/all.profdata"
    subprocess.run(["llvm-profdata", "merge", "-sparse", *(profile(args.build, t) for t in args.targets), "-o", merged],
                   check=True)
    programs = [args.build / "fuzz" / t for t in args.targets]
    said = subprocess.run(["llvm-cov", "export", "-summary-only", f"-instr-profile={merged}", programs[0],
                           *(f"-object={p}" for p in programs[1:])], check=True, capture_output=True, text=True).stdout
    folders, poor = collections.defaultdict(lambda: [0, 0]), []
    for file in json.loads(said)["data"][0]["files"]:
        path = pathlib.Path(file["filename"]).resolve()
        if LIB not in path.parents:
            continue
        lines, name = file["summary"]["lines"], path.relative_to(LIB)
        for row in (name.parts[0] if len(name.parts) > 1 else "pipeline", "all of lib"):
            folders[row][0] += lines["covered"]
            folders[row][1] += lines["count"]
        if lines["percent"] < args.below:
            poor.append(f"  {name}: {lines['covered']} of {lines['count']}")
    for row in sorted(folders, key=lambda r: (r == "all of lib", r)):
        covered, count = folders[row]
        print(f"{row:12} {covered:6} of {count:6} lines  {100 * covered / count:5.1f} %")
    if poor:
        print(f"below {args.below:.0f} %:", *sorted(poor), sep="\n")


main()
