#!/usr/bin/env python3
"""Links of the pages: to files of the tree, and to headings.

usage: links.py              prints "ok" or "FAIL" lines: does every link of every page lead to a file, and to a heading of it?
       links.py --filter F   the page F for Doxygen, which knows no headings of other pages: each gets a name of its own"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s]*)\)")
HEADING = re.compile(r"^(#+) +(.*?)\s*$")


def slug(heading):
    """The anchor of a heading, as forges make it."""
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
    return re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


def lines_of(page):
    """(line, is it text): fenced and indented blocks are no text."""
    fenced = False
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
            yield line, False
        else:
            yield line, not fenced and not line.startswith("    ")


def anchors(page):
    return {slug(m[2]) for line, text in lines_of(page) if text and (m := HEADING.match(line))}


def targets(page):
    """(file, anchor) of each link to the tree."""
    for line, text in lines_of(page):
        for _, target in LINK.findall(re.sub(r"`[^`]*`", "", line)) if text else ():
            if not re.match(r"[a-z]+:", target):
                path, _, anchor = target.partition("#")
                yield (page.parent / path).resolve() if path else page, anchor


def check():
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, check=True, capture_output=True, text=True)
    pages = [ROOT / name for name in listed.stdout.split() if (ROOT / name).is_file()]
    failed, count = 0, 0
    for page in pages:
        for path, anchor in targets(page):
            count += 1
            good = path.exists() and (not anchor or (path.suffix == ".md" and anchor in anchors(path)))
            if not good:
                failed += 1
                print(f"FAIL {page.relative_to(ROOT)}: no {path}{'#' + anchor if anchor else ''}")
    assert count > 100, f"{count} links in {len(pages)} pages"
    print(f"{'FAIL' if failed else 'ok'} {count} links in {len(pages)} pages")
    return 1 if failed else 0


def name(page, anchor):
    return f"{page.resolve().relative_to(ROOT).with_suffix('').as_posix().replace('/', '-')}--{anchor}".lower()


def for_doxygen(page):
    def link(match):
        path, _, anchor = match[2].partition("#")
        if not anchor or ":" in match[2]:
            return match[0]
        return f"[{match[1]}](@ref {name(page.parent / path if path else page, anchor)})"

    for line, text in lines_of(page):
        heading = HEADING.match(line) if text else None
        if heading and len(heading[1]) > 1:
            line = f"{heading[1]} {heading[2]} {{#{name(page, slug(heading[2]))}}}"
        elif text:
            line = LINK.sub(link, line)
        print(line)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--filter"]:
        for_doxygen(pathlib.Path(sys.argv[2]))
    else:
        sys.exit(check())
