#!/usr/bin/env python3
"""The guarantee on the recordings of a real tracker, checked from the outside: streams are decoded
by the program, everything else (reading .trk, distances, delays) is done here, in double."""
import json
import math

from simulator import (RECORDINGS, axis_distance, main, must, read_csv, read_trk, rotation_angle)

DELAY = 120
TOLERANCES = ((1e-3, math.radians(0.25)), (5e-3, math.radians(1)))
GAP_NS = 100_000_000


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


def check_gaps(records, curve):
    """No curve reaches into a pause of a channel that is a gap."""
    for channel in (1, 2):
        valid = [i for i, r in enumerate(records) if r[channel] is not None]
        for a, b in zip(valid, valid[1:]):
            if records[b][0] - records[a][0] > GAP_NS:
                middle = (a + b) // 2
                assert curve[middle][channel] is None, f"a curve in the gap at {records[middle][0]}"


def check_prefixes(trk, records, stream, emitted, folder, curve):
    """With the bytes present at record j the curve is what it stays, up to record j - DELAY."""
    n = len(records)
    for j in (DELAY + 1, n // 7, n // 3, n // 2, 3 * n // 4, n - 2):
        part = decoded(stream, trk, folder, emitted[j])
        for i, (now, final) in enumerate(zip(part, curve, strict=True)):
            for channel, fields in ((1, slice(1, 4)), (2, slice(4, 8))):
                if now[channel] is None:
                    due = i + DELAY <= j and records[i][channel] is not None
                    assert not due, f"record {i} is not covered at record {j}"
                else:
                    assert now[3][fields] == final[3][fields], f"record {i} changed after {j}"
            assert i <= j or now[1] is None and now[2] is None, f"a curve at {i}, known at {j}"


def recordings():
    folder = RECORDINGS / "tracker120"
    return sorted(folder.glob("*.trk")) if folder.is_dir() else []


def check(trk, folder):
    records = read_trk(trk)
    for tol_pos, tol_rot in TOLERANCES:
        summary, stream, emitted = reduced(trk, folder, tol_pos, tol_rot)
        assert summary["samples"] == len(records), summary
        for channel in ("position", "orientation"):
            assert summary[channel]["max_delay_samples"] <= DELAY, summary
        curve = decoded(stream, trk, folder)
        check_guarantee(records, curve, tol_pos, tol_rot, summary)
        check_gaps(records, curve)
        check_prefixes(trk, records, stream, emitted, folder, curve)


for _trk in recordings():
    globals()[f"test_{_trk.stem}"] = lambda folder, trk=_trk: check(trk, folder)
if not recordings():
    globals()["test_recordings"] = lambda folder: f"no recordings in {RECORDINGS}"

if __name__ == "__main__":
    main()
