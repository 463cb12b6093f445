#!/usr/bin/env python3
"""Writes the tables of docs/choosing.md: what each choice costs, on one generated motion of which the truth is known.

choosing.py PROGRAM PAGE. PROGRAM is fairlead-sim; the tables between the page's marks are replaced."""
import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

SPEC = "model:optical+rest:2+reach:0.9:12+oscillate:6:1.5+reach:0.7:8+turn:1.2:12+rest:4"
STEP_NS = 4_000_000  # of the differences that velocity and acceleration are measured by
USUAL = {"--tol-pos": 0.001, "--tol-rot": 0.0043633, "--delay": 120, "--restart": 2}


def run(program, *arguments):
    return subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def rows(path):
    with open(path, newline="", encoding="ascii") as file:
        return [[float(x) if x else math.nan for x in row] for row in list(csv.reader(file))[1:]]


def positions(program, folder, stream, times, earlier):
    """The decoded position at times in ns."""
    at = folder / "at.csv"
    at.write_text("t_ns,px,py,pz,qw,qx,qy,qz\n" + "".join(f"{t},0,0,0,1,0,0,0\n" for t in times), encoding="ascii")
    run(program, "decode", stream, "--at", at, "--out", folder / "d.csv", *earlier)
    return [row[1:4] for row in rows(folder / "d.csv")]


def rms(errors):
    good = [e for e in errors if not math.isnan(e)]
    return math.sqrt(sum(e * e for e in good) / len(good))



def motion_errors(program, folder, stream, truth, earlier):
    """Root mean square of the errors of velocity, m/s, and acceleration, m/s2, within the motion."""
    inner = range(2, len(truth) - 2)
    times = [int(truth[i][0]) for i in inner]
    before, now, after = (positions(program, folder, stream, [t + d for t in times], earlier)
                          for d in (-STEP_NS, 0, STEP_NS))
    speed, bend = [], []
    for n, i in enumerate(inner):
        a, b, c = (truth[i + d][1:4] for d in (-1, 0, 1))
        h = (truth[i + 1][0] - truth[i - 1][0]) * 0.5e-9
        s = STEP_NS * 1e-9
        for k in range(3):
            speed.append((after[n][k] - before[n][k]) / (2 * s) - (c[k] - a[k]) / (2 * h))
            bend.append((after[n][k] - 2 * now[n][k] + before[n][k]) / s**2 - (c[k] - 2 * b[k] + a[k]) / h**2)
    return rms(speed), rms(bend)


def measured(program, folder, truth, name, *options):
    earlier = ["--earlier"] if "knots" in options else []
    chosen = {**USUAL, **dict(zip(options[::2], options[1::2]))}
    arguments = [x for pair in chosen.items() for x in pair]
    said = json.loads(run(program, "reduce", folder / "in.trk", *arguments, "--out", folder / "s.flr", "--json"))
    speed, bend = motion_errors(program, folder, folder / "s.flr", truth, earlier)
    p, r = said["position"], said["orientation"]
    return (f"| {name} | {said['bytes_per_s']:.1f} | {p['control_points']:,} / {r['control_points']:,} "
            f"| {p['mean_delay_samples']:.0f} | {1e3 * speed:.1f} | {bend:.2f} |\n")


def table(program, folder, truth, head, choices):
    out = (f"| {head} | bytes a second | control points, position / orientation | mean delay, records "
           "| velocity error, mm/s rms | acceleration error, m/s2 rms |\n|---|---|---|---|---|---|\n")
    return out + "".join(measured(program, folder, truth, *choice) for choice in choices)


def tables(program, folder):
    run(program, "generate", SPEC, "--seed", 1, "--out", folder / "in.trk", "--truth", folder / "truth.csv")
    truth = rows(folder / "truth.csv")
    make = lambda head, choices: table(program, folder, truth, head, choices)
    return "\n".join((
        make("width and kind", [("narrow, C1", "--beam", "narrow"), ("medium, C1", "--beam", "medium"),
                                ("wide, C1", "--beam", "wide"),
                                ("earlier search, C2", "--objective", "knots")]),
        make("delay, records", [(str(d), "--delay", d) for d in (16, 32, 60, 120, 240)]),
        make("restart interval, s", [("0: each frame alone", "--restart", 0)] +
             [(str(s), "--restart", s) for s in (0.5, 1, 2, 5)] + [("never", "--restart", 1000000)]),
        make("tolerance", [(f"{mm} mm, {deg} deg", "--tol-pos", mm / 1e3, "--tol-rot", math.radians(deg))
                           for mm, deg in ((0.5, 0.125), (1, 0.25), (2, 0.5), (5, 1), (10, 2))])))


def main():
    program, page = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        made = tables(program, pathlib.Path(folder))
    text = page.read_text(encoding="utf-8")
    begin, end = "<!-- tables: make choosing -->\n", "<!-- end of tables -->"
    assert begin in text and end in text, f"{page} has no place for the tables"
    new = re.sub(re.escape(begin) + ".*?" + re.escape(end), lambda _: f"{begin}\n{made}{end}", text, flags=re.DOTALL)
    page.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
