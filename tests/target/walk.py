#!/usr/bin/env python3
"""Checks that the walkers of linked code see what stands there: functions of walk.S with known stacks, paths and faults."""
import subprocess
import sys

import elf
import path as paths

PREFIX = "arm-none-eabi-"
STACKS = {"leaf": 8, "nested": 36, "early": 0, "detour": 12, "rounds": 0, "tail": 8}
FAULTS = {"winding": "recursion", "blind": "calls through a register", "astray": "moves the stack pointer"}
# function: instructions of the dearest path, rounds of its loop
PATHS = {"leaf": (3, 0), "nested": (8, 0), "early": (6, 0), "detour": (8, 0), "rounds": (3 + 3 * 7, 7), "tail": (6, 0)}
# the same where what stands behind the condition may not run
SHORTEST = {"early": 3, "detour": 5}


def bound_of(image, name, rounds, work, shut=False):
    graph = paths.Graph(image, image.address[name])
    if shut:  # what a condition leads past
        graph.branches = [b for b in graph.size if b in graph.calls or name == "early" and b != graph.root]
    return graph.bound(dict.fromkeys(graph.heads, rounds) | dict.fromkeys(graph.branches, 0), work)


def trouble_of(image, name):
    try:
        image.bound(image.address[name])
    except elf.Trouble as trouble:
        return str(trouble)
    return "none"


def main():
    out = sys.argv[1] + "/walk"
    subprocess.run([PREFIX + "gcc", "-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-nostdlib", "-Wl,-e,leaf",
                    "-Wl,-Map=" + out + ".map", "tests/target/walk.S", "-o", out + ".elf"], check=True)
    image = elf.Image(out + ".elf", PREFIX)
    failures = []

    def expect(what, seen, right):
        if not right:
            failures.append("%s: %s" % (what, seen))

    for name, size in STACKS.items():
        seen = image.bound(image.address[name])[0]
        expect("stack of " + name, seen, seen == size)
    for name, fault in FAULTS.items():
        seen = trouble_of(image, name)
        expect("fault of " + name, seen, fault in seen)
    for name, (instructions, rounds) in PATHS.items():
        seen = bound_of(image, name, rounds, out)
        expect("dearest path of " + name, seen, seen == instructions)
    for name, instructions in SHORTEST.items():
        seen = bound_of(image, name, 0, out, shut=True)
        expect("shortest path of " + name, seen, seen == instructions)
    for name in ("leaf", "fused"):
        seen = elf.problems(image, out + ".map", [name])
        expect("faults of " + name, seen, bool(seen) == (name == "fused"))
    for f in failures:
        print("FAIL walk: " + f)
    if failures:
        sys.exit(1)
    print("ok the walkers of linked code see what stands in %d functions" % len(STACKS | FAULTS | PATHS | {"fused": 0}))


if __name__ == "__main__":
    main()
