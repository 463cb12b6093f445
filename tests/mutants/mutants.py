#!/usr/bin/python3
"""Mutation testing of lib: changes one place of a header at a time and asks whether a test notices.

Mutants are drawn evenly over the folders of lib and over the operators (tests/mutants/sites.py), by a stated seed. All become
switches in one compilation of each unit and law test that includes a changed header (together.py); the tests that meet a switch
run with it on, the likeliest first, until one fails. What the compiler evaluates itself, or what cannot be a switch, is compiled
alone (suite.py), with the tests in which the compiler evaluates it. Outcomes:
    killed       a test failed, or the compiler refused it by a static_assert
    timeout      a test took several times the processor time that it takes on the original: noticed, counted apart
    survived     all tests passed
    not reached  no test executes the place; counts as survived
    stillborn    it does not compile for another reason; not counted
Survivors are listed with file and line. tests/mutants/explained.txt names those that change nothing that matters, each with
its reason; they are counted apart.

    tests/mutants/mutants.py --build build --link OBJECTS_AND_ARCHIVES --flags FLAGS [--count 320] [--seed 1] [--folders base math] [--least 0.9]
    ... --match 'math/quat.hpp' 'crc32.hpp:12 '   judges only those of the draw whose line holds one of the texts
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import random
import re
import sys
import time

import sites
from suite import ROOT, Suite
from together import Together

LIB = ROOT / "lib/include/fairlead"
EXPLAINED = pathlib.Path(__file__).with_name("explained.txt")
SURVIVED = ("survived", "not reached")
COUNTED = ("killed", "timeout", *SURVIVED)
KINDS = (*COUNTED, "explained", "stillborn")


def draw(folders, count, seed):
    """Mutants, evenly over folders and operators."""
    chance = random.Random(seed)
    pools = {}
    for folder in folders:
        for header in sorted((LIB / folder).glob("*.hpp")):
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


def describe(mutant):
    """One line: file, line number, operator, the text before and after, the whole line."""
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


def table(outcomes, folders):
    """Prints the counts by folder. @return (noticed, counted) of all."""
    rows = [*((f, outcomes[f]) for f in folders), ("all", sum(outcomes.values(), collections.Counter()))]
    print("\n" + f"{'folder':10}" + "".join(f"{k:>11}" for k in KINDS) + "   killed of counted")
    for folder, counts in rows:
        counted = sum(counts[k] for k in COUNTED)
        noticed = counts["killed"] + counts["timeout"]
        print(f"{folder:10}" + "".join(f"{counts[k]:11}" for k in KINDS) + f"   {noticed / counted if counted else 1:.3f}")
    return noticed, counted


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path("build"))
    parser.add_argument("--link", type=str.split, required=True, help="what the tests link besides")
    parser.add_argument("--flags", required=True)
    parser.add_argument("--count", type=int, default=320)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--least", type=float, default=0.0, help="fail below this share of killed mutants")
    parser.add_argument("--minutes", type=float, default=1e9, help="begin no new mutant after this time")
    parser.add_argument("--folders", nargs="+", default=["base", "math", "sense", "smooth", "curve", "code", "reduce", "wire"])
    parser.add_argument("--match", nargs="+", default=[""], help="judge only those of the draw whose line holds one of these")
    args = parser.parse_args()
    suite = Suite(args.build.resolve(), args.flags, args.link, args.jobs)
    known = explained()
    chosen = [m for m in draw(args.folders, args.count, args.seed) if any(t in describe(m) for t in args.match)]
    print(f"{len(chosen)} mutants of {', '.join(args.folders)}, seed {args.seed}", flush=True)
    outcomes, survivors = collections.defaultdict(collections.Counter), []
    end = time.monotonic() + 60 * args.minutes
    together = Together(suite, LIB, [(header, site) for _, header, site in chosen], args.jobs)
    print(f"{len(together.spans)} of them as switches in {len(together.tests)} tests", flush=True)

    alone = [k for k in range(1, len(chosen) + 1) if k not in together.spans]

    def one(judge, k):
        folder, text = chosen[k - 1][0], describe(chosen[k - 1])
        if time.monotonic() > end:
            return
        outcome, by = judge(k)
        if outcome is None:
            alone.append(k)
            return
        if outcome in SURVIVED:
            if re.sub(r":\d+ \[[^]]*\]", ":", text) in known:
                outcome = "explained"
            else:
                survivors.append(text + ("" if outcome == "survived" else f" ({outcome})"))
        outcomes[folder][outcome] += 1
        print(f"{outcome:11} {text}{' (by ' + by + ')' if by else ''}", flush=True)

    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        try:
            # compilations of their own come last: most of the table is known soon
            list(pool.map(lambda k: one(together.judge_switch, k), list(together.spans)))
            list(pool.map(lambda k: one(together.judge_alone, k), alone))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    noticed, counted = table(outcomes, args.folders)
    print(f"\n{len(survivors)} survivors" + "".join("\n  " + s for s in sorted(survivors)))
    if counted and noticed / counted < args.least:
        print(f"FAIL mutants: {noticed} of {counted} noticed, at least {args.least:.0%} are asked")
        sys.exit(1)
    print(f"ok mutants: {noticed} of {counted} noticed")


if __name__ == "__main__":
    main()
