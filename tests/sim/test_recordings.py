#!/usr/bin/env python3
"""The guarantee, checked from the outside: streams are decoded by the program, everything else
(reading .trk, distances, delays) is done here, in double.

The recordings are generated: noise of two kinds of tracker, rests, fast turns, jumps, gaps, and
drop-outs at random times. Recordings of a real tracker add to them where they are present."""
import json
import math
import os
import random

from simulator import (RECORDINGS, axis_distance, main, must, read_csv, read_trk, rotation_angle, run)

DELAY = 120
TOLERANCES = ((1e-3, math.radians(0.25)), (5e-3, math.radians(1)))


def gap_ns(records):
    """A longer pause ends a curve (docs/intake.md): 100 ms, at least 12 and at most 64 sample periods."""
    steps = sorted(b[0] - a[0] for a, b in zip(records, records[1:]))
    period = steps[len(steps) // 2]
    return min(max(100_000_000, 12 * period), 64 * period)


def reduced(trk, folder, tol_pos, tol_rot):
    stream, trace = folder / "s.flr", folder / "t.csv"
    summary = json.loads(must("reduce", trk, "--tol-pos", repr(tol_pos), "--tol-rot", repr(tol_rot),
                              "--max-delay", DELAY, "--out", stream, "--json", "--trace", trace))
    emitted = [int(line.split(",")[2]) for line in trace.read_text().splitlines()[1:]]
    return summary, stream, emitted


def decoded(stream, trk, folder, size=None):
    if size is not None:
        part = folder / "part.flr"
        part.write_bytes(stream.read_bytes()[:size])
        stream = part
    must("decode", stream, "--at", trk, "--salvage", "--out", folder / "d.csv")
    return read_csv(folder / "d.csv")


def check_guarantee(records, curve, tol_pos, tol_rot, summary):
    worst = [0.0, 0.0]
    for (t, p, q), (t_curve, p_curve, q_curve, _) in zip(records, curve, strict=True):
        assert t == t_curve
        for i, (sample, value, distance) in enumerate(((p, p_curve, axis_distance),
                                                       (q, q_curve, rotation_angle))):
            if sample is None:
                continue
            assert value is not None, f"no curve at {t}"
            worst[i] = max(worst[i], distance(sample, value))
    assert worst[0] <= tol_pos and worst[1] <= tol_rot, worst
    said = (summary["position"]["max_error_m"], summary["orientation"]["max_error_rad"])
    # the reducer's input is the quaternion normalised in float: 3e-7 rad from the file's at most
    assert abs(worst[0] - said[0]) < 1e-9 and abs(worst[1] - said[1]) < 3e-7, (worst, said)


def check_gaps(records, stream, folder):
    """No curve reaches into a pause of a channel that is a gap, with or without records in it."""
    limit = gap_ns(records)
    middles = {}  # time in the middle of a gap: the channels that pause there
    for channel in (1, 2):
        valid = [r[0] for r in records if r[channel] is not None]
        for a, b in zip(valid, valid[1:]):
            if b - a > limit:
                middles.setdefault((a + b) // 2, []).append(channel)
    times = folder / "middles.csv"
    times.write_text("t_ns,px,py,pz,qw,qx,qy,qz\n" + "".join(f"{t},0,0,0,1,0,0,0\n" for t in sorted(middles)),
                     encoding="ascii")
    if middles:
        code, _, err = run("decode", stream, "--at", times, "--salvage", "--out", folder / "m.csv")
        assert code == 0 or code == 1 and f"{len(middles)} of {len(middles)} times have no curve" in err, err
        for row in read_csv(folder / "m.csv") if code == 0 else []:
            for channel in middles[row[0]]:
                assert row[channel] is None, f"a curve of channel {channel} in the gap at {row[0]}"


def check_prefixes(trk, records, stream, emitted, folder, curve):
    """With the bytes present at record j the curve is what it stays, up to record j - DELAY."""
    n = len(records)
    header = next(size for size in emitted if size)  # the first bytes: no curve yet
    for j in (DELAY + 1, n // 7, n // 3, n // 2, 3 * n // 4, n - 2):
        nothing = [(t, None, None, None) for t, *_ in records]
        part = decoded(stream, trk, folder, emitted[j]) if emitted[j] > header else nothing
        for i, (now, final) in enumerate(zip(part, curve, strict=True)):
            for channel, fields in ((1, slice(1, 4)), (2, slice(4, 8))):
                if now[channel] is None:
                    due = i + DELAY <= j and records[i][channel] is not None
                    assert not due, f"record {i} is not covered at record {j}"
                else:
                    assert now[3][fields] == final[3][fields], f"record {i} changed after {j}"
            assert i <= j or now[1] is None and now[2] is None, f"a curve at {i}, known at {j}"


# name: SPEC, seed
GENERATED = {
    "optical_tracker_at_work": (
        "model:optical+rest:2+dropouts:both:24:10:0.08+reach:0.9:8+dropouts:orientation:10:6:0.4+"
        "oscillate:5:1.5+gap:0.4+dropouts:position:8:4:0.4+reach:0.7:6+turn:1.2:12+rest:3", 11),
    "magnetic_tracker_uneven_times": (
        "model:magnetic+jitter:2500+rest:1+reach:0.5:12:1:2+lose:orientation:0.6+oscillate:4:3:0.05:0.5+"
        "gap:0.15+rest:4+dropouts:both:6:8:0.05+reach:1.5:4", 12),
    "fast_motion_with_jumps": (
        "model:optical+rate:240+turn:0.6:30+jump+oscillate:2:6:0.1:0.4+jump:1:2+dropouts:both:6:12:0.02+"
        "reach:0.25:20:1.5:3+gap:0.2+turn:0.8:40+rest:1", 13),
    "long_rest_and_slow_motion": (
        "model:optical+rate:60+rest:30+dropouts:both:20:5:1+reach:20:1:0.2:0.4+gap:3+rest:10", 14),
}


def random_spec(random):
    """A recording that nobody has thought of: 20 to 60 s at any rate, of motions and losses in any order."""
    def within(low, high):
        return f"{random.uniform(low, high):.3f}"

    rate = random.choice((30, 60, 90, 100, 120, 200, 250))
    items = [f"model:{random.choice(('optical', 'magnetic', 'ideal'))}", f"rate:{rate}",
             f"jitter:{random.choice((0, 0, random.uniform(0, 0.4e6 / rate))):.0f}"]
    for _ in range(random.randint(5, 9)):
        items.append(random.choice((
            f"rest:{within(0.2, 8)}", f"reach:{within(0.2, 2)}:{random.randint(1, 8)}:{within(0, 3)}:{within(0, 3)}",
            f"oscillate:{within(1, 6)}:{within(0.2, 8)}:{within(0, 0.3)}:{within(0, 1)}",
            f"turn:{within(0.3, 2)}:{within(1, 30)}", f"jump:{within(0, 5)}:{within(0, 3)}")))
        if random.random() < 0.6:
            channel = random.choice(("position", "orientation", "both"))
            items.append(random.choice((
                f"gap:{within(0.02, 2)}", f"lose:{channel}:{within(0.01, 3)}",
                f"dropouts:{channel}:{within(1, 8)}:{random.randint(1, 20)}:{within(0.01, 0.5)}")))
    items.append("rest:1")
    return "+".join(items), random.randint(0, 2**32)


def check_random(folder, seed):
    spec, noise = random_spec(random.Random(seed))
    must("generate", spec, "--seed", noise, "--out", folder / "random.trk")
    try:
        check(folder / "random.trk", folder)
    except AssertionError as error:
        raise AssertionError(f"SEED={seed}: fairlead-sim generate '{spec}' --seed {noise}: {error}") from error


def recorded():
    folder = RECORDINGS / "tracker120"
    return sorted(folder.glob("*.trk")) if folder.is_dir() else []


def generated(name, folder):
    spec, seed = GENERATED[name]
    must("generate", spec, "--seed", seed, "--out", folder / "generated.trk")
    records = read_trk(folder / "generated.trk")
    for channel in (1, 2):  # it holds what it is for: several drop-outs and a gap, or nothing is proven
        valid = [r[channel] is not None for r in records]
        dropouts = sum(1 for a, b in zip(valid, valid[1:]) if a and not b)
        assert dropouts >= 3 and sum(valid) > 0.5 * len(valid), (name, dropouts, sum(valid))
    assert any(b[0] - a[0] > gap_ns(records) for a, b in zip(records, records[1:])), f"no gap in {name}"
    return folder / "generated.trk"


def check(trk, folder):
    records = read_trk(trk)
    for tol_pos, tol_rot in TOLERANCES:
        summary, stream, emitted = reduced(trk, folder, tol_pos, tol_rot)
        assert summary["samples"] == len(records), summary
        for channel in ("position", "orientation"):
            assert summary[channel]["max_delay_samples"] <= DELAY, summary
        curve = decoded(stream, trk, folder)
        check_guarantee(records, curve, tol_pos, tol_rot, summary)
        check_gaps(records, stream, folder)
        check_prefixes(trk, records, stream, emitted, folder, curve)


def test_the_checks_find_a_curve_beyond_the_tolerance(folder):
    trk = generated("optical_tracker_at_work", folder)
    (tol_pos, tol_rot), _ = TOLERANCES
    for wider in ((3 * tol_pos, tol_rot), (tol_pos, 3 * tol_rot)):
        summary, stream, _ = reduced(trk, folder, *wider)
        try:
            check_guarantee(read_trk(trk), decoded(stream, trk, folder), tol_pos, tol_rot, summary)
        except AssertionError:
            continue
        raise AssertionError(f"a stream with the tolerances {wider} passes for {tol_pos}, {tol_rot}")


def test_random_recordings(folder):
    """SEED=n COUNT=n searches elsewhere and longer."""
    first = int(os.environ.get("SEED", "1"))
    for seed in range(first, first + int(os.environ.get("COUNT", "12"))):
        check_random(folder, seed)


for _name in GENERATED:
    globals()[f"test_{_name}"] = lambda folder, name=_name: check(generated(name, folder), folder)
for _trk in recorded():
    globals()[f"test_{_trk.stem}"] = lambda folder, trk=_trk: check(trk, folder)
if not recorded():
    globals()["test_recordings_of_a_real_tracker"] = lambda folder: (
        f"there are none in {RECORDINGS.resolve()}; the generated ones were checked")

if __name__ == "__main__":
    main()
