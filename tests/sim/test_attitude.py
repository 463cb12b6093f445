#!/usr/bin/env python3
"""fairlead-sim attitude --smooth and score --align, judged from the files that they read and write."""
import json
import math

from simulator import main, must, run

SPEC = "model:icm42688p+rest:4+turn:1.5:4+reach:0.8:6+oscillate:6:1+rest:3"


def generated(folder):
    must("generate", SPEC, "--seed", 11, "--out", folder / "in.imu")
    return folder / "in.imu"


def rows(path):
    lines = path.read_text(encoding="ascii").splitlines()
    assert lines[0] == "t_ns,qw,qx,qy,qz", lines[0]
    return [(int(t), [float(x) for x in q]) for t, *q in (line.split(",") for line in lines[1:])]


def times(a, b):
    """The product of two quaternions."""
    (w, x, y, z), (p, q, r, s) = a, b
    return [w * p - x * q - y * r - z * s, w * q + x * p + y * s - z * r,
            w * r - x * s + y * p + z * q, w * s + x * r - y * q + z * p]


def about(axis, degrees):
    half = math.radians(degrees) / 2
    return [math.cos(half), *(math.sin(half) * x for x in axis)]


def written(path, records):
    path.write_text("t_ns,qw,qx,qy,qz\n" + "".join(
        f"{t},{','.join(f'{x:.9g}' for x in q)}\n" for t, q in records), encoding="ascii")
    return path


def scored(imu, estimate, *options):
    return json.loads(must("score", imu, estimate, "--json", *options))


def test_smoothing_uses_what_comes_after(folder):
    imu = generated(folder)
    must("attitude", imu, "--out", folder / "causal.csv")
    must("attitude", imu, "--smooth", "--out", folder / "smooth.csv")
    causal, smooth = rows(folder / "causal.csv"), rows(folder / "smooth.csv")
    assert len(smooth) >= len(causal) - 1, (len(smooth), len(causal))
    assert [t for t, _ in smooth] == sorted({t for t, _ in smooth})
    assert {t for t, _ in smooth} <= {t for t, _ in causal}
    assert all(abs(sum(x * x for x in q) - 1) < 1e-5 for _, q in smooth)
    before, after = scored(imu, folder / "causal.csv"), scored(imu, folder / "smooth.csv")
    assert after["total_deg"] < before["total_deg"], (before, after)
    assert after["inclination_deg"] < 1.05 * before["inclination_deg"], (before, after)


def test_smoothing_goes_with_nothing_that_it_cannot_do(folder):
    imu = generated(folder)
    for option in (("--drop", "0.1"), ("--every", 2), ("--rate-error", 1), ("--start-at", 3)):
        code, _, err = run("attitude", imu, "--smooth", *option, "--out", folder / "x.csv")
        assert code == 2 and option[0] in err and "--smooth" in err, (option, code, err)
        assert not (folder / "x.csv").exists()
    code, _, err = run("attitude", imu, "--smooth", "--mode", "3d", "--out", folder / "x.csv")
    assert code == 2 and "accelerometer" in err, (code, err)


def test_smoothing_without_a_magnetometer(folder):
    imu = generated(folder)
    must("attitude", imu, "--smooth", "--mode", "6d", "--out", folder / "smooth.csv")
    plain, aligned = (scored(imu, folder / "smooth.csv", "--align", how) for how in ("none", "heading"))
    assert aligned["total_deg"] < 3, aligned
    assert abs(plain["inclination_deg"] - aligned["inclination_deg"]) < 1e-3, "heading moves no inclination"


def test_a_constant_offset_is_removed_and_nothing_else(folder):
    imu = generated(folder)
    must("attitude", imu, "--out", folder / "est.csv")
    estimate = rows(folder / "est.csv")
    base = {how: scored(imu, folder / "est.csv", "--align", how) for how in ("none", "heading", "rotation")}
    assert base["heading"]["total_deg"] <= base["none"]["total_deg"] + 1e-9, base
    turned = written(folder / "turned.csv", [(t, times(about((0, 0, 1), 123), q)) for t, q in estimate])
    assert scored(imu, turned)["heading_deg"] > 100
    for how in ("heading", "rotation"):
        s = scored(imu, turned, "--align", how)
        assert abs(s["total_deg"] - base[how]["total_deg"]) < 0.01, (how, s, base[how])
    # another world altogether: heading alone cannot mend it, a rotation can
    axis = [0.6, -0.48, 0.64]
    tilted = written(folder / "tilted.csv", [(t, times(about(axis, 70), q)) for t, q in estimate])
    assert scored(imu, tilted, "--align", "heading")["inclination_deg"] > 30
    s = scored(imu, tilted, "--align", "rotation")
    assert abs(s["total_deg"] - base["rotation"]["total_deg"]) < 0.01, s
    # an error that is not constant stays
    moving = written(folder / "moving.csv",
                     [(t, times(about((0, 0, 1), 20 * (i % 2)), q)) for i, (t, q) in enumerate(estimate)])
    assert scored(imu, moving, "--align", "heading")["heading_deg"] > 9
    code, _, err = run("score", imu, turned, "--align", "north")
    assert code == 2 and "north" in err, err


if __name__ == "__main__":
    main()
