#!/usr/bin/env python3
"""The README keeps its word: its example compiles and runs, its demo output is the real one.

`tests/sim/test_readme.py --write` puts the present output of make demo into the page."""
import os
import re
import subprocess
import sys

from simulator import ROOT, main

README = ROOT / "README.md"
DEMO = re.compile(r"(<!-- demo: .*? -->\n```\n)(.*?)(```\n)", re.DOTALL)
STRICT = ("-std=c++17 -O1 -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion "
          "-Wdouble-promotion -Wshadow -Werror -ffp-contract=off -fno-exceptions -fno-rtti").split()


def demo_output():
    build = os.environ.get("BUILD", "build")
    done = subprocess.run(["make", "-s", "demo", f"BUILD={build}"], cwd=ROOT, check=True,
                          capture_output=True, text=True, timeout=600,
                          env={k: v for k, v in os.environ.items() if not k.startswith("MAKE")})
    lines = [line for line in done.stdout.splitlines() if not line.startswith("setup: ")]
    return "\n".join(lines).replace(f"{build}/", "build/") + "\n"


def test_example_compiles_and_runs(folder):
    code = re.search(r"```cpp\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL).group(1)
    body = code.split("int main")[1].splitlines()
    assert len(body) <= 20, len(body)
    source, program = folder / "example.cpp", folder / "example"
    source.write_text(code, encoding="utf-8")
    compiler = os.environ.get("CXX", "g++").split()
    subprocess.run([*compiler, *STRICT, f"-I{ROOT}/lib/include", source, "-o", program], check=True)
    said = subprocess.run([program], check=True, capture_output=True, text=True, timeout=60).stdout
    sent = int(re.fullmatch(r"(\d+) bytes for 1200 poses\n", said).group(1))
    assert 0 < sent < 1200 * 36 / 20, sent


def test_demo_output_is_the_real_one(_):
    shown, real = DEMO.search(README.read_text(encoding="utf-8")).group(2), demo_output()
    assert shown == real, f"run tests/sim/test_readme.py --write\n{shown}\nis not\n{real}"


def test_links_lead_somewhere(_):
    for target in re.findall(r"\]\(([^)#]+)\)", README.read_text(encoding="utf-8")):
        assert (ROOT / target).exists(), target


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        page = README.read_text(encoding="utf-8")
        README.write_text(DEMO.sub(lambda m: m[1] + demo_output() + m[3], page), encoding="utf-8")
    else:
        main()
