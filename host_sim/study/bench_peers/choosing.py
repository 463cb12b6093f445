#!/usr/bin/env python3
"""Writes the tables and the plots of docs/choosing.md: what each choice costs, on one generated motion whose truth is known.

choosing.py PROGRAM PAGE PLOTS BOUNDS. PROGRAM is fairlead-sim; the tables between the page's marks are replaced, and PLOTS (an
SVG) is written by gnuplot. What a width costs on a core comes from BOUNDS (BOUNDS.md)."""
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


def measured(program, folder, truth, *options):
    """What the options cost: one row of numbers by name."""
    earlier = ["--earlier"] if "knots" in options else []
    chosen = {**USUAL, **dict(zip(options[::2], options[1::2]))}
    arguments = [x for pair in chosen.items() for x in pair]
    said = json.loads(run(program, "reduce", folder / "in.trk", *arguments, "--out", folder / "s.flr", "--json"))
    speed, bend = motion_errors(program, folder, folder / "s.flr", truth, earlier)
    p, r = said["position"], said["orientation"]
    return {"bytes": said["bytes_per_s"], "p": p["control_points"], "r": r["control_points"],
            "delay": p["mean_delay_samples"], "speed": 1e3 * speed, "bend": bend}


def table(head, choices):
    out = (f"| {head} | bytes a second | control points, position / orientation | mean delay, records "
           "| velocity error, mm/s rms | acceleration error, m/s2 rms |\n|---|---|---|---|---|---|\n")
    return out + "".join(f"| {name} | {m['bytes']:.1f} | {m['p']:,} / {m['r']:,} | {m['delay']:.0f} | {m['speed']:.1f} "
                         f"| {m['bend']:.2f} |\n" for name, _, m in choices)


def on_a_core(bounds):
    """Table of what the widths cost on a Cortex-M4F, from BOUNDS.md."""
    section = bounds.read_text(encoding="utf-8").split("## Cortex-M4F\n")[1].split("\n## ")[0]
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("|")]
    column = {name: i for i, name in enumerate(lines[0])}
    out = ("| width and kind, both channels, delay 120 | instructions of a push, mean | worst found | bytes of RAM | bytes of flash |\n"
           "|---|---|---|---|---|\n")
    for stage, name in (("narrow", "narrow, C1"), ("medium", "medium, C1"), ("wide", "wide, C1"),
                        ("cubic", "medium, C2 positions")):
        row = next(line for line in lines if line[0] == f"encode_{stage}_120")
        out += f"| {name} | {' | '.join(row[column[name]] for name in ('mean', 'worst found', 'RAM', 'flash'))} |\n"
    return out


WIDTHS = [("narrow, C1", 0, "--beam", "narrow"), ("medium, C1", 0, "--beam", "medium"), ("wide, C1", 0, "--beam", "wide"),
          ("medium, C2 positions", 0, "--continuity", 2),
          ("wide, C2 positions", 0, "--continuity", 2, "--beam", "wide"),
          ("earlier search, C2", 0, "--objective", "knots")]
DELAYS = [(str(d), d, "--delay", d) for d in (16, 32, 60, 120, 240)]
RESTARTS = ([("0: each frame alone", 0, "--restart", 0)] + [(str(s), s, "--restart", s) for s in (0.5, 1, 2, 5)] +
            [("never", math.nan, "--restart", 1000000)])
TOLERANCES = [(f"{mm} mm, {deg} deg", mm, "--tol-pos", mm / 1e3, "--tol-rot", math.radians(deg))
              for mm, deg in ((0.5, 0.125), (1, 0.25), (2, 0.5), (5, 1), (10, 2))]


def measure(program, folder):
    """For each kind of choice: (name, its number, what it costs)."""
    run(program, "generate", SPEC, "--seed", 1, "--out", folder / "in.trk", "--truth", folder / "truth.csv")
    truth = rows(folder / "truth.csv")
    return [[(name, number, measured(program, folder, truth, *options)) for name, number, *options in choices]
            for choices in (WIDTHS, DELAYS, RESTARTS, TOLERANCES)]


def panel(title, x_label, series, log=""):
    """One plot of gnuplot: series of (name, [(x, y)])."""
    blocks = "".join(f"$d{i} << E\n" + "".join(f"{x} {y}\n" for x, y in points) + "E\n" for i, (_, points) in enumerate(series))
    plots = ", ".join(f"$d{i} with linespoints pt 7 ps 0.6 title '{name}'" for i, (name, _) in enumerate(series))
    return (f"{blocks}set title '{title}'\nset xlabel '{x_label}'\nset ylabel 'bytes a second'\nunset logscale\n"
            f"{'set logscale ' + log if log else ''}\nset yrange [{1 if 'y' in log else 0}:*]\nplot {plots}\n")


def plots(path, made):
    """Bytes over each choice, and over the velocity error that comes with it."""
    widths, delays, restarts, tolerances = made
    over = lambda choices: [(number, m["bytes"]) for _, number, m in choices if not math.isnan(number)]
    speeds = lambda choices: sorted((m["speed"], m["bytes"]) for _, _, m in choices)
    script = (f"set terminal svg size 900,640 font 'sans,11' background 'white'\nset output '{path}'\nset grid\n"
              "set key top right\nset multiplot layout 2,2\n" +
              panel("delay", "records", [("medium", over(delays))]) +
              panel("restart interval", "s (0: each frame alone)", [("medium", over(restarts))]) +
              panel("tolerance", "mm (and a quarter of it in degrees, about)", [("medium", over(tolerances))], "xy") +
              panel("velocity error", "mm/s rms", [("by delay", speeds(delays)), ("by tolerance", speeds(tolerances)),
                                                   ("widths", speeds(widths[:3])), ("C2 positions", speeds(widths[3:5])),
                                                   ("earlier search, C2", speeds(widths[5:]))]) +
              "unset multiplot\n")
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def main():
    program, page, picture, bounds = (pathlib.Path(argument).resolve() for argument in sys.argv[1:5])
    with tempfile.TemporaryDirectory() as folder:
        made = measure(program, pathlib.Path(folder))
    plots(picture, made)
    heads = ("width and kind", "delay, records", "restart interval, s", "tolerance")
    tables = [table(head, choices) for head, choices in zip(heads, made)]
    tables.insert(1, on_a_core(bounds))
    text = page.read_text(encoding="utf-8")
    begin, end = "<!-- tables: make choosing -->\n", "<!-- end of tables -->"
    assert begin in text and end in text, f"{page} has no place for the tables"
    new = re.sub(re.escape(begin) + ".*?" + re.escape(end), lambda _: begin + "\n" + "\n".join(tables) + end, text, flags=re.DOTALL)
    page.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
