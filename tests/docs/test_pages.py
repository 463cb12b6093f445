#!/usr/bin/env python3
"""The pages keep their word: every C++ example compiles, whole programs run, links lead to a file and a heading.

A fragment stands in a frame of its own, tests/docs/PAGE.cpp, or PAGE_1.cpp, PAGE_2.cpp, ... where a
page has several: the frame declares what the page takes for granted and includes the example. A frame with a
main function is run as well."""
import os
import pathlib
import re
import subprocess
import sys

import links

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "sim"))
from simulator import ROOT, main  # noqa: E402

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


def test_links_lead_somewhere(_):
    assert links.check() == 0


def test_a_link_to_no_heading_is_noticed(folder):
    page = folder / "page.md"
    page.write_text("# One thing, `two`\n[good](#one-thing-two) [none](#three) `[code](#x)`\n```\n[code](#y)\n```\n", encoding="utf-8")
    assert [anchor for _, anchor in links.targets(page)] == ["one-thing-two", "three"], list(links.targets(page))
    assert links.anchors(page) == {"one-thing-two"}


if __name__ == "__main__":
    main()
