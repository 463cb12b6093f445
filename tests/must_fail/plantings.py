#!/usr/bin/env python3
"""Plants faults, one after the other, into a copy of the tree: a heap allocation, a libm sinf, a fused multiply-add, a
recursion, ten per cent more instructions, and arithmetic that rounds otherwise on one machine. The target checks must fail
each of them, for the right reason, and must pass the copy without a planting."""
import os
import re
import shutil
import subprocess
import sys
import tempfile

QUAT = "lib/include/fairlead/math/quat.hpp"

# name, file, pattern, replacement, what the failure must say
PLANTINGS = [
    ("heap allocation", QUAT, r"(inline BasicVec3<R> log\(.*?\{\n)",
     r"\1    static R* volatile kept = new R{};\n    *kept = q.w;\n", r"_sbrk|heap:"),
    ("libm sinf", QUAT, r"s = sc\.sin / n;", r"s = static_cast<R>(__builtin_sinf(static_cast<float>(n))) / n;",
     r"C library: libm"),
    ("fused multiply-add", ".ci/flags.mk", r"-ffp-contract=off", r"-ffp-contract=fast", r"fused multiply-add: vfm"),
    ("recursion", QUAT, r"(template <class R>\ninline BasicVec3<R> log\(.*?\{\n)(.*?return )(\(approx::atan2)",
     r"template <class R>\n[[gnu::noinline]] R planted(R x) {\n    return x > 4 ? planted(x / 2) + 1 : x;\n}\n"
     r"\1\2planted(n) / planted(n) * \3", r"recursion: "),
    ("ten per cent more instructions", QUAT, r"(inline R rotation_angle\(.*?\{\n)",
     r'\1    __asm__ volatile(".rept 32\\nnop\\n.endr");\n', r"worst found is \d+, committed \d+"),
    ("another rounding on one machine", QUAT, r"s = sc\.sin / n;",
     "s = sc.sin / n;\n#ifdef __arm__\n        s = sc.sin * (1 / n);\n#endif",
     r"FAIL same bits: stage quat differs between gcc-O2 and m4f; first at stream \S+, push \d+"),
]


def copy_tree(to):
    files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True,
                           check=True).stdout.splitlines()
    for name in files:
        if os.path.isfile(name):
            os.makedirs(os.path.join(to, os.path.dirname(name)), exist_ok=True)
            shutil.copy2(name, os.path.join(to, name))


def check(tree):
    command = ["make", "-s", "-Otarget", "-j%d" % os.cpu_count(), "-f", "tests/target/target.mk", "CORES=gcc-O2 m4f",
               "SUBJECTS=none quat", "same-bits", "bounds", "ROWS=1"]
    env = {k: v for k, v in os.environ.items() if not k.startswith("MAKE") and k != "MFLAGS"}
    done = subprocess.run(command, cwd=tree, capture_output=True, text=True, env=env)
    return done.returncode == 0, done.stdout + done.stderr


def plant(tree, path, pattern, replacement):
    with open(os.path.join(tree, path)) as file:
        before = file.read()
    after, count = re.subn(pattern, replacement, before, count=1, flags=re.S)
    if count != 1:
        raise SystemExit("FAIL planting: nothing in %s matches %s" % (path, pattern))
    with open(os.path.join(tree, path), "w") as file:
        file.write(after)
    return before


def main():
    failed = False
    with tempfile.TemporaryDirectory() as tree:
        copy_tree(tree)
        passes, said = check(tree)
        print("ok the tree without a planting" if passes else "FAIL the tree without a planting\n" + said)
        failed |= not passes
        for name, path, pattern, replacement, must_say in PLANTINGS:
            before = plant(tree, path, pattern, replacement)
            passes, said = check(tree)
            caught = not passes and re.search(must_say, said)
            line = next((l for l in said.splitlines() if re.search(must_say, l)), "")
            print("%s caught: %s   %s" % ("ok" if caught else "FAIL", name, line.strip()[-120:] if caught else "\n" + said))
            failed |= not caught
            with open(os.path.join(tree, path), "w") as file:
                file.write(before)
            for core in ("gcc-O2", "m4f"):  # time stamps of the restored file are new: build it again
                shutil.rmtree(os.path.join(tree, "build/target", core), ignore_errors=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
