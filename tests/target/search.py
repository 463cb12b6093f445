#!/usr/bin/env python3
"""Looks for the stream that makes one push of a stage dearest: mutates stream recipes, runs them in the emulator with
the counting plugin, keeps the dearest, again and again. Seeded: the same call finds the same stream. With --keep the
winner joins tests/target/streams/worst/SUBJECT, from where every later measurement replays it. A stream that takes more than
the measured bound disproves it: that fails."""
import argparse
import json
import os
import random

from measure import Core, read_report, read_words

KINDS = "rest line walk noise zigzag flip gap jitter tiny huge wild".split()
RECORDS_MAX, BATCH, PARENTS = 300, 24, 8
NEWCOMERS = 4  # one of so many has no parent, so that a pool of cousins is not the end


class Recipe:
    def __init__(self, seed, rate_hz, segments):
        self.seed, self.rate_hz, self.segments = seed, rate_hz, segments  # (kind, length, move, turn, pace)

    def line(self, name):
        return "%s %d %d %s" % (name, self.seed, self.rate_hz, " ".join(":".join(map(str, s)) for s in self.segments))

    @staticmethod
    def parse(line):
        words = line.split()
        segments = [tuple(p if i == 0 else int(p) for i, p in enumerate(w.split(":"))) for w in words[3:]]
        return Recipe(int(words[1]), int(words[2]), segments)


def read_recipes(path):
    if not os.path.exists(path):
        return []
    return [Recipe.parse(line) for line in open(path) if line.strip() and not line.startswith("#")]


def random_segment(dice):
    size = lambda top: dice.randrange(1 << dice.randrange(1, top))
    return (dice.choice(KINDS), 1 + size(8), size(16), size(23), 1 + size(6))


def random_recipe(dice):
    return Recipe(1 + dice.randrange(1 << 30), 120, [random_segment(dice) for _ in range(1 + dice.randrange(6))])


def changed_number(dice, value, low):
    way = dice.randrange(4)
    new = (value * 2, value // 2, value + dice.randrange(-3, 4), dice.randrange(1 << dice.randrange(1, 23)))[way]
    return max(low, min(new, (1 << 23) - 1))


def mutated(dice, parents):
    parent = random_recipe(dice) if dice.randrange(NEWCOMERS) == 0 else dice.choice(parents)
    seed, rate_hz, segments = parent.seed, parent.rate_hz, list(parent.segments)
    for _ in range(1 + dice.randrange(3)):
        way, at = dice.randrange(7), dice.randrange(len(segments))
        if way == 0:
            segments.insert(at, random_segment(dice))
        elif way == 1 and len(segments) > 1:
            del segments[at]
        elif way == 2:
            segments.insert(at, dice.choice(dice.choice(parents).segments))
        elif way == 3:
            segments[at] = (dice.choice(KINDS),) + segments[at][1:]
        elif way == 4:
            seed = 1 + dice.randrange(1 << 30)
        elif way == 5:
            other = dice.choice(parents).segments
            segments = segments[:at + 1] + other[dice.randrange(len(other)):]
        else:
            field = 1 + dice.randrange(4)
            s = list(segments[at])
            s[field] = changed_number(dice, s[field], 1 if field in (1, 4) else 0)
            segments[at] = tuple(s)
    kept, records = [], 0
    for s in segments[:12]:
        length = min(s[1], RECORDS_MAX - records)
        if length > 0:
            kept.append((s[0], length) + s[2:])
            records += length
    return Recipe(seed, rate_hz, kept)


def evaluate(core, subject, build, recipes):
    """The dearest push of each recipe."""
    out = "%s/%s/%s.search" % (build, core.name, subject)
    with open(out, "w") as file:
        file.writelines(r.line("s%d" % i) + "\n" for i, r in enumerate(recipes))
    core.run("%s/%s/%s.elf" % (build, core.name, subject), build,
             ["report=" + out + ".report", "digests=" + out + ".digests", "recipes=" + out], out + ".counts")
    counts = read_words(out + ".counts")
    return [max(counts[s["first"]:s["first"] + s["pushes"]], default=0) for s in read_report(out + ".report")[1]]


def search(core, subject, build, recipes, budget, seed, target=None):
    """(most instructions of a push, its recipe, runs spent)."""
    dice, spent = random.Random(seed), len(recipes)
    pool = sorted(zip(evaluate(core, subject, build, recipes), recipes), key=lambda p: -p[0])
    while spent < budget and (target is None or pool[0][0] < target):
        batch = [mutated(dice, [r for _, r in pool[:PARENTS]]) for _ in range(BATCH)]
        pool = sorted(pool + list(zip(evaluate(core, subject, build, batch), batch)), key=lambda p: -p[0])[:4 * PARENTS]
        spent += len(batch)
    return pool[0][0], pool[0][1], spent


def known_bound(build, core, subject):
    """The bound of the last measurement, or None."""
    path = "%s/%s/%s.result" % (build, core, subject)
    return json.load(open(path))["push"]["bound"] if os.path.exists(path) else None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", default="build/target")
    parser.add_argument("--core", default="m4f")
    parser.add_argument("--budget", type=int, default=1200, help="streams to try")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--must-reach", type=int, help="fail unless a push of so many instructions is found")
    parser.add_argument("subject")
    o = parser.parse_args()
    kept_path = "tests/target/streams/worst/" + o.subject
    recipes = read_recipes("tests/target/streams/adverse") + read_recipes(kept_path)
    before = max(evaluate(Core(o.core), o.subject, o.build, recipes))
    most, recipe, spent = search(Core(o.core), o.subject, o.build, recipes, o.budget, o.seed, o.must_reach)
    print("%s on %s: %d instructions in the streams of the tree, %d after %d streams (seed %d)" %
          (o.subject, o.core, before, most, spent, o.seed))
    if o.must_reach:
        reached = most >= o.must_reach > before
        print("%s search finds the planted branch" % ("ok" if reached else "FAIL"))
        raise SystemExit(not reached)
    if o.keep and most > before:
        os.makedirs(os.path.dirname(kept_path), exist_ok=True)
        with open(kept_path, "a") as file:
            file.write(recipe.line("worst-%s-%d" % (o.core, most)) + "\n")
    bound = known_bound(o.build, o.core, o.subject)
    if bound is not None and most > bound:
        raise SystemExit("FAIL %s on %s: the stream '%s' takes %d instructions, the bound is %d" %
                         (o.subject, o.core, recipe.line("dear"), most, bound))


if __name__ == "__main__":
    main()
