#!/usr/bin/env python3
"""Compiles the public headers of the library as strangers do. Four parts, each over all headers found in lib/include:
  cells     every compiler, language standard and warning of the file `cells`
  macros    behind the macros of other people's headers (the file `macros`)
  refusals  unsafe flags stop the compilation, with our sentence as the first error, whichever header comes first
  safe      safe flags do not

usage: check.py [PART...]      Prints one line a check, "ok NAME" or "FAIL NAME", and the compiler's first words."""
import concurrent.futures
import glob
import os
import re
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
INCLUDE = os.path.join(ROOT, "lib/include")
USE = os.path.join(HERE, "use.cpp")

# what all cells share: the project's own strict flags, and the flags of the bits
STRICT = ("-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wdouble-promotion -Wshadow -Werror "
          "-ffp-contract=off -fno-math-errno -fno-exceptions -fno-rtti").split()
# g++ checks promotions for both; clang 14 takes double{x} for an implicit one
NOT_CLANG = {"-Wdouble-promotion"}

STANDARD = "fairlead: C++17 or later is needed."
# flags, compilers that announce them, the sentence
REFUSED = [
    ("-std=c++14", ("g++-11", "g++-12", "clang++-14", "clang++-16", "clang++-19"), STANDARD),
    ("-std=gnu++11", ("g++-12", "clang++-14", "arm-none-eabi-g++"), STANDARD),
    ("-ffast-math", ("g++-11", "g++-12", "clang++-14", "clang++-16", "clang++-19", "arm-none-eabi-g++"),
     "fairlead: -ffast-math (or -Ofast) breaks the tolerance"),
    ("-Ofast", ("g++-11", "g++-12", "clang++-14"), "fairlead: -ffast-math (or -Ofast) breaks the tolerance"),
    ("-ffp-model=fast", ("clang++-14", "clang++-19"), "fairlead: -ffast-math (or -Ofast) breaks the tolerance"),
    ("-ffinite-math-only", ("g++-11", "g++-12", "clang++-14", "clang++-16", "clang++-19"),
     "fairlead: -ffinite-math-only hides NaN"),
    ("-funsafe-math-optimizations", ("g++-12", "arm-none-eabi-g++"), "fairlead: -fassociative-math (or"),
    ("-fassociative-math -fno-signed-zeros -fno-trapping-math", ("g++-12",), "fairlead: -fassociative-math (or"),
    ("-freciprocal-math", ("g++-12", "arm-none-eabi-g++"), "fairlead: -freciprocal-math changes quotients"),
    ("-fno-signed-zeros", ("g++-12",), "fairlead: -fno-signed-zeros changes"),
    ("-m32 -mfpmath=387", ("g++-12",), "fairlead: floats have excess precision"),
    ("-m32 -mno-sse", ("clang++-14", "clang++-16", "clang++-19"), "fairlead: floats have excess precision"),
    ("-mfpmath=sse+387", ("g++-11", "g++-12"), "fairlead: floats have excess precision"),
    ("-fsingle-precision-constant", ("g++-11", "g++-12", "arm-none-eabi-g++"),
     "fairlead: remove -fsingle-precision-constant"),
]
# MSVC's spelling of the standard: its own macro decides, where there is one
MSVC = [("-D_MSVC_LANG=201402L", True), ("-D_MSVC_LANG=201703L", False), ("-D_MSVC_LANG=202002L", False)]
SAFE = ["-O0", "-Os", "-O3 -funroll-loops", "-flto", "-mfma -ffp-contract=off", "-march=native -ffp-contract=off",
        "-fno-trapping-math", "-frounding-math", "-fno-math-errno", "-std=gnu++20", "-DNDEBUG", "-funsigned-char",
        "-fno-strict-aliasing", "-fwrapv", "-m32 -msse2 -mfpmath=sse"]


def headers():
    found = glob.glob(INCLUDE + "/**/*.hpp", recursive=True)
    return sorted(os.path.relpath(h, INCLUDE) for h in found)


