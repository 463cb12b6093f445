"""The budgets of tests/target/budgets, the figures that they are held to, and where the RAM of a pipeline goes."""
import json
import re
import subprocess

import elf

PATH = "tests/target/budgets"
PREFIX = "arm-none-eabi-"
PARTS = (("intake", "intake"), ("filter", "filter, 9 taps"), ("grid", "sample period and grid"),
         ("position", "position: search, samples, committed pieces"),
         ("orientation", "orientation: search, samples, committed pieces"), ("frames", "coder, frames, headers, output"),
         ("all", "the whole pipeline"))
STAGES = (("orientation_32", "orientation, medium, 32"), ("orientation_120", "orientation, medium, 120"),
          ("narrow_32", "both, narrow, 32"), ("narrow_120", "both, narrow, 120"), ("medium_120", "both, medium, 120"),
          ("wide_120", "both, wide, 120"))


def read(path=PATH):
    """{name: (target, budget, what)} in the order of the file."""
    rows = [line.split(None, 3) for line in open(path) if line.strip() and not line.startswith("#")]
    return {name: (int(target), int(budget), what.strip()) for name, target, budget, what in rows}


def of_the_stream(stage):
    """Encoders and pipelines: how tight their bounds are is a budget."""
    return stage.startswith(("encode_", "pipeline_"))


def of_the_attitude(stage):
    return stage.startswith("attitude")


def tight(stage):
    """How many times the worst found a bound may be, where that is a budget; else None."""
    if of_the_stream(stage):
        return read()["bound_percent"][1] / 100
    return read()["attitude_percent"][1] / 100 if of_the_attitude(stage) else None


def figures(build):
    """{name: the figure now}."""
    def stage(name):
        return json.load(open("%s/m4f/%s.result" % (build, name)))

    def flash(name):
        return elf.sizes("%s/small/%s.elf" % (build, name), PREFIX)[0]
    both = stage("encode_medium_120")
    def percent(chosen, core):
        pushes = [json.load(open("%s/%s/%s.result" % (build, core, line.split()[0])))["push"]
                  for line in open("tests/target/stages") if chosen(line)]
        return max(-(-100 * p["bound"] // p["max"]) for p in pushes)
    return {"push_mean": int(both["push"]["mean"] + 0.5), "push_dearest": both["push"]["max"], "ram_both_120": both["ram"],
            "ram_orientation_120": stage("encode_orientation_120")["ram"],
            "ram_orientation_32": stage("encode_orientation_32")["ram"], "ram_decoder": stage("decode")["ram"],
            "flash_firmware": elf.sizes(build + "/firmware/firmware.elf", PREFIX)[0],
            "flash_decoder": flash("decode") - flash("none"),
            "bound_percent": percent(of_the_stream, "m4f"), "attitude_percent": percent(of_the_attitude, "m4f")}


def parts(build):
    """{(stage, part): bytes}"""
    out = subprocess.run([PREFIX + "nm", "-S", build + "/small/parts.o"], capture_output=True, text=True, check=True).stdout
    found = re.findall(r"^\S+ (\S+) \w (\w+)__(\w+)$", out, re.M)
    return {(stage, part): int(size, 16) - 1 for size, stage, part in found}


def tables(build):
    """The sections of BOUNDS.md."""
    now = figures(build)
    text = ("\n## Budgets\n\nOn a Cortex-M4F. A figure above its budget fails `make bounds`; the target is what the design "
            "asks for (`tests/target/budgets`).\n\n| what | now | budget | target |\n|---|---:|---:|---:|\n")
    for name, (target, budget, what) in read().items():
        text += "| %s | %s | %s | %s |\n" % (what, *(format(n, ",") for n in (now[name], budget, target)))
    size = parts(build)
    text += ("\n## Where the RAM of a pipeline goes\n\nBytes on a Cortex-M4F, by channels, beam and delay (`tests/target/parts.cpp`).\n\n"
             "| part | %s |\n|---%s|\n" % (" | ".join(title for _, title in STAGES), "|---:" * len(STAGES)))
    for part, title in PARTS:
        text += "| %s | %s |\n" % (title, " | ".join(format(size[s, part], ",") for s, _ in STAGES))
    return text


def exceeded(build):
    now = figures(build)
    return ["%s: %d, the budget is %d" % (what, now[name], budget) for name, (_, budget, what) in read().items()
            if now[name] > budget]
