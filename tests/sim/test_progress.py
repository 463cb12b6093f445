#!/usr/bin/env python3
"""Progress of every command that can last: lines on a terminal from its start to its end, none in a pipe.

FAIRLEAD_PROGRESS_AFTER=0 shows the first line at once instead of after two seconds, so that short work tells
where long work would be silent. The longest silence is compared with the command's own duration, not with a clock.
"""
import os
import pty
import re
import select
import subprocess
import time

from simulator import PROGRAM, ROOT, main, must

SILENT_SHARE, SILENT_S = 0.45, 0.45  # a stage without a line is longer than both
TRIES = 3  # a machine that is busy with other things may stop any program for a while, but not at the same place
LINE = re.compile(rb"\x1b\[K([a-z ,]+): (?: *\d+ %, )?[\d.]+( [kM])? [a-z]+/s(, [\d hmins]+ left)?")


def on_terminal(*arguments):
    """Exit code, the stages that were shown, the longest silence and the duration in seconds."""
    ours, theirs = pty.openpty()
    start = time.monotonic()
    with subprocess.Popen([ROOT / PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                          stderr=theirs, env={**os.environ, "FAIRLEAD_PROGRESS_AFTER": "0"}) as program:
        os.close(theirs)
        text, times = b"", [start]
        while True:
            if select.select([ours], [], [], 0.02)[0]:
                try:
                    part = os.read(ours, 65536)
                except OSError:  # the other side is closed
                    break
                text += part
                if b"/s" in part:
                    times.append(time.monotonic())
        program.wait()
    os.close(ours)
    times.append(time.monotonic())
    stages = [m.group(1).decode() for m in LINE.finditer(text)]
    assert all(m.group(3) or m.group().endswith(b" 0.0 " + m.group().split()[-1]) for m in LINE.finditer(text)), text
    return program.returncode, stages, max(b - a for a, b in zip(times, times[1:])), times[-1] - start


def commands(folder):
    """(stages, arguments) of each command, on about as many records as three minutes of an IMU give."""
    imu, poses, text = folder / "in.imu", folder / "in.trk", folder / "in.csv"
    must("generate", "model:lsm6dso+rate:285.714+rest:30+oscillate:170:0.7:0.2:0.6", "--seed", 1, "--out", imu)
    must("generate", "model:optical+rate:285.714+oscillate:200:0.7:0.2:0.6", "--seed", 1, "--out", poses)
    must("convert", imu, text)
    stream, estimate = folder / "out.flr", folder / "estimate.csv"
    yield {"generate"}, ("generate", "model:optical+rate:2000+oscillate:200:0.7:0.2:0.6", "--out", folder / "x.trk")
    yield {"read", "check"}, ("info", text)
    yield {"read", "check", "allan"}, ("allan", text)
    yield {"read", "write"}, ("convert", text, folder / "x.csv")
    yield {"write"}, ("convert", poses, folder / "x.tum")
    yield {"read", "attitude", "write"}, ("attitude", text, "--out", estimate)
    yield {"smooth, first of three passes", "smooth, again"}, ("attitude", imu, "--smooth", "--out", folder / "smooth.csv")
    yield {"read", "estimate"}, ("score", text, estimate)
    yield {"read", "replay", "judging the stream", "evaluating the curve"}, (
        "reduce", text, "--tol-rot", 0.01, "--out", stream)
    yield {"replay"}, ("reduce", imu, "--tol-rot", 0.01, "--objective", "knots", "--out", folder / "x.flr")
    yield {"read", "evaluate"}, ("decode", stream, "--at", text, "--out", folder / "decoded.csv")
    yield {"replay", "report"}, ("replay", poses, "--out", folder / "report")
    yield {"filter", "write"}, ("filter", poses, "--filter", "binomial:9", "--out", folder / "x.csv")
    yield {"read", "write"}, ("faults", text, "nan:10", "--out", folder / "spoiled.csv")


def test_every_stage_is_shown_on_a_terminal(folder):
    for stages, arguments in commands(folder):
        for attempt in range(TRIES):
            code, shown, silence, seconds = on_terminal(*arguments)
            assert code == 0, arguments
            assert stages <= set(shown), (stages - set(shown), arguments)
            if silence < max(SILENT_SHARE * seconds, SILENT_S):
                break
            assert attempt + 1 < TRIES, f"{silence:.2f} of {seconds:.2f} s: {arguments}"
        print(f"{seconds:5.2f} s, silent for {silence:4.2f} s at most: {arguments[0]}: {', '.join(dict.fromkeys(shown))}")


def test_a_pipe_gets_none_of_it(folder):
    for _, arguments in commands(folder):
        done = subprocess.run([ROOT / PROGRAM, *map(str, arguments)], capture_output=True, timeout=300, check=True,
                              env={**os.environ, "FAIRLEAD_PROGRESS_AFTER": "0"})
        assert b"\x1b" not in done.stderr + done.stdout and b"\r" not in done.stderr, (arguments, done.stderr)


if __name__ == "__main__":
    main()