def borrowed(flags):
    """Debian has no C++ library for RISC-V and Xtensa: the headers of the Arm one serve to compile, not to link."""
    newest = sorted(glob.glob("/usr/include/newlib/c++/*"))[-1:]
    folders = {"ARM_CXX": [f for n in newest for f in ("-isystem", n, "-isystem", n + "/arm-none-eabi")],
               "ARM_C": ["/usr/include/newlib"], "PICOLIBC": ["/usr/lib/picolibc/riscv64-unknown-elf/include"]}
    return [word for flag in flags for word in folders.get(flag, [flag])]


def run(command):
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    return done.returncode == 0, done.stdout + done.stderr


def compile_one(compiler, flags, source, before=()):
    warn = [f for f in STRICT if not (compiler.startswith("clang") and f in NOT_CLANG)]
    flags = borrowed(flags)
    kind = [] if "-c" in flags else ["-fsyntax-only"]
    what = [word for name in before for word in ("-include", name)]
    out = ["-o", os.devnull] if "-c" in flags else []
    return run([compiler, *warn, *flags, *kind, "-I" + INCLUDE, *what, "-x", "c++", source, *out])


class Report:
    def __init__(self):
        self.failed = False

    def line(self, name, fine, detail, said=""):
        self.failed |= not fine
        errors = [l for l in said.splitlines() if "error" in l] or said.strip().splitlines() or ["it compiled"]
        first = "" if fine else "\n    " + "\n    ".join(errors[:3])
        print("%-4s %-44s %s%s" % ("ok" if fine else "FAIL", name, detail, first), flush=True)


def all_headers(folder):
    path = folder + "/all.hpp"
    with open(path, "w") as file:
        file.writelines('#include "%s"\n' % h for h in headers())
    return path


def cells(report, pool, folder):
    everything = all_headers(folder)
    jobs = []
    for line in open(HERE + "/cells"):
        if line.strip() and not line.startswith("#"):
            name, compiler, standard, flags = (part.strip() for part in line.split("|"))
            each = compiler.startswith("each ")
            compiler = compiler.split()[-1]
            flags = ["-std=" + standard, *flags.split()]
            if each:
                tried = [pool.submit(compile_one, compiler, flags, os.devnull, [INCLUDE + "/" + h]) for h in headers()]
            else:
                tried = [pool.submit(compile_one, compiler, flags, USE, [everything])]
            jobs.append((name, compiler, flags, len(headers()) if each else 0, tried))
    for name, compiler, flags, alone, tried in jobs:
        results = [t.result() for t in tried]
        bad = [said for fine, said in results if not fine]
        how = "%d headers, each alone" % alone if alone else "all headers and use.cpp"
        _, version = run([compiler, "-dumpversion" if compiler.startswith("clang") else "-dumpfullversion"])
        report.line(name, not bad, "%-24s %-8s %s: %s" % (compiler, version.strip(), how, " ".join(flags)),
                    bad[0] if bad else "")


def macro_names():
    digits = [format(i, "0%db" % n) for n in range(1, 9) for i in range(2 ** n)]
    for line in open(HERE + "/macros"):
        for word in ([] if line.startswith("#") else line.split()):
            span = re.search(r"\{(\w+)\.\.(\w+)\}", word)
            if "{digits:8}" in word:
                yield from (word.replace("{digits:8}", d) for d in digits)
            elif span and span[1].isdigit():
                yield from (word.replace(span[0], str(i)) for i in range(int(span[1]), int(span[2]) + 1))
            elif span:
                yield from (word.replace(span[0], chr(i)) for i in range(ord(span[1]), ord(span[2]) + 1))
            else:
                yield word


