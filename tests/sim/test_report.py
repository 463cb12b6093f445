#!/usr/bin/env python3
"""report.html is one self-contained, well-formed page, and its numbers are those of the replay.
What it does in a browser is tested by tests/browser."""
import base64
import html.parser
import json
import struct
import zlib

from simulator import main, must, read_csv

VOID = {"meta", "link", "br", "hr", "img", "input", "base", "col", "wbr"}


class Page(html.parser.HTMLParser):
    """Checks that tags nest, and gathers what the page refers to and draws."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.references = [], [], []
        self.scripts = {}
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        if "id" in values:
            self.ids.append(values["id"])
        for key in ("href", "src", "xlink:href", "data", "action"):
            if key in values:
                self.references.append(values[key])
        if tag not in VOID:
            self.open.append((tag, values.get("id", "")))

    def handle_data(self, data):
        if self.open and self.open[-1][0] == "script":
            self.scripts[self.open[-1][1]] = data

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open and self.open[-1][0] == tag, (tag, self.open[-3:])
        self.open.pop()


def replayed(folder, spec):
    must("generate", spec, "--seed", 2, "--out", folder / "in.trk")
    must("replay", folder / "in.trk", "--filter", "binomial:5", "--out", folder)
    return (folder / "report.html").read_text(encoding="utf-8")


def values(numbers, what):
    """As page/charts.js unpacks them."""
    at, n = what["at"], what["n"]
    level, out = 0, []
    for i in range(n):
        level = (level + numbers[at + i] + 256 * numbers[at + n + i]) & 65535
        out.append(None if level == 65535 else what["zero"] + what["step"] * level)
    return out


def times(numbers, what):
    at, n = what["at"], what["n"]
    us = step = 0
    out = []
    for i in range(n):
        word = bytes(numbers[at + plane * n + i] for plane in range(4))
        step += struct.unpack("<i", word)[0]
        us += step
        out.append(us * 1e-6)
    return out


def data_of(page):
    return (json.loads(page.scripts["data"]),
            zlib.decompress(base64.b64decode(page.scripts["numbers"])))


def test_page_is_whole_and_self_contained(folder):
    text = replayed(folder, "rest:1+reach:0.7:6+gap:0.3+oscillate:3+lose:position:0.3+turn:1")
    page = Page(text)
    assert len(page.ids) == len(set(page.ids)), "ids must be unique"
    assert not page.references, page.references
    assert "default-src 'none'" in text.partition("<style>")[0]
    for words in ("Every sample lies within tolerance", "largest error", "gap", "bytes out"):
        assert words in text, words
    for licence in ("MIT", "three.js authors"):
        assert licence in text, licence


def test_the_charts_hold_the_curve(folder):
    """Every decoded sample, within a step of the page's quantisation."""
    page = Page(replayed(folder, "rest:1+reach:0.7:6+oscillate:3+turn:1+rest:1"))
    data, numbers = data_of(page)
    expected = ["position", "position_difference", "position_error", "orientation",
                "orientation_difference", "orientation_error", "delay", "acceleration"]
    assert [c["id"] for c in data["charts"]] == expected
    must("decode", folder / "stream.flr", "--at", folder / "filtered.tum", "--out", folder / "d.csv")
    rows = read_csv(folder / "d.csv")
    series = data["charts"][0]["series"]
    assert [s["name"] for s in series] == ["sensor x", "sensor y", "sensor z", "x", "y", "z"]
    for axis in range(3):
        x, y = times(numbers, series[3 + axis]["x"]), values(numbers, series[3 + axis]["y"])
        assert len(x) == len(rows)
        for t, v, row in zip(x, y, rows):
            assert abs(t - (row[0] - int(data["start_ns"])) * 1e-9) < 1e-6
            assert abs(v - row[1][axis]) <= series[3 + axis]["y"]["step"], (t, v, row)
    marks = {m["name"]: m["times"]["n"] for m in data["marks"]}
    assert marks["knots of the position"] > 5 and marks["frames"] > 5, marks
    assert data["after"]["t"]["n"] == len(rows)


def test_one_channel_alone(folder):
    data, _ = data_of(Page(replayed(folder, "lose:position:1000+reach:0.7:6")))
    charts = [c["id"] for c in data["charts"]]
    assert "position" not in charts and "orientation" in charts, charts
    assert data["after"]["p"] == []


if __name__ == "__main__":
    main()
