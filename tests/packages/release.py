#!/usr/bin/env python3
"""Is the present commit ready to be tagged as a release? Checks what docs/versions.md asks for, prints one line a check, and
then the commands that make the release. Changes nothing.

usage: release.py [--tree FOLDER] [--url URL]"""
import argparse
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
failed = False


def line(name, fine, detail=""):
    global failed
    failed |= not fine
    print("%-4s %s%s" % ("ok" if fine else "FAIL", name, "" if fine or not detail else ": " + detail), flush=True)


def git(tree, *command):
    return subprocess.run(["git", "-C", tree, *command], capture_output=True, text=True, check=True).stdout


def numbers(text):
    return tuple(int(n) for n in text.lstrip("v").split("."))


def changelog(text, version):
    sections = re.split(r"^## ", text, flags=re.M)[1:]
    if not sections or not sections[0].startswith("Unreleased"):
        return "the first section must be 'Unreleased'"
    if re.search(r"^- ", sections[0], re.M):
        return "'Unreleased' still has entries: move them below a heading '## %s (YYYY-MM-DD)'" % version
    if len(sections) < 2 or not re.match(re.escape(version) + r" \(\d{4}-\d{2}-\d{2}\)\n", sections[1]):
        return "the second section must be '## %s (YYYY-MM-DD)'" % version
    return "" if re.search(r"^- ", sections[1], re.M) else "the section of %s is empty" % version


def archives(tree, url):
    """Two clean checkouts of the commit, in folders of other names, give the same bytes."""
    epoch = git(tree, "log", "-1", "--format=%ct").strip()
    made = []
    with tempfile.TemporaryDirectory() as folder:
        for name in ("one", "another"):
            checkout = os.path.join(folder, name)
            os.makedirs(checkout)
            packed = subprocess.run(["git", "-C", tree, "archive", "HEAD"], capture_output=True, check=True).stdout
            subprocess.run(["tar", "-x", "-C", checkout], input=packed, check=True)
            done = subprocess.run([checkout + "/lib/packages/dist.py", "--url", url, checkout + "/dist"], capture_output=True,
                                  text=True, env=dict(os.environ, SOURCE_DATE_EPOCH=epoch))
            if done.returncode != 0:
                return "", done.stderr
            made.append({n: open(checkout + "/dist/" + n, "rb").read() for n in sorted(os.listdir(checkout + "/dist"))})
    return (made[0]["SHA256SUMS"].decode(), "") if made[0] == made[1] else ("", "two checkouts give different archives")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tree", default=os.path.dirname(os.path.dirname(HERE)))
    parser.add_argument("--url", default=os.environ.get("PROJECT_URL", ""))
    options = parser.parse_args()
    tree = options.tree
    with open(tree + "/lib/include/fairlead/version.hpp") as file:
        text = file.read()
    version = ".".join(re.search(r"define FAIRLEAD_VERSION_%s (\d+)" % p, text)[1] for p in ("MAJOR", "MINOR", "PATCH"))
    print("release-check: version %s, commit %s" % (version, git(tree, "log", "-1", "--format=%h %s").strip()))
    left = git(tree, "status", "--porcelain")
    line("nothing is uncommitted", not left, left.splitlines()[0] if left else "")
    with open(tree + "/CHANGELOG.md") as file:
        why = changelog(file.read(), version)
    line("CHANGELOG.md has the section of %s" % version, not why, why)
    tags = [t for t in git(tree, "tag", "--list", "v*").split() if re.fullmatch(r"v\d+\.\d+\.\d+", t)]
    line("tag v%s is free" % version, "v" + version not in tags, "raise FAIRLEAD_VERSION_* in version.hpp")
    later = [t for t in tags if numbers(t) > numbers(version)]
    line("%s is later than every tag" % version, not later, " ".join(later))
    line("the manifests name the project's page", bool(options.url), "call with PROJECT_URL=https://...")
    sums, why = archives(tree, options.url)
    line("two clean checkouts give the same archives", bool(sums), why)
    if failed:
        print("release-check: not ready")
        sys.exit(1)
    print(sums, end="")
    print("release-check: ready. When bash .ci/run has passed for this commit:\n"
          "  git tag -a v%s -m 'fairlead %s'\n"
          "  SOURCE_DATE_EPOCH=%s make dist PROJECT_URL=%s\n"
          "  compare build/dist/SHA256SUMS with the lines above, then publish build/dist and the tag"
          % (version, version, git(tree, "log", "-1", "--format=%ct").strip(), options.url))


if __name__ == "__main__":
    main()