def macro_header(folder):
    """Standard headers first, as a core includes them: then every macro, with an expansion that no code survives."""
    standard = set()
    for h in headers():
        standard |= set(re.findall(r"^\s*#\s*include <([a-z_]+)>", open(INCLUDE + "/" + h).read(), re.M))
    path = folder + "/hostile.hpp"
    with open(path, "w") as file:
        file.write("#pragma GCC system_header\n" + "".join("#include <%s>\n" % s for s in sorted(standard)))
        for name in sorted(set(macro_names())):
            bare = name.replace("()", "")
            file.write("#undef %s\n#define %s @ macro %s\n" % (bare, name.replace("()", "(...)"), bare))
    return path


def macros(report, pool, folder):
    hostile, everything = macro_header(folder), all_headers(folder)
    count = len(set(macro_names()))
    for compiler in ("g++-12", "clang++-14", "arm-none-eabi-g++"):
        fine, said = compile_one(compiler, ["-std=gnu++17"], os.devnull, [hostile, everything])
        report.line("macros, " + compiler, fine, "%d headers behind %d macros" % (len(headers()), count), said)
    # the macros do bite: the names that the library once had do not compile behind them
    for word in ("int sq(int);", "int abs(int);", "const int PI = 3;", "int F(int);", "struct small {};"):
        planted = folder + "/planted.hpp"
        with open(planted, "w") as file:
            file.write(word + "\n")
        fine, said = compile_one("g++-12", ["-std=gnu++17"], os.devnull, [hostile, planted])
        report.line("macros notice: " + word, not fine, "", said)


def first_error(said):
    return next((line for line in said.splitlines() if "error:" in line), "")


def refusals(report, pool, folder):
    everything = all_headers(folder)
    for flags, compilers, sentence in REFUSED:
        for compiler in compilers:
            standard = [] if "-std" in flags else ["-std=c++17"]
            fine, said = run([compiler, *standard, *flags.split(), "-I" + INCLUDE, "-fsyntax-only", "-w", "-x", "c++", everything])
            report.line("refused: %s, %s" % (flags, compiler), not fine and sentence in first_error(said),
                        first_error(said).partition("error: ")[2], said)
    for flag, refused in MSVC:
        fine, said = run(["clang++-14", "-std=c++17", flag, "-I" + INCLUDE, "-fsyntax-only", "-x", "c++", everything])
        told = STANDARD in first_error(said)
        report.line("%s: %s" % ("refused" if refused else "accepted", flag), told if refused else fine, "", said)
    # whichever header comes first, the sentence comes before any other error
    tried = [(h, pool.submit(run, ["g++-12", "-std=c++14", "-I" + INCLUDE, "-fsyntax-only", "-w", "-x", "c++", INCLUDE + "/" + h]))
             for h in headers()]
    late = [h for h, t in tried if STANDARD not in first_error(t.result()[1])]
    report.line("refused by each of %d headers alone" % len(tried), not late, "", "\n".join(late))


def safe(report, pool, folder):
    everything = all_headers(folder)
    for compiler in ("g++-12", "clang++-14"):
        for flags in SAFE:
            standard = [] if "-std" in flags else ["-std=c++17"]
            fine, said = run([compiler, *standard, *flags.split(), "-I" + INCLUDE, "-fsyntax-only", "-x", "c++", everything])
            report.line("accepted: %s, %s" % (flags, compiler), fine, "", said)


PARTS = {"cells": cells, "macros": macros, "refusals": refusals, "safe": safe}


def main():
    wanted = sys.argv[1:] or list(PARTS)
    unknown = [p for p in wanted if p not in PARTS]
    if unknown or not headers():
        sys.exit("usage: check.py [%s]...; no such part: %s" % ("|".join(PARTS), " ".join(unknown)))
    report, start = Report(), time.monotonic()
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for part in wanted:
            PARTS[part](report, pool, folder)
    print("compilers: %s in %.0f s" % ("FAILED" if report.failed else "all fine", time.monotonic() - start))
    sys.exit(report.failed)


if __name__ == "__main__":
    main()
