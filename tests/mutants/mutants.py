#!/usr/bin/python3
"""Mutation testing of lib: changes one place of a header at a time and asks whether a test notices.

Mutants are drawn evenly over the folders of lib and over the operators (tests/mutants/sites.py), by a stated seed. For each,
the unit and law tests that include the header are compiled against the changed one, those of the same name first, and run
until one fails. Outcomes:
    killed       a test failed, or the compiler refused it by a static_assert
    timeout      a test ran several times longer than it does on the original: noticed, counted apart
    survived     all tests passed
    same code    the same machine code in every test: either it changes nothing, or no test uses the place; counts as survived
    stillborn    it does not compile for another reason; not counted
Survivors are listed with file and line. tests/mutants/explained.txt names those that change nothing that matters, each with
its reason; they are counted apart.

    tests/mutants/mutants.py --build build --archives "ARCHIVE..." --flags "$(HOST flags)" [--count 300] [--seed 1] [--folders base math] [--least 0.9]
"""
import argparse
import collections
import concurrent.futures
import hashlib
import os
import pathlib
import random
import re
import shlex
import subprocess
import sys
import tempfile
import time

import sites

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIB = ROOT / "lib/include/fairlead"
EXPLAINED = pathlib.Path(__file__).with_name("explained.txt")
SECONDS_MIN = 20
COUNTED = ("killed", "timeout", "survived", "same code")


