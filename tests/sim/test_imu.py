#!/usr/bin/env python3
"""An IMU recording replays to a reduced orientation stream, by the code that runs on the board."""
import json
import math

from simulator import RECORDINGS, main, must, read_csv, rotation_angle, run
from test_report import Page, data_of, times, values

SPEC = "model:icm42688p+rest:4+turn:2:3+reach:1:3+gap:0.25+oscillate:4:1+rest:2"
MODES = {"9d": "gyro, accelerometer, magnetometer", "6d": "gyro, accelerometer", "3d": "gyro"}
FIGURES = {
    "9d": ["inclination_error", "heading_error", "gyro_bias", "field_distance"],
    "6d": ["inclination_error", "heading_error", "gyro_bias"],
    "3d": ["turn_error", "gyro_bias"],
}


def generated(folder, spec=SPEC):
    must("generate", spec, "--seed", 4, "--out", folder / "in.imu")
    return folder / "in.imu"


def rows(table):
    return dict(map(str.strip, line.split("  ", 1)) for line in table.splitlines() if not line.startswith(" "))


def estimate(folder, imu, *options):
    must("attitude", imu, *options, "--out", folder / "est.csv")
    lines = (folder / "est.csv").read_text(encoding="ascii").splitlines()
    assert lines[0] == "t_ns,qw,qx,qy,qz"
    records = [line.split(",") for line in lines[1:]]
    return {int(t): list(map(float, q)) for t, *q in records}


def test_replay_is_the_attitude_filter_and_the_pipeline(folder):
    imu = generated(folder)
    for mode, words in MODES.items():
        out = folder / mode
        table = rows(must("replay", imu, "--mode", mode, "--tol-rot", "0.005", "--out", out))
        assert table["orientation from"] == words, table
        assert table["samples outside"].split() == ["-", "0"], table
        assert table["faults"] == "1 gap", table
        expected = estimate(folder, imu, "--mode", mode)
        tum = [line.split() for line in (out / "filtered.tum").read_text().splitlines()[1:]]
        assert len(tum) == len(expected) > 2500
        must("decode", out / "stream.flr", "--at", imu, "--out", folder / "d.csv")
        decoded = read_csv(folder / "d.csv")
        assert len(decoded) == len(expected)
        for (t, _, *q), (t_d, p, q_d, _) in zip(tum, decoded):
            x, y, z, w = map(float, q[2:])
            assert int(t.replace(".", "")) == t_d and p is None
            assert rotation_angle([w, x, y, z], expected[t_d]) < 1e-6
            assert rotation_angle(q_d, expected[t_d]) <= 0.005 + 1e-6


def test_figures_of_each_mode_hold_data(folder):
    imu = generated(folder)
    for mode, names in FIGURES.items():
        must("replay", imu, "--mode", mode, "--filter", "binomial:5", "--out", folder)
        data, numbers = data_of(Page((folder / "report.html").read_text(encoding="utf-8")))
        wanted = ["orientation", "orientation_difference", "orientation_error", *names, "delay",
                  "acceleration"]
        assert [c["id"] for c in data["charts"]] == wanted, mode
        for chart in data["charts"]:
            assert any(len(set(values(numbers, s["y"]))) > 20 for s in chart["series"]), chart["id"]


def test_flags_are_bands_where_they_are_set(folder):
    must("replay", generated(folder, "model:icm42688p+rest:8+turn:2+gap:0.2+turn:2"), "--mode", "6d",
         "--out", folder)
    data, numbers = data_of(Page((folder / "report.html").read_text(encoding="utf-8")))
    bands = {b["name"]: list(zip(times(numbers, b["from"]), times(numbers, b["to"]))) for b in data["bands"]}
    assert len(bands["gap"]) == 1 and abs(bands["gap"][0][0] - 10) < 0.1, bands["gap"]
    assert 0.19 < bands["gap"][0][1] - bands["gap"][0][0] < 0.25, bands["gap"]
    assert bands["settling"][0][0] == 0 and bands["rest"][0][1] < 8.5, bands


def test_the_errors_are_those_of_score(folder):
    imu = generated(folder)
    table = rows(must("replay", imu))
    estimate(folder, imu)
    score = json.loads(must("score", imu, folder / "est.csv", "--json"))
    said = table["rms error of estimate"].split()
    assert abs(float(said[0]) - score["total_deg"]) < 0.006, (said, score)
    assert abs(float(said[3].rstrip(",")) - score["heading_deg"]) < 0.006, (said, score)
    assert score["not_finite"] == 0 and score["total_deg"] < 6, score
    for mode, row in (("6d", "inclination"), ("3d", None)):
        table = rows(must("replay", imu, "--mode", mode))
        assert row is None or table["rms error of estimate"].startswith(row), table
        assert row or "rms error of estimate" not in table, table


def test_without_magnetometer_and_reference(folder):
    source = folder / "imu.csv"
    source.write_text("#t,wx,wy,wz,ax,ay,az\n" + "".join(
        f"{i * 5000000},0,0,{0.5 * math.sin(i * 0.01) if i > 800 else 0},0,0,9.81\n"
        for i in range(3000)), encoding="ascii")
    table = rows(must("replay", source, "--out", folder))
    assert table["orientation from"] == MODES["6d"], table
    assert "rms error of estimate" not in table
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "heading_error" not in page and "has no reference" in page
    rest = estimate(folder, source)[3995000000]
    assert rotation_angle(rest, [1, 0, 0, 0]) < 1e-3


