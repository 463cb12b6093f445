#!/usr/bin/env python3
"""The command line of fairlead-sim is a contract: names, columns, keys, exit codes."""
import json
import math
import zlib

from simulator import axis_distance, main, must, read_csv, read_trk, rotation_angle, run

SPEC = "model:optical+rest:1+reach:0.8:3+gap:0.3+oscillate:2:2+lose:position:0.4+turn:1:9+rest:1"
LONG = "model:optical+rest:1+reach:0.8:20+gap:0.3+oscillate:8:2+lose:position:0.4+turn:1:9+rest:1"


def generated(folder, name="in.trk", spec=SPEC):
    path = folder / name
    must("generate", spec, "--seed", 5, "--out", path)
    return path


def expect(code, *arguments, says=""):
    got, out, err = run(*arguments)
    assert got == code, f"exit {got}, not {code}: {arguments}: {out}{err}"
    assert says in err + out, f"'{says}' is not in: {err}{out}"


def test_help_and_version(_):
    assert must("--version").startswith("fairlead-sim ")
    names = must("--help")
    for command in "replay reduce decode filter generate faults info".split():
        assert command in names, command
        assert "Usage: fairlead-sim " + command in must(command, "--help")


def test_usage_errors_exit_2(folder):
    trk = generated(folder)
    out = folder / "x"
    for arguments in (
        [], ["nonsense"], ["replay"], ["replay", folder / "missing.trk"],
        ["replay", trk, "--filter", "binomial:4"], ["replay", trk, "--filter", ""][:2] + ["--bad"],
        ["replay", trk, "--max-delay", "0"], ["replay", trk, "--max-delay", "100000"],
        ["replay", trk, "--tol-pos", "-1"], ["replay", trk, "--restart", "-1"],
        ["replay", trk, "--stream-id", "65536"], ["replay", trk, "--tol-rot", "nan"],
        ["reduce", trk, "--out", out], ["reduce", trk, "--tol-pos", "1e-3", "--out", out],
        ["reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "1e-2"],
        ["reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "1e-2", "--channel", "left", "--out", out],
        ["decode", trk], ["filter", trk, "--out", out],
        ["filter", trk, "--filter", "median:3", "--out", out],
        ["generate", "jog:1", "--out", out], ["generate", "rest:1", "--out", folder / "x.imu"],
        ["faults", trk, "melt:1", "--out", folder / "x.trk"], ["info"],
    ):
        expect(2, *arguments)


def test_bad_data_exits_1_with_the_place(folder):
    trk = generated(folder)
    data = trk.read_bytes()
    cut = folder / "cut.trk"
    cut.write_bytes(data[:64 + 36 * 100 + 7])
    expect(1, "info", cut, says=f"byte {64 + 36 * 100}:")
    expect(1, "replay", cut, says=f"byte {64 + 36 * 100}:")
    expect(0, "info", cut, "--salvage", says="records          100")
    expect(0, "replay", cut, "--salvage", says="100 records before it are used")
    text = folder / "bad.csv"
    text.write_text("t_ns,px,py,pz,qw,qx,qy,qz\n1,0,0,0,1,0,0,0\n2,0,0,zero,1,0,0,0\n")
    expect(1, "info", text, says="line 3, column 4 (pz): 'zero' is not a number; --salvage")
    empty = folder / "empty"
    empty.write_bytes(b"")
    expect(1, "info", empty, says="holds no records")
    expect(1, "decode", empty, "--at", trk, "--out", folder / "x.csv", says="no frame")
    expect(1, "replay", trk, "--out", "/proc/none", says="/proc/none")


def test_a_run_that_refuses_much_says_so(folder):
    trk, bad = generated(folder), folder / "bad.trk"
    must("faults", trk, "repeat:60", "--seed", 3, "--out", bad)
    expect(0, "replay", bad, says=" %) were refused by the intake")
    expect(1, "replay", bad, "--strict", says=" %) were refused by the intake")
    expect(1, "reduce", bad, "--tol-pos", "1e-3", "--tol-rot", "0.01", "--strict", "--out", folder / "s.flr",
           says="refused")
    expect(0, "replay", trk, "--strict")
    code, _, err = run("replay", trk)
    assert "refused" not in err, err


def test_a_refused_record_counts_once_whatever_its_channels(folder):
    rows = [[10 ** 9 + i * 8333333, 0.001 * i, 0, 0, 1, 0, 0, 0] for i in range(300)]
    for bad in (50, 120, 121, 200):
        rows[bad][1:] = ["1e9", 0, 0, 0, 0, 0, 0]  # both channels are refused
    rows[220][1:4] = ["1e9", 0, 0]  # one of them
    poses = folder / "refused.csv"
    poses.write_text("t_ns,px,py,pz,qw,qx,qy,qz\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    summary = json.loads(must("reduce", poses, "--tol-pos", "1e-3", "--tol-rot", "0.004", "--out", folder / "s.flr",
                              "--json"))
    assert summary["records"] == 300 and summary["refused"] == 5, summary


def test_decode_at_times_that_the_stream_does_not_cover(folder):
    trk, stream, late, out = generated(folder), folder / "s.flr", folder / "late.csv", folder / "d.csv"
    must("reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "0.004", "--out", stream)
    rows = [f"{t + 10 ** 12},0,0,0,1,0,0,0" for t, _, _ in read_trk(trk)]
    late.write_text("t_ns,px,py,pz,qw,qx,qy,qz\n" + "\n".join(rows) + "\n")
    expect(1, "decode", stream, "--at", late, "--out", out,
           says=f"{len(rows)} of {len(rows)} times have no curve")
    half = [f"{t},0,0,0,1,0,0,0" for t, _, _ in read_trk(trk)[100:]] + rows[:50]
    late.write_text("t_ns,px,py,pz,qw,qx,qy,qz\n" + "\n".join(half) + "\n")
    expect(0, "decode", stream, "--at", late, "--out", out, says=f"of {len(half)} times have no curve")
    data = stream.read_bytes()
    stream.write_bytes(data + data)  # the same board, started anew: two runs at the same times
    expect(0, "info", stream, says="runs                 2")
    expect(1, "decode", stream, "--at", trk, "--out", out, says="--run 1 to 2")
    expect(0, "decode", stream, "--at", trk, "--run", 1, "--out", out)
    first = out.read_text()
    expect(0, "decode", stream, "--at", trk, "--run", 2, "--out", out)
    assert out.read_text() == first
    expect(2, "decode", stream, "--at", trk, "--run", 3, "--out", out, says="holds 2")


def test_runs_of_a_clock_that_leaps_decode_together(folder):
    poses, stream, out = folder / "leap.csv", folder / "leap.flr", folder / "leap_decoded.csv"
    for name, leap_ns in (("forward", 250 * 86400 * 10 ** 9), ("back", -3600 * 10 ** 9)):
        rows = [(10 ** 9 + i * 8333333 + (leap_ns if i >= 300 else 0), 0.3 * math.sin(0.02 * i)) for i in range(600)]
        poses.write_text("t_ns,px,py,pz,qw,qx,qy,qz\n" + "".join(f"{t},{x:.9g},0.5,1,1,0,0,0\n" for t, x in rows))
        must("reduce", poses, "--tol-pos", "1e-3", "--tol-rot", "0.004", "--out", stream)
        must("decode", stream, "--at", poses, "--out", out)
        decoded = [line.split(",") for line in out.read_text().splitlines()[1:]]
        assert [int(d[0]) for d in decoded] == [t for t, _ in rows], name
        worst = max(abs(float(d[1]) - x) for d, (_, x) in zip(decoded, rows))
        assert 0 < worst <= 1.0001e-3, (name, worst)
        # one run alone: the times of the other have no curve
        must("decode", stream, "--at", poses, "--run", 2, "--out", out)
        assert sum(line.split(",")[1] != "" for line in out.read_text().splitlines()[1:]) == 300, name


def test_convert_and_doubts(folder):
    imu, text, back = folder / "a.imu", folder / "a.csv", folder / "b.imu"
    must("generate", "model:icm42688p+rest:1+turn:1", "--out", imu)
    must("convert", imu, text)
    assert text.read_text().startswith("t_ns,gx [rad/s],")
    must("convert", text, back, "--imu-version", 2)
    must("convert", back, folder / "c.csv")
    must("convert", back, "--out", folder / "named.csv")
    assert (folder / "named.csv").read_bytes() == (folder / "c.csv").read_bytes()
    assert (folder / "c.csv").read_bytes() == text.read_bytes()
    expect(0, "info", back, says="format           .imu, version 2")
    rows = text.read_text().splitlines()
    (folder / "g.csv").write_text("t_ns,ax [m/s^2],ay,az\n" + "".join(
        f"{i * 10000000},0,0,{1 + 0.001 * (i % 3)}\n" for i in range(100)))
    expect(0, "info", folder / "g.csv", says="--units accel=g")
    expect(0, "info", folder / "g.csv", "--units", "accel=g", says="median length 9.8")
    assert len(rows) > 300


def test_generate_is_the_same_for_the_same_seed(folder):
    a, b, c = folder / "a.trk", folder / "b.trk", folder / "c.trk"
    for path, seed in ((a, 5), (b, 5), (c, 6)):
        must("generate", SPEC, "--seed", seed, "--out", path, "--truth", folder / "truth.csv")
    assert a.read_bytes() == b.read_bytes() != c.read_bytes()
    for (t, p, q), (t_true, p_true, q_true, _) in zip(read_trk(c), read_csv(folder / "truth.csv")):
        assert t == t_true
        assert p is None or axis_distance(p, p_true) < 6e-4
        assert q is None or rotation_angle(q, q_true) < math.radians(0.4)


def test_reduce_json_trace_and_decode(folder):
    trk = generated(folder)
    records = read_trk(trk)
    stream, trace, decoded = folder / "s.flr", folder / "t.csv", folder / "d.csv"
    summary = json.loads(must("reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "0.00436",
                              "--max-delay", 60, "--out", stream, "--json", "--trace", trace))
    assert list(summary)[:4] == ["samples", "bytes", "position", "orientation"]
    said = {key: summary[key] for key in ("objective", "kind", "beam", "delay", "stream_id", "runs", "refused", "faults")}
    assert said == {"objective": "bytes", "kind": "C1 quadratic", "beam": "medium", "delay": 60, "stream_id": 0,
                    "runs": 1, "refused": 0, "faults": {"gap": 2}}, said
    assert summary["bytes_per_s"] * (records[-1][0] - records[0][0]) * 1e-9 - summary["bytes"] < 1
    for channel, error in (("position", "max_error_m"), ("orientation", "max_error_rad")):
        assert list(summary[channel])[:6] == ["control_points", "knots", "bytes", error,
                                              "max_delay_samples", "mean_delay_samples"]
        assert summary[channel]["samples_outside"] == 0
        assert 0.5 < summary[channel]["error_over_tolerance"] <= 1
        assert summary[channel]["max_delay_samples"] <= 60
        assert 0 < summary[channel]["control_points"] < len(records) / 4
    assert summary["samples"] == len(records)
    assert summary["bytes"] == stream.stat().st_size
    assert summary["position"]["bytes"] + summary["orientation"]["bytes"] == summary["bytes"]
    lines = trace.read_text().splitlines()
    assert lines[0] == "index,t_ns,bytes" and len(lines) == len(records) + 1
    rows = [list(map(int, line.split(","))) for line in lines[1:]]
    assert [r[:2] for r in rows] == [[i, r[0]] for i, r in enumerate(records)]
    assert all(a[2] <= b[2] for a, b in zip(rows, rows[1:])) and rows[-1][2] <= summary["bytes"]
    must("decode", stream, "--at", trk, "--out", decoded)
    worst_p = worst_q = 0
    for (t, p, q), (t_d, p_d, q_d, _) in zip(records, read_csv(decoded), strict=True):
        assert t == t_d
        if p:
            worst_p = max(worst_p, axis_distance(p, p_d))
        if q:
            worst_q = max(worst_q, rotation_angle(q, q_d))
    assert worst_p <= 1e-3 and worst_q <= 0.00436
    assert abs(worst_p - summary["position"]["max_error_m"]) < 1e-8
    assert abs(worst_q - summary["orientation"]["max_error_rad"]) < 1e-7


def test_reduce_of_one_channel(folder):
    trk = generated(folder)
    for channel, other in (("position", "orientation"), ("orientation", "position")):
        summary = json.loads(must("reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "0.00436",
                                  "--channel", channel, "--out", folder / "s.flr", "--json"))
        assert channel in summary and other not in summary
        assert summary[channel]["bytes"] == summary["bytes"]
        must("decode", folder / "s.flr", "--at", trk, "--out", folder / "d.csv")
        for _, p, q, row in read_csv(folder / "d.csv"):
            assert (q if channel == "position" else p) is None, row
    must("reduce", trk, "--tol-pos", "1e-3", "--channel", "position", "--out", folder / "s.flr")


def test_more_restarts_cost_bytes(folder):
    trk = generated(folder)
    def reduced(*options):
        summary = json.loads(must("reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "0.00436",
                                  "--out", folder / "s.flr", "--json", *options))
        return summary["bytes"], summary["frames"], summary["restarts"]
    usual, often, once = reduced(), reduced("--restart", 0.5), reduced("--restart", 1000)
    alone = reduced("--independent")
    assert once[2] < usual[2] < often[2] < alone[2] == alone[1], (once, usual, often, alone)
    assert usual[0] < often[0] and usual[0] < alone[0], (once, usual, often, alone)
    # behind a restart the slope is free, which saves about what the restart costs: docs/choosing.md
    assert once[0] < 1.1 * usual[0], (once, usual, often, alone)
    assert reduced("--restart", 0) == alone


def test_the_width_of_the_search_and_its_objective(folder):
    trk = generated(folder, "long.trk", LONG)  # widths differ by less than what one frame may gain by luck
    def reduced(*options):
        return json.loads(must("reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "0.00436", "--delay", 60,
                               "--out", folder / "s.flr", "--json", *options))
    narrow, medium, wide = (reduced("--beam", w) for w in ("narrow", "medium", "wide"))
    assert [r["beam"] for r in (narrow, medium, wide)] == ["narrow", "medium", "wide"]
    assert wide["bytes"] < medium["bytes"] and wide["bytes"] < narrow["bytes"]
    for width, slice in (("narrow", "small"), ("wide", "large")):  # the earlier names
        assert reduced("--slice", slice) == reduced("--beam", width)
    assert reduced("--continuity", 1) == reduced("--continuity", 0) == medium
    knots = reduced("--objective", "knots", "--continuity", 2)
    assert knots["kind"] == "C2 cubic" and knots["bytes"] > medium["bytes"]
    for channel in ("position", "orientation"):
        assert knots[channel]["control_points"] < medium[channel]["control_points"]
    options = ("--tol-pos", "1e-3", "--tol-rot", "0.00436", "--out", folder / "s.flr")
    expect(2, "reduce", trk, *options, "--continuity", 2, "--channel", "orientation", says="--objective knots")
    expect(2, "reduce", trk, *options, "--continuity", 2, "--independent", says="needs restarts")
    expect(2, "reduce", trk, *options, "--continuity", 2, "--restart", "1e-12", says="needs restarts")
    expect(2, "reduce", trk, *options, "--objective", "knots", "--independent", says="--objective bytes")
    expect(2, "reduce", trk, *options, "--beam", "wide", "--slice", "small", says="--beam")
    expect(2, "reduce", trk, *options, "--delay", 15, says="16")


def test_positions_with_a_continuous_acceleration(folder):
    trk, stream, out = generated(folder), folder / "c2.flr", folder / "c2.csv"
    options = ("--tol-pos", "1e-3", "--tol-rot", "0.00436", "--delay", 60, "--continuity", 2, "--out", stream)
    for beam in ("narrow", "medium", "wide"):
        told = json.loads(must("reduce", trk, *options, "--beam", beam, "--json"))
        assert told["position"]["kind"] == "C2 cubic" and told["orientation"]["kind"] == "C1 quadratic"
        # a curve of breaks would be within tolerance, too
        assert told["position"]["breaks"] <= (12 if beam == "narrow" else 4)
        for channel in ("position", "orientation"):
            assert told[channel]["samples_outside"] == 0 and told[channel]["error_over_tolerance"] <= 1
            assert told[channel]["max_delay_samples"] <= 60
    table = must("reduce", trk, *options)
    assert any(line.split() == ["continuous", "acceleration", "velocity"] for line in table.splitlines())
    told = must("info", stream)
    assert "C2 cubics" in told and "C1 quadratics" in told
    must("decode", stream, "--at", trk, "--out", out)
    rows = [line.split(",") for line in out.read_text().splitlines()[1:]]
    assert len(rows) > 800 and sum(row[1] != "" for row in rows) > 700


def test_a_stream_of_another_format_is_refused_by_its_version(folder):
    trk, stream, out = generated(folder), folder / "s.flr", folder / "d.csv"
    must("reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "0.00436", "--objective", "knots", "--out", stream)
    expect(1, "info", stream, says="earlier format (versions 1 to 3)")
    expect(1, "decode", stream, "--at", trk, "--out", out, says="decode --earlier")
    expect(0, "decode", stream, "--at", trk, "--out", out, "--earlier")
    for (_, p, q), (_, p_curve, q_curve, _) in zip(read_trk(trk), read_csv(out), strict=True):
        assert p is None or axis_distance(p, p_curve) <= 1e-3
        assert q is None or rotation_angle(q, q_curve) <= 0.00436
    must("reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "0.00436", "--stream-id", 77, "--out", stream)
    expect(0, "info", stream, says="stream id            77")
    data = bytearray(stream.read_bytes())
    data[2] = 9  # of a header: the version; its CRC-32 follows the payload
    size = 2 + data[1]
    data[size:size + 4] = zlib.crc32(data[:size]).to_bytes(4, "little")
    stream.write_bytes(data)
    expect(1, "info", stream, says="version 9; this program reads version 5")
    expect(1, "decode", stream, "--at", trk, "--out", out, says="version 9")


def test_filter_columns_and_constant_rate(folder):
    rows = [f"{i * 10000000},{i * 0.5},1,0,{math.cos(i * 0.01)},0,{math.sin(i * 0.01)},0"
            for i in range(50)]
    source, out = folder / "in.csv", folder / "out.csv"
    source.write_text("\n".join(rows) + "\n")
    expect(1, "filter", source, "--filter", "binomial:9", "--out", out, says="scalar may be first or last")
    must("filter", source, "--columns", "t_ns,px,py,pz,qw,qx,qy,qz", "--filter", "binomial:9+csg:5:1", "--out", out)
    records = read_csv(out)
    assert len(records) == 50
    for i, (t, p, q, row) in enumerate(records[10:-10], 10):  # a line and a constant turn stay
        assert t == i * 10000000 and abs(p[0] - i * 0.5) < 1e-5 and p[1] == 1, row
        assert rotation_angle(q, [math.cos(i * 0.01), 0, math.sin(i * 0.01), 0]) < 1e-5, row


def test_discrete_events_go_through(folder):
    trk, events = folder / "in.trk", folder / "events.csv"
    spec = "model:optical+press:3:4:6+rest:1+reach:0.8:3+rest:1"
    expect(2, "generate", spec, "--out", trk, says="--events")
    must("generate", spec, "--seed", 5, "--out", trk, "--events", events)
    written = events.read_text()
    assert written.startswith("t_ns,channel,value,gap\n") and written.count("\n") == 13
    stream, out = folder / "s.flr", folder / "out.csv"
    summary = json.loads(must("reduce", trk, "--events", events, "--tol-pos", "1e-3", "--tol-rot",
                              "0.004", "--out", stream, "--json"))
    assert summary["events"]["count"] == 12 and summary["events"]["refused"] == 0
    shares = sum(summary[key]["bytes"] for key in ("position", "orientation", "events"))
    assert shares == summary["bytes"] == stream.stat().st_size
    must("decode", stream, "--events", out)
    assert out.read_text() == written
    assert "12 on 1 channel, in" in must("info", stream)
    assert "12, 0 refused" in must("replay", trk, "--events", events, "--out", folder / "r")
    assert (folder / "r" / "events.csv").read_text() == written
    expect(2, "decode", stream, says="--events")
    expect(2, "decode", stream, "--at", trk)
    data = bytearray(stream.read_bytes())
    for at in range(len(data) // 3, len(data), len(data) // 3):
        data[at] ^= 4
    stream.write_bytes(data)
    expect(1, "decode", stream, "--events", out, says="damage")
    lines = out.read_text().splitlines()
    assert len(lines) >= 11 and {line[:-2] for line in lines} <= {l[:-2] for l in written.splitlines()}
    for text, says in (("1,2\n", "line 1: 2 columns"), ("x,1,1\n", "nanoseconds"),
                       ("1,70000,1\n", "65535"), ("1,1,1,2\n", "gap is 0 or 1")):
        events.write_text(text)
        expect(1, "replay", trk, "--events", events, says=says)


def test_replay_writes_its_folder(folder):
    trk = generated(folder)
    out = folder / "a" / "b"
    table = must("replay", trk, "--filter", "binomial:5", "--out", out)
    for word in ("records in", "faults", "control points", "largest error", "largest delay",
                 "bytes in, 36 a record", "bytes out", "largest distance to raw", str(out / "report.html")):
        assert word in table, word
    tum = (out / "filtered.tum").read_text().splitlines()
    both = sum(1 for _, p, q in read_trk(trk) if p and q)
    assert len(tum) == both + 1 and all(len(line.split(" ")) == 8 for line in tum[1:])
    must("decode", out / "stream.flr", "--at", out / "filtered.tum", "--out", folder / "d.csv")
    assert (out / "report.html").stat().st_size > 10000


def test_faults_are_counted_by_kind(folder):
    trk = generated(folder)
    bad = folder / "bad.trk"
    must("faults", trk, "nan:3+spike:2+repeat:4+backward:2+gap:1:40", "--seed", 3, "--out", bad)
    table = must("replay", bad)
    for text in ("repeated time", "2 backward time", "gap", "not finite", "out of range"):
        assert text in table, table


def test_a_damaged_stream_is_noticed_and_decoded_on(folder):
    trk = generated(folder, spec="model:optical+" + "+".join(["reach:0.5:8", "rest:1"] * 4))
    stream, bad = folder / "s.flr", folder / "bad.flr"
    must("reduce", trk, "--tol-pos", "1e-3", "--tol-rot", "0.00436", "--out", stream)
    must("decode", stream, "--at", trk, "--out", folder / "good.csv")
    good = read_csv(folder / "good.csv")
    data = bytearray(stream.read_bytes())
    data[len(data) // 2] ^= 0x10
    bad.write_bytes(data)
    expect(1, "decode", bad, "--at", trk, "--out", folder / "bad.csv", says="damage noticed")
    expect(0, "decode", bad, "--at", trk, "--salvage", "--out", folder / "bad.csv", says="damage")
    lost = 0
    rows = read_csv(folder / "bad.csv")
    for a, b in zip(good, rows):
        for i in (1, 2):
            lost += b[i] is None and a[i] is not None
            assert b[i] is None or b[i] == a[i], (a, b)
    assert 0 < lost < len(rows), lost
    assert rows[-1][1] is not None and rows[0][1] is not None


if __name__ == "__main__":
    main()
