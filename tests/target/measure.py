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
import path as paths

STACK_SIZE = 8192  # what platform_core.cpp paints
ROOTS = ("subject_start", "subject_push", "subject_flush")


class Core:
    def __init__(self, name):
        for line in open("port/cortex_m/cores"):
            words = line.split("#")[0].split()
            if words and words[0] == name:
                self.name, self.compiler, self.machine = words[:3]
                self.prefix = self.compiler[:-len("g++")]
                self.on_host = self.machine == "-"
                self.soft_float = not self.on_host and any(w in words for w in ("-mfloat-abi=soft", "-mabi=ilp32"))
                return
        raise SystemExit("no core '%s' in port/cortex_m/cores" % name)

    def run(self, image, build, words, counts=None, heads=None, timeout=600):
        """Runs the image with its words; the counting plugin writes to counts and, for the loop heads, to heads."""
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
                command += ["-plugin", "%s/count.so,out=%s" % (build, counts) + (",heads=" + heads if heads else "")]
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


def static_facts(out, core, image):
    """The stack bound by disassembly, the rules that the image breaks, and what the stage adds to a bare image."""
    bare = elf.Image(out + ".bare.elf", core.prefix)
    facts, broken = {}, elf.problems(bare, out + ".bare.elf.map", ROOTS)
    try:
        bound, chain = max((image.bound(image.address[r]) for r in ROOTS), key=lambda b: b[0])
        facts.update(stack_bound=bound, stack_chain=chain)
        if bound > STACK_SIZE:
            broken.append("stack: the bound, %d bytes, is more than the %d that the tests give" % (bound, STACK_SIZE))
    except elf.Trouble as trouble:
        broken.append(str(trouble))
    flash, ram = elf.sizes(out + ".bare.elf", core.prefix)
    base_flash, base_ram = elf.sizes(os.path.dirname(out) + "/none.bare.elf", core.prefix)
    facts.update(flash=flash - base_flash, ram=ram - base_ram)
    return facts, broken


def measure_on_host(core, subject, build, words, out):
    core.run("%s/%s/%s.elf" % (build, core.name, subject), build, run_words(words, out))
    facts, streams = read_report(out + ".report")
    return {"core": core.name, "subject": subject, **facts, "streams": streams}, []


def run_words(words, out):
    return ["report=" + out + ".report", "digests=" + out + ".digests"] + words


def measure(core, subject, build, words, out):
    """What was seen on a core, and what is wrong with it."""
    stem = "%s/%s/%s" % (build, core.name, subject)
    image = elf.Image(stem + ".elf", core.prefix)
    facts, broken = static_facts(stem, core, image)
    if broken:
        return {}, broken
    graph = paths.Graph(image, image.address["subject_push"])
    with open(out + ".heads", "w") as file:
        file.writelines(graph.capped())
    core.run(stem + ".elf", build, run_words(words, out), out + ".counts", out + ".heads")
    seen, streams = read_report(out + ".report")
    counts = read_words(out + ".counts")
    if len(counts) != len(read_words(out + ".digests")):
        return {}, ["%d calls were counted" % len(counts)]
    result = {"core": core.name, "subject": subject, **seen, **facts, "streams": streams,
              **count_summary(streams, counts)}
    caps, parts = paths.read_caps(out + ".heads")
    call = 1  # the instruction that calls the stage
    result["push"]["bound"] = graph.bound(caps, out, parts) + call
    result["push"]["any_operands"] = graph.bound(caps, out, parts, any_operands=True) + call
    if result["stack"] > facts["stack_bound"]:
        broken.append("stack: %d bytes were used, the bound is %d" % (result["stack"], facts["stack_bound"]))
    if result["push"]["max"] > result["push"]["bound"]:
        broken.append("a push took %d instructions, the bound is %d" % (result["push"]["max"], result["push"]["bound"]))
    return result, broken


def stream_list(core, subject, out):
    """The streams for all stages and those that a search found for this one, in one file."""
    brief = any(line.split()[:2] == [subject, "brief"] for line in open("tests/target/stages"))
    general = ["brief"] if brief and core.soft_float else ["brief", "adverse"]
    with open(out + ".streams", "w") as file:
        for name in general + ["worst/" + subject]:
            if os.path.exists("tests/target/streams/" + name):
                file.write(open("tests/target/streams/" + name).read())
    return out + ".streams"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build/target")
    parser.add_argument("core")
    parser.add_argument("subject")
    options = parser.parse_args()
    core, subject = Core(options.core), options.subject
    out = "%s/%s/%s" % (options.build, core.name, subject)
    if os.path.exists(out + ".result"):
        os.remove(out + ".result")
    words = ["recipes=" + stream_list(core, subject, out)]
    result, broken = (measure_on_host if core.on_host else measure)(core, subject, options.build, words, out)
    for s in result.get("streams", []):
        if s["flushes"] >= 20000:
            broken.append("stream %s: flush never ends" % s["name"])
    if broken:
        sys.exit("\n".join("FAIL %s on %s: %s" % (subject, core.name, b) for b in broken))
    with open(out + ".result", "w") as file:
        json.dump(result, file, indent=1)


if __name__ == "__main__":
    main()
