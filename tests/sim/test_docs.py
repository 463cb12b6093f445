#!/usr/bin/env python3
"""The pages keep their word: every C++ example compiles, whole programs run, links lead somewhere.

A fragment stands in a frame of its own, tests/docs/PAGE.cpp, or PAGE_1.cpp, PAGE_2.cpp, ... where a
page has several: the frame declares what the page takes for granted and includes the example. A frame with a
main function is run as well."""
import json
import os
import re
import subprocess
import sys

from simulator import ROOT, main, must

STRICT = ("-std=c++17 -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Werror "
          "-Wno-unused -ffp-contract=off").split()
PAGES = sorted((ROOT / "docs").rglob("*.md"))


def examples(page):
    return re.findall(r"^```cpp\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


def compiled(folder, *arguments):
    subprocess.run([*os.environ.get("CXX", "g++").split(), *STRICT, f"-I{folder}",
                    f"-I{ROOT}/lib/include", f"-I{ROOT}", *arguments], check=True)


def check_program(folder, code):
    (folder / "example.cpp").write_text(code, encoding="utf-8")
    compiled(folder, "-O1", folder / "example.cpp", "-o", folder / "example")
    subprocess.run([folder / "example"], check=True, capture_output=True, timeout=60)


def check_fragment(folder, code, frame):
    assert frame.is_file(), f"the example needs a frame, {frame}"
    lines = code.splitlines(keepends=True)
    headers = [line for line in lines if line.startswith("#include")]
    (folder / "example_headers.inc").write_text("".join(headers), encoding="utf-8")
    body = "".join(line for line in lines if line not in headers)
    (folder / "example.inc").write_text(body, encoding="utf-8")
    if "int main" not in frame.read_text(encoding="utf-8"):
        compiled(folder, "-fsyntax-only", frame)
        return
    compiled(folder, "-O1", frame, "-o", folder / "example")
    subprocess.run([folder / "example"], check=True, timeout=60)


def check_page(page, folder):
    codes = examples(page)
    for number, code in enumerate(codes, 1):
        name = page.stem if len(codes) == 1 else f"{page.stem}_{number}"
        if "int main" in code:
            check_program(folder, code)
        else:
            check_fragment(folder, code, ROOT / "tests" / "docs" / f"{name}.cpp")


for _page in PAGES:
    if examples(_page):
        globals()[f"test_{_page.stem}"] = lambda folder, page=_page: check_page(page, folder)


def test_every_frame_has_its_example(_):
    known = {f"{p.stem}{end}" for p in PAGES if examples(p) for end in ("", *(f"_{n}" for n in range(1, 10)))}
    for frame in (ROOT / "tests" / "docs").glob("*.cpp"):
        assert frame.stem in known, frame


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


def test_links_lead_somewhere(_):
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page}: {target}"


if __name__ == "__main__":
    main()
