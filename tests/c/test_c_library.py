#!/usr/bin/env python3
"""The C interface: for a tracker, an IMU and a vector the header and the archive are made as docs/c.md says, the header compiles
strictly as C99, C11 and C++, a program in C (checks.c) finds everything as the header promises, and its frames equal those of the same
records through the pipeline in C++. The commands of docs/c.md run as they are written there."""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("BUILD", "build")).resolve() / "tests" / "c"
STRICT = ["-Wall", "-Wextra", "-Wshadow", "-Wconversion", "-pedantic", "-Werror"]
CONFIGS = {"tracker": "examples/firmware/config.hpp", "imu": "examples/firmware/config_imu.hpp", "vector": "tests/c/vector.hpp"}


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], cwd=ROOT, text=True, capture_output=True, timeout=600, check=False, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def make(*arguments):
    env = {k: v for k, v in os.environ.items() if not k.startswith("MAKE") and k not in ("MFLAGS", "BUILD", "CXX", "EXTRA")}
    return run("make", "-s", "SETUP=no", *arguments, env=env)


def check_config(name, config):
    folder = BUILD / name
    make("c-library", f"CONFIG={config}", f"BUILD={folder}")
    library = folder / "c-library" / "host"
    include, link = [f"-I{library}", "-I."], [f"-L{library}", "-lfairlead"]
    for compiler in filter(shutil.which, ("gcc", "clang")):
        for standard in ("c99", "c11"):
            run(compiler, f"-std={standard}", *STRICT, *include, "-fsyntax-only", "tests/c/checks.c")
    for compiler in filter(shutil.which, ("g++", "clang++")):
        run(compiler, "-std=c++11", *STRICT, *include, "-fsyntax-only", "-x", "c++", library / "fairlead.h", "-Wno-pragma-once-outside-header")
    # a C program needs neither libstdc++ nor libm
    run("gcc", "-std=c99", *STRICT, *include, "tests/c/checks.c", *link, "-o", folder / "checks")
    said = run(folder / "checks", folder / "frames_c")
    assert re.fullmatch(r"\d{4,} checks, 0 failed\n", said), said
    run("g++", "-std=c++17", "-ffp-contract=off", "-O1", "-I.", "-Ilib/include", f'-DFAIRLEAD_CONFIG="{config}"', "tests/c/frames.cpp",
        "-o", folder / "frames")
    run(folder / "frames", folder / "frames_cpp")
    c, cpp = (folder / "frames_c").read_bytes(), (folder / "frames_cpp").read_bytes()
    assert len(c) > 200 and c == cpp, f"{len(c)} bytes from C, {len(cpp)} from C++"


def check_page():
    """Commands of the page that need no cross compiler."""
    folder = BUILD / "page"
    text = (ROOT / "docs" / "c.md").read_text(encoding="utf-8")
    commands = [c.split(" #")[0].strip() for c in re.findall(r"^    ((?:make c-library|gcc|build/).*)$", text, re.MULTILINE)]
    commands = [c for c in commands if "CORE=" not in c]
    assert sum(c.startswith("gcc") for c in commands) >= 2, commands
    for command in commands:
        words = [w.replace("build/", f"{folder}/") for w in shlex.split(command)]
        said = make(*words[1:], f"BUILD={folder}") if words[0] == "make" else run(*words)
        assert words[0] in ("make", "gcc") or len(said.splitlines()) > 3, (command, said)


def main():
    failed = 0
    tests = [(name, lambda n=name, c=config: check_config(n, c)) for name, config in CONFIGS.items()] + [("page", check_page)]
    for name, test in tests:
        try:
            test()
            print(f"ok c_{name}", flush=True)
        except Exception as error:  # noqa: BLE001: any error of a test is its failure
            failed += 1
            print(f"FAIL c_{name}: {error}", flush=True)
    sys.exit(1 if failed else 0)


main()
