#!/usr/bin/env python3
"""The same stream, byte for byte, from g++ and clang++, optimised and not.

Here on a generated recording; with arguments (make same-bytes) on those recordings as well."""
import shutil
import subprocess
import sys

from simulator import ROOT, main

FLAGS = "-std=c++17 -ffp-contract=off -fno-math-errno".split()
PARTS = "generate motion sensor_model".split()
BUILDS = [(c, o) for c in ("g++", "clang++") for o in ("-O0", "-O2")]
RECORDINGS = sys.argv[1:]


def hashes(folder, compiler, level):
    program = folder / f"same{compiler}{level}"
    sources = [ROOT / "tests/sim/same_bytes.cpp", *(ROOT / f"host_sim/generate/{p}.cpp" for p in PARTS),
               *sorted((ROOT / "host_sim/recording").glob("*.cpp"))]
    subprocess.run([compiler, *FLAGS, level, f"-I{ROOT}/lib/include", f"-I{ROOT}", *sources,
                    "-o", program], check=True)
    return subprocess.run([program, *RECORDINGS], check=True, capture_output=True, text=True).stdout


def test_every_compiler_and_level(folder):
    builds = [b for b in BUILDS if shutil.which(b[0])]
    first = hashes(folder, *builds[0])
    assert len(first.splitlines()) == 1 + len(RECORDINGS)
    for build in builds[1:]:
        other = hashes(folder, *build)
        assert other == first, f"{build}:\n{other}\nis not\n{first}"
    if len(builds) < len(BUILDS):
        return "clang++ is not installed: compared " + str(builds)
    return None


if __name__ == "__main__":
    main()
