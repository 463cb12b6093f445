#!/usr/bin/env python3
"""The pages keep their word: what a minute at rest costs is what docs/reducer.md says. (Examples and links: tests/docs.)"""
import json
import re
import sys

from simulator import ROOT, main, must

REDUCER = ROOT / "docs" / "reducer.md"
REST_ROW = re.compile(r"^(\| (?:a restart point|one at the start).*?\|)(.*)\|$", re.MULTILINE)


def rest_bytes(folder, row):
    """Bytes of the minute at rest for the delays of the table, as the commands of the page give them."""
    page = REDUCER.read_text(encoding="utf-8")
    generate, reduce = re.findall(r"^    build/fairlead-sim (.*rest\.trk.*)$", page, re.MULTILINE)[:2]
    here = lambda line: [folder / w if w.startswith("rest.") else w for w in line.split()]
    must(*here(generate))
    restart = re.findall(r"`(--restart) (\d+)`", row)
    out = []
    for delay in (60, 120, 240):
        line = here(reduce.replace("--max-delay 120", f"--max-delay {delay}"))
        summary = json.loads(must(*line, *(restart[0] if restart else [])))
        for channel in ("position", "orientation"):
            assert summary[channel]["curves"] == 1 and summary[channel]["samples_outside"] == 0, summary
        out.append(summary["bytes"])
    return out


def test_a_minute_at_rest_costs_what_the_page_says(folder):
    """`tests/sim/test_docs.py --write` puts the present numbers into the page."""
    page = REDUCER.read_text(encoding="utf-8")
    rows = REST_ROW.findall(page)
    assert len(rows) == 2, rows
    for row, cells in rows:
        found = rest_bytes(folder, row)
        if "--write" in sys.argv:
            page = page.replace(row + cells, row + " |".join(f" {n:,}" for n in found) + " ")
        else:
            assert [int(cell.replace(",", "")) for cell in cells.split("|")] == found, (row, found)
    if "--write" in sys.argv:
        REDUCER.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
