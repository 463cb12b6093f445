#!/usr/bin/env python3
"""Runs one stage on one machine over streams and writes what was seen to BUILD/CORE/SUBJECT.result (JSON): digests,
instruction counts, stack, flash, RAM. Fails where the linked image breaks a rule of the library."""
import argparse
import array
import json
import os
import subprocess
import sys

import elf

ROOTS = ("subject_start", "subject_push", "subject_flush")


class Core:
    def __init__(self, name):
        for line in open("port/cortex_m/cores"):
            words = line.split("#")[0].split()
            if words and words[0] == name:
                self.name, self.compiler, self.machine = words[:3]
                self.prefix = self.compiler[:-len("g++")]
                self.on_host = self.machine == "-"
                return
        raise SystemExit("no core '%s' in port/cortex_m/cores" % name)

    def run(self, image, build, words, counts=None, timeout=600):
        """Runs the image with its words; the counting plugin writes to counts."""
        if self.on_host:
            command = [image] + words
        else:
            system = "qemu-system-riscv32" if self.prefix.startswith("riscv") else "qemu-system-arm"
            given = ",".join("arg=" + w for w in ["run"] + words)
            command = [system, "-M", self.machine, "-nographic", "-monitor", "none", "-serial", "none",
                       "-semihosting-config", "enable=on,target=native," + given]
            if self.prefix.startswith("riscv"):
                command += ["-bios", "none"]
                if "rv32imac" == self.name:
                    command += ["-cpu", "rv32,f=false,d=false"]
            if counts:
                command += ["-plugin", "%s/count.so,out=%s" % (build, counts)]
            command += ["-kernel", image]
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
        if done.returncode != 0:
            raise SystemExit("%s on %s: exit code %d\n%s" % (image, self.name, done.returncode, done.stderr.strip()))


def read_report(path):
    streams, subject = [], {}
    for line in open(path):
        words = line.split()
        if words[0] == "stream":
            entry = {"name": words[1]}
            entry.update({k: int(v) for k, v in zip(words[2::2], words[3::2])})
            streams.append(entry)
        elif words[0] == "subject":
            head, _, text = line.partition(" text ")
            subject = {k: int(v) for k, v in zip(head.split()[1::2], head.split()[2::2])}
            subject["text"] = text.strip()
        else:
            raise SystemExit("%s: %s" % (path, line.strip()))
    return subject, streams


def read_words(path):
    words = array.array("I")
    words.frombytes(open(path, "rb").read())
    return words


def call_name(streams, index):
    """Which stream and record a call of that index was."""
    for s in streams:
        n = index - s["first"]
        if 0 <= n < s["pushes"] + s["flushes"]:
            return s["name"], ("push %d" % n) if n < s["pushes"] else ("flush %d" % (n - s["pushes"]))
    return "?", "call %d" % index


def count_summary(streams, counts):
    """min, mean, max of pushes and of flushes, and which call was the dearest."""
    pushes, flushes = [], []
    for s in streams:
        first, last = s["first"], s["first"] + s["pushes"]
        pushes += [(counts[i], i) for i in range(first, last)]
        flushes += [(counts[i], i) for i in range(last, last + s["flushes"])]
    result = {}
    for kind, seen in (("push", pushes), ("flush", flushes)):
        if seen:
            most, at = max(seen, key=lambda c: (c[0], -c[1]))
            stream, call = call_name(streams, at)
            result[kind] = {"min": min(seen)[0], "mean": sum(c for c, _ in seen) / len(seen), "max": most,
                            "stream": stream, "call": call}
    return result


def static_facts(out, core):
    """The stack bound by disassembly, the rules that the image breaks, and what the stage adds to a bare image."""
    image = elf.Image(out + ".elf", core.prefix)
    bare = elf.Image(out + ".bare.elf", core.prefix)
    facts, broken = {}, elf.problems(bare, out + ".bare.elf.map", ROOTS)
    try:
        bound, chain = max((image.bound(image.address[r]) for r in ROOTS), key=lambda b: b[0])
        facts.update(stack_bound=bound, stack_chain=chain)
    except elf.Trouble as trouble:
        broken.append(str(trouble))
    flash, ram = elf.sizes(out + ".bare.elf", core.prefix)
    base_flash, base_ram = elf.sizes(os.path.dirname(out) + "/none.bare.elf", core.prefix)
    facts.update(flash=flash - base_flash, ram=ram - base_ram)
    return facts, broken


def measure(core, subject, build, words, out):
    image = "%s/%s/%s.elf" % (build, core.name, subject)
    counts = None if core.on_host else out + ".counts"
    core.run(image, build, ["report=" + out + ".report", "digests=" + out + ".digests"] + words, counts)
    facts, streams = read_report(out + ".report")
    result = {"core": core.name, "subject": subject, **facts, "streams": streams}
    if counts:
        seen = read_words(counts)
        if len(seen) != len(read_words(out + ".digests")):
            raise SystemExit("%s on %s: %d calls were counted" % (subject, core.name, len(seen)))
        result.update(count_summary(streams, seen))
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build/target")
    parser.add_argument("--streams", default="tests/target/streams/adverse")
    parser.add_argument("core")
    parser.add_argument("subject")
    options = parser.parse_args()
    core, subject = Core(options.core), options.subject
    out = "%s/%s/%s" % (options.build, core.name, subject)
    if os.path.exists(out + ".result"):
        os.remove(out + ".result")
    result = measure(core, subject, options.build, ["recipes=" + options.streams], out)
    broken = []
    if not core.on_host:
        facts, broken = static_facts(out, core)
        result.update(facts)
        if "stack_bound" in facts and result["stack"] > facts["stack_bound"]:
            broken.append("stack: %d bytes were used, the bound is %d" % (result["stack"], facts["stack_bound"]))
    for s in result["streams"]:
        if s["flushes"] >= 20000:
            broken.append("stream %s: flush never ends" % s["name"])
    if broken:
        sys.exit("\n".join("FAIL %s on %s: %s" % (subject, core.name, b) for b in broken))
    with open(out + ".result", "w") as file:
        json.dump(result, file, indent=1)


if __name__ == "__main__":
    main()
