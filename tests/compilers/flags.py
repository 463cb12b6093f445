#!/usr/bin/env python3
"""Builds drain.cpp with flags that keep IEEE 754 and with flags that give it up, with and without NDEBUG, and runs it.
Flags that keep it must give the same bytes and no sample beyond the tolerance. With the others no run may crash, hang or
write outside its memory, and each accepted sample must be covered. The table of docs/portability.md is made
here.

usage: flags.py [--write]      --write: put the table into docs/portability.md; else compare it"""
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
PAGE = os.path.join(ROOT, "docs/portability.md")
COMMON = ["-std=c++17", "-w", "-Ilib/include", "-I."]
# as a compiler that announces nothing: the refusals of base/compiler.hpp do not see these flags
SILENT = ["-U__FAST_MATH__", "-U__FINITE_MATH_ONLY__", "-U__ASSOCIATIVE_MATH__", "-U__RECIPROCAL_MATH__",
          "-U__NO_SIGNED_ZEROS__", "-U__FLT_EVAL_METHOD__", "-D__FLT_EVAL_METHOD__=0"]

# compiler, flags: these keep IEEE 754
SAFE = [
    ("g++-12", "-O2 -ffp-contract=off"),  # the first one is the reference
    ("clang++-14", "-O2 -ffp-contract=off"),
    ("g++-12", "-O3 -funroll-loops -ffp-contract=off"),
    ("g++-12", "-Os -flto -ffp-contract=off"),
    ("clang++-19", "-O3 -mfma -mavx2 -ffp-contract=off"),
    ("g++-12", "-O2 -mfma -ffp-contract=off"),
    ("g++-12", "-O2 -fno-trapping-math -frounding-math -fno-math-errno -ffp-contract=off"),
    ("g++-12", "-O2 -m32 -msse2 -mfpmath=sse -ffp-contract=off"),
]
# compiler, flags, announced to the headers (then refused: the run is with the refusal removed)
UNSAFE = [
    ("g++-12", "-O2 -mfma", False),  # contraction is GCC's default
    ("clang++-14", "-O2 -mfma -ffp-contract=fast", False),
    ("g++-11", "-O2 -funsafe-math-optimizations", False),
    ("clang++-14", "-O2 -funsafe-math-optimizations", False),
    ("clang++-19", "-O2 -freciprocal-math -fapprox-func", False),
    ("clang++-14", "-O2 -fno-signed-zeros", False),
    ("g++-12", "-O3 -ffast-math -mfma", True),
    ("clang++-19", "-O3 -ffast-math -mfma", True),
    ("g++-12", "-O2 -m32 -mfpmath=387", True),
]


def build_and_run(folder, compiler, flags, argument=()):
    name = re.sub(r"\W", "_", compiler + flags)
    program = os.path.join(folder, name[-200:])
    if not os.path.exists(program):
        done = subprocess.run([compiler, *COMMON, *flags.split(), HERE + "/drain.cpp", "-o", program],
                              capture_output=True, text=True, cwd=ROOT)
        if done.returncode != 0:
            return None, "does not compile: " + done.stderr[:300]
    try:
        done = subprocess.run([program, *argument], capture_output=True, text=True, timeout=60)
    except subprocess.TimeoutExpired:
        return None, "it hangs"
    if done.returncode != 0:
        return None, "exit %d: %s" % (done.returncode, done.stdout.strip()[-300:])
    return done.stdout.strip().splitlines()[-1], ""


def field(line, name):
    return re.search(name + r" ([\w ]+?)(?: \w+ |$)", line)[1] if name == "arithmetic" else re.search(name + r" (\S+)", line)[1]


def row(compiler, flags, bits, arithmetic, announced):
    shown = {"g++-12": "GCC 12", "g++-11": "GCC 11", "clang++-14": "Clang 14", "clang++-19": "Clang 19"}[compiler]
    return "| %s `%s` | %s | %s | %s |" % (shown, flags, "refused" if announced else "no", bits, arithmetic)


def put_table(rows, write):
    text = open(PAGE).read()
    begin, end = "<!-- flags -->\n", "<!-- end of flags -->"
    head, tail = text.partition(begin), text.partition(end)
    table = "| flags | announced to the headers | bits | `check_arithmetic()` |\n|---|---|---|---|\n" + "\n".join(rows) + "\n"
    fresh = head[0] + begin + table + end + tail[2]
    if write:
        with open(PAGE, "w") as file:
            file.write(fresh)
    return fresh == text or write


def main():
    write = "--write" in sys.argv[1:]
    failed, rows, start = False, [], time.monotonic()

    def line(name, fine, detail):
        nonlocal failed
        failed |= not fine
        print("%-4s %-64s %s" % ("ok" if fine else "FAIL", name, detail), flush=True)

    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        safe = [(c, f, pool.submit(build_and_run, folder, c, f)) for c, f in SAFE]
        unsafe = [(c, f, a, n, pool.submit(build_and_run, folder, c, " ".join([f, *(SILENT if a else []), n])))
                  for c, f, a in UNSAFE for n in ("", "-DNDEBUG")]
        reference = safe[0][2].result()[0]
        for compiler, flags, job in safe:
            got, why = job.result()
            same = got is not None and reference is not None and field(got, "digest") == field(reference, "digest")
            fine = same and field(got, "arithmetic") == "exact" and field(got, "beyond") == "0"
            line("same bits: %s %s" % (compiler, flags), fine, got or why)
            rows.append(row(compiler, flags, "the same" if same else "DIFFER", field(got, "arithmetic") if got else "-", False))
        got, why = build_and_run(folder, *SAFE[0], ["flush-to-zero"])
        line("flush-to-zero mode is noticed", got is not None and field(got, "arithmetic") == "flushed", got or why)
        for compiler, flags, announced, ndebug, job in unsafe:
            got, why = job.result()
            line("drains: %s %s %s" % (compiler, flags, ndebug), got is not None, got or why)
            noticed = got is not None and field(got, "arithmetic") != "exact"
            if not ndebug:
                line("noticed at run time: %s %s" % (compiler, flags), noticed, field(got, "arithmetic") if got else why)
                same = got is not None and reference is not None and field(got, "digest") == field(reference, "digest")
                rows.append(row(compiler, flags, "the same" if same else "others", field(got, "arithmetic") if got else "-", announced))
    line("the table of docs/portability.md", put_table(rows, write), "" if write else "flags.py --write renews it")
    print("flags: %s in %.0f s" % ("FAILED" if failed else "all fine", time.monotonic() - start))
    sys.exit(failed)


if __name__ == "__main__":
    main()
