#!/usr/bin/env python3
"""report.html is one self-contained, well-formed page, and its figures hold data."""
import html.parser
import re

from simulator import main, must

VOID = {"meta", "link", "br", "hr", "img", "input", "base", "col", "wbr"}


class Page(html.parser.HTMLParser):
    """Checks that tags nest, and gathers what the page refers to and draws."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.references = [], [], []
        self.figures, self.errors = {}, []
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
        if tag in ("path", "use"):
            figure = next((i for t, i in self.open if t == "figure"), None)
            if figure:
                self.figures.setdefault(figure, []).append(values.get("d", "point"))

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


def test_page_is_whole_and_self_contained(folder):
    text = replayed(folder, "rest:1+reach:0.7:6+gap:0.3+oscillate:3+lose:position:0.3+turn:1")
    page = Page(text)
    assert len(page.ids) == len(set(page.ids)), "ids must be unique"
    for reference in page.references:
        assert reference.startswith("#") and reference[1:] in page.ids, reference
    for outside in ("http:", "https:", "url(", "@import", "<script"):
        assert outside not in text, outside
    assert len(text) < 2_000_000
    for words in ("Every sample lies within tolerance", "largest error", "gap", "bytes out"):
        assert words in text, words


def test_every_figure_holds_data(folder):
    page = Page(replayed(folder, "rest:1+reach:0.7:6+oscillate:3+turn:1+rest:1"))
    expected = ["position", "position_close", "position_error", "orientation",
                "orientation_close", "orientation_error", "delay", "acceleration"]
    assert [f.removeprefix("figure-") for f in page.figures] == expected, list(page.figures)
    for name, paths in page.figures.items():
        points = sum(len(re.findall(r"[ML]", d)) for d in paths)
        points += paths.count("point")
        assert points > 250, (name, points)


def test_page_stays_small_for_long_recordings(folder):
    text = replayed(folder, "+".join(["reach:0.6:20", "oscillate:20:2", "rest:8"] * 4))
    assert len(text) < 2_000_000, len(text)


def test_one_channel_alone(folder):
    text = replayed(folder, "lose:position:1000+reach:0.7:6")
    figures = list(Page(text).figures)
    assert "figure-position" not in figures and "figure-orientation" in figures, figures


if __name__ == "__main__":
    main()