def test_reduce_and_filter(folder):
    imu = generated(folder)
    stream, trace = folder / "s.flr", folder / "t.csv"
    summary = json.loads(must("reduce", imu, "--tol-rot", "0.005", "--out", stream, "--json",
                              "--trace", trace))
    assert list(summary)[:3] == ["samples", "bytes", "orientation"] and "position" not in summary, summary
    assert summary["bytes"] == stream.stat().st_size
    assert summary["orientation"]["max_error_rad"] <= 0.005
    assert len(trace.read_text().splitlines()) == summary["samples"] + 1
    must("filter", imu, "--filter", "binomial:5", "--out", folder / "f.csv")
    filtered = read_csv(folder / "f.csv")
    assert len(filtered) == summary["samples"] and all(p is None and q for _, p, q, _ in filtered)


def test_faults_in_an_imu_are_met(folder):
    imu, bad = generated(folder), folder / "bad.imu"
    must("faults", imu, "nan:20+spike:5+repeat:4+gap:1:300", "--seed", 2, "--out", bad)
    table = must("replay", bad)
    for words in ("not finite", "repeated time", "2 gap"):
        assert words in table, table
    data = imu.read_bytes()
    bad.write_bytes(data[:64 + 72 * 500 + 30])
    code, _, err = run("replay", bad)
    assert code == 1 and f"byte {64 + 72 * 500}:" in err, err
    assert "500 in" in rows(must("replay", bad, "--salvage"))["records in"]


def test_allan_reads_the_noise_of_the_model(folder):
    imu = generated(folder, "model:icm42688p+turn:2+rest:120")  # 2.8 mdps/rtHz, 70 ug/rtHz
    said = must("allan", imu, "--plot", folder / "a.html", "--csv", folder / "a.csv")
    assert said.startswith("rest from "), said
    density = {line[:7]: float(line.split()[3]) for line in said.splitlines()[2:]}
    for axis in "xyz":
        # one-sided density: white noise of it has the Allan deviation density / sqrt(2 tau)
        assert 0.9 < density[f"gyro {axis} "] * math.sqrt(2) / 2.8e-3 < 2.0, density
        assert 0.9 < density[f"accel {axis}"] * math.sqrt(2) / (70e-6 * 9.80665) < 2.0, density
    page = Page((folder / "a.html").read_text(encoding="utf-8"))
    assert {"figure-allan_gyro", "figure-allan_accel"} <= set(page.ids)
    assert (folder / "a.html").read_text(encoding="utf-8").count("<path") > 20
    lines = (folder / "a.csv").read_text(encoding="ascii").splitlines()
    assert lines[0] == "channel,tau_s,deviation" and len(lines) > 150
    code, _, err = run("allan", generated(folder, "model:icm42688p+turn:4"))
    assert code == 1 and "no rest of at least 5 s" in err, err


def test_wrong_usage(folder):
    imu = generated(folder, "model:icm42688p+rest:1")
    for arguments in (["replay", imu, "--mode", "10d"], ["attitude", imu],
                      ["reduce", imu, "--out", folder / "x"],
                      ["reduce", imu, "--tol-pos", 1, "--channel", "position", "--out", folder / "x"],
                      ["attitude", imu, "--every", 0, "--out", folder / "x"],
                      ["attitude", imu, "--drop", 2, "--out", folder / "x"],
                      ["attitude", imu, "--drop", "0.1,0", "--out", folder / "x"],
                      ["attitude", imu, "--drop", "0.1,2.5", "--out", folder / "x"],
                      ["attitude", imu, "--drop", "nan", "--out", folder / "x"],
                      ["attitude", imu, "--rate-error", "nan", "--out", folder / "x"],
                      ["attitude", imu, "--start-at", -1, "--out", folder / "x"]):
        code, _, err = run(*arguments)
        assert code == 2 and err, (code, arguments, err)
    for arguments in (["attitude", imu, "--start-at", 100], ["attitude", "README.md"]):
        code, _, err = run(*arguments, "--out", folder / "x")
        assert code == 1 and err, (code, arguments, err)
    bad = folder / "bad.csv"
    for row in ("1,2,3", "0,2,0,0,0", "0,one,0,0,0"):
        bad.write_text("t_ns,qw,qx,qy,qz\n" + row + "\n", encoding="ascii")
        code, _, err = run("score", imu, bad)
        assert code == 1 and "line 2" in err, (row, err)


def test_a_recording(folder):
    recordings = sorted(RECORDINGS.glob("08*.imu"))
    if not recordings:
        return "no recordings"
    table = rows(must("replay", recordings[0], "--filter", "binomial:5", "--out", folder))
    assert table["samples outside"].split() == ["-", "0"], table
    estimated, reduced = (float(table[f"rms error of {of}"].split()[0]) for of in ("estimate", "curve"))
    assert estimated < 2.5 and abs(reduced - estimated) < 0.1, table
    assert (folder / "report.html").stat().st_size < 4_000_000
    return None


if __name__ == "__main__":
    main()
