#!/usr/bin/env python3
"""Proof at link time: an object with the whole pipeline and the decoder asks for no heap, no
exceptions, no C library but the memory functions that compilers call by themselves."""
import os
import subprocess

from simulator import ROOT, main

ALLOWED = {"memcpy", "memmove", "memset", "memcmp", "__stack_chk_fail", "_GLOBAL_OFFSET_TABLE_"}
FLAGS = "-std=c++17 -fno-exceptions -fno-rtti -ffp-contract=off -fno-math-errno".split()


def undefined_symbols(folder, level):
    compiler = os.environ.get("CXX", "g++").split()
    target = folder / "no_heap.o"
    subprocess.run([*compiler, *FLAGS, level, f"-I{ROOT}/lib/include", "-c",
                    ROOT / "tests/sim/no_heap.cpp", "-o", target], check=True)
    listed = subprocess.run(["nm", "--undefined-only", "--format=just-symbols", target], check=True,
                            capture_output=True, text=True).stdout.split()
    return set(listed)


def test_optimised(folder):
    extra = undefined_symbols(folder, "-O2") - ALLOWED
    assert not extra, extra


def test_not_optimised(folder):
    extra = undefined_symbols(folder, "-O0") - ALLOWED
    assert not extra, extra


def test_the_look_finds_an_allocation(folder):
    source = folder / "heap.cpp"
    source.write_text("int* make() { return new int; }\n")
    subprocess.run(["g++", "-c", source, "-o", folder / "heap.o"], check=True)
    listed = subprocess.run(["nm", "--undefined-only", "--format=just-symbols", folder / "heap.o"],
                            check=True, capture_output=True, text=True).stdout.split()
    assert set(listed) - ALLOWED == {"_Znwm"}, listed


if __name__ == "__main__":
    main()