class Tests:
    """The test sources, what each includes, and how it behaves on the original."""

    def __init__(self, args):
        self.compiler = [os.environ.get("CXX", "g++"), *shlex.split(args.flags), "-g0", "-w"]
        self.libraries = ["-Wl,--start-group", *args.archives, "-Wl,--end-group", "-lz", "-lgtest", "-lgtest_main"]
        self.work = args.build / "mutants"
        self.work.mkdir(parents=True, exist_ok=True)
        self.sources = sorted(p for folder in ("unit", "laws") for p in (ROOT / "tests" / folder).glob("*.cpp"))
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            self.includes = dict(zip(self.sources, pool.map(self.read_includes, self.sources)))
        self.baseline = {}

    def read_includes(self, source):
        said = subprocess.run([*self.compiler, "-MM", str(source)], capture_output=True, text=True, check=True, cwd=ROOT).stdout
        return {(ROOT / name).resolve() for name in said.replace("\\\n", " ").split()[1:]}

    def of(self, header):
        """The tests that include a header: those that are named like it first, then the cheap ones."""
        def order(source):
            name = source.stem.removeprefix("test_")
            near = 0 if name == header.stem else 1 if header.stem.startswith(name) or name.startswith(header.stem) else 2
            return near, len(self.includes[source]), source.name
        return sorted((s for s in self.sources if header.resolve() in self.includes[s]), key=order)

    def compile(self, source, overlay, out):
        """@return the compiler's output when it refuses, else None."""
        command = [*self.compiler, *([f"-I{overlay}"] if overlay else [])]
        # the overlay must come before the library's own folder
        command = [command[0], *([f"-I{overlay}"] if overlay else []), *self.compiler[1:], "-c", str(source), "-o", str(out)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
        return done.stderr if done.returncode else None

    def run(self, objects, seconds):
        """Links and runs one test. @return 'passed', 'failed' or 'timeout'."""
        program = objects.with_suffix(".run")
        link = [self.compiler[0], str(objects), *self.libraries, "-pthread", "-o", str(program)]
        subprocess.run(link, check=True, capture_output=True, cwd=ROOT)
        try:
            done = subprocess.run([str(program), "--gtest_fail_fast", "--gtest_brief=1"], capture_output=True, cwd=ROOT,
                                  timeout=seconds)
            return "failed" if done.returncode else "passed"
        except subprocess.TimeoutExpired:
            return "timeout"
        finally:
            program.unlink(missing_ok=True)

    def on_original(self, source):
        """(digest of its machine code, seconds that it runs) without a mutation; made once."""
        if source not in self.baseline:
            out = self.work / f"{source.stem}.o"
            refused = self.compile(source, None, out)
            if refused:
                raise SystemExit(f"FAIL {source} does not compile:\n{refused[-2000:]}")
            start = time.monotonic()
            if self.run(out, 600) != "passed":
                raise SystemExit(f"FAIL {source} fails on the original")
            self.baseline[source] = (digest(out), time.monotonic() - start)
        return self.baseline[source]


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def draw(folders, count, seed):
    """Mutants, evenly over folders and operators."""
    chance = random.Random(seed)
    pools = {}
    for folder in folders:
        for header in sorted((LIB / folder).glob("*.hpp")) if folder != "." else sorted(LIB.glob("*.hpp")):
            for site in sites.sites(header.read_text(encoding="utf-8")):
                pools.setdefault(folder, {}).setdefault(site[0], []).append((header, site))
    for by_operator in pools.values():
        for pool in by_operator.values():
            chance.shuffle(pool)
    chosen, turn = [], 0
    while len(chosen) < count and any(p for by in pools.values() for p in by.values()):
        folder = folders[turn % len(folders)]
        by_operator = pools.get(folder, {})
        operators = [o for o in sites.OPERATORS if by_operator.get(o)]
        if operators:
            chosen.append((folder, *by_operator[operators[turn // len(folders) % len(operators)]].pop()))
        turn += 1
    return chosen


def judge(tests, mutant):
    """@return (outcome, by which test)"""
    _, header, site = mutant
    text = header.read_text(encoding="utf-8")
    same_code = True
    with tempfile.TemporaryDirectory(dir=tests.work) as folder:
        overlay = pathlib.Path(folder)
        changed = overlay / header.relative_to(LIB.parent)
        changed.parent.mkdir(parents=True)
        changed.write_text(sites.mutated(text, site), encoding="utf-8")
        for source in tests.of(header):
            code, seconds = tests.on_original(source)
            out = overlay / f"{source.stem}.o"
            refused = tests.compile(source, overlay, out)
            if refused is not None:
                return ("killed" if "static assertion failed" in refused else "stillborn"), source.stem
            if digest(out) == code:
                continue
            same_code = False
            ran = tests.run(out, SECONDS_MIN + 5 * seconds)
            if ran != "passed":
                return ("killed" if ran == "failed" else "timeout"), source.stem
            out.unlink()
    return ("same code" if same_code else "survived"), ""


def describe(mutant):
    """One line: file, line number, operator, the line before and after."""
    _, header, site = mutant
    text = header.read_text(encoding="utf-8")
    operator, at, old, new = site
    line = text.count("\n", 0, at) + 1
    begin = text.rfind("\n", 0, at) + 1
    before = text[begin:text.find("\n", at)].strip()
    flat = " ".join(new.split())
    return f"{header.relative_to(LIB)}:{line} [{operator}] {' '.join(old.split())!r} -> {flat!r} in: {before}"


def explained():
    """Texts of mutants that are explained: lines 'file: old -> new in: line # reason'; line numbers may move."""
    if not EXPLAINED.exists():
        return set()
    lines = EXPLAINED.read_text(encoding="utf-8").splitlines()
    return {line.split(" # ")[0].strip() for line in lines if line.strip() and not line.startswith("#")}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build"))
    parser.add_argument("--archives", type=str.split, required=True, help="what the tests link")
    parser.add_argument("--flags", required=True)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--least", type=float, default=0.0, help="fail below this share of killed mutants")
    parser.add_argument("--minutes", type=float, default=1e9, help="draw no new mutant after this time")
    parser.add_argument("--folders", nargs="+", default=["base", "math", "sense", "smooth"])
    args = parser.parse_args()
    tests = Tests(args)
    known = explained()
    chosen = draw(args.folders, args.count, args.seed)
    print(f"{len(chosen)} mutants of {', '.join(args.folders)}, seed {args.seed}", flush=True)
    outcomes, survivors = collections.defaultdict(collections.Counter), []
    end = time.monotonic() + 60 * args.minutes

    def one(mutant):
        return (mutant, *(judge(tests, mutant) if time.monotonic() < end else ("not run", "")))

    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for mutant, outcome, by in pool.map(one, chosen):
            if outcome == "not run":
                continue
            text = describe(mutant)
            if outcome in ("survived", "same code") and re.sub(r":\d+ \[[^]]*\]", ":", text) in known:
                outcome = "explained"
            outcomes[mutant[0]][outcome] += 1
            if outcome in ("survived", "same code"):
                survivors.append(text + (" (same machine code)" if outcome == "same code" else ""))
            print(f"{outcome:9} {text}{' (by ' + by + ')' if by else ''}", flush=True)
    kinds = ["killed", "timeout", "survived", "explained", "same code", "stillborn"]
    print("\n" + f"{'folder':10}" + "".join(f"{k:>11}" for k in kinds) + "   killed of counted")
    total = collections.Counter()
    for folder in args.folders:
        total.update(outcomes[folder])
    for folder, counts in [*outcomes.items(), ("all", total)]:
        counted = sum(counts[k] for k in COUNTED)
        share = (counts["killed"] + counts["timeout"]) / counted if counted else 1
        print(f"{folder:10}" + "".join(f"{counts[k]:11}" for k in kinds) + f"   {share:.3f}")
    print(f"\n{len(survivors)} survivors" + "".join("\n  " + s for s in survivors))
    counted = sum(total[k] for k in COUNTED)
    noticed = total["killed"] + total["timeout"]
    if counted and noticed / counted < args.least:
        print(f"FAIL mutants: {noticed} of {counted} noticed, at least {args.least:.0%} are asked")
        sys.exit(1)
    print(f"ok mutants: {noticed} of {counted} noticed")


if __name__ == "__main__":
    main()
