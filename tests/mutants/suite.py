"""The tests of lib as a judge of a changed header: which tests include it, how each is compiled against the change and run."""
import collections
import concurrent.futures
import os
import pathlib
import shlex
import signal
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRECOMPILED = """#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>
"""
BYTES_MAX = 4 << 30   # a changed loop may ask for all memory


class Suite:
    """The unit and law tests."""
    cpu_seconds_min = 10  # a test may take five times what it takes on the original, and this besides

    def __init__(self, build, flags, link, jobs, root=ROOT):
        self.root = root
        self.compiler = [os.environ.get("CXX", "g++")]
        self.flags = [*shlex.split(flags), "-g0", "-w"]
        self.libraries = ["-Wl,--start-group", *link, "-Wl,--end-group", "-lz", "-lgtest", "-lgtest_main", "-pthread"]
        self.work = build / "mutants"
        self.work.mkdir(parents=True, exist_ok=True)
        common = self.work / "common.hpp"
        common.write_text(PRECOMPILED, encoding="utf-8")
        self.call([*self.compiler, *self.flags, "-x", "c++-header", common, "-o", f"{common}.gch"])
        self.sources = sorted(p for folder in ("unit", "laws") for p in (root / "tests" / folder).glob("*.cpp"))
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            self.includes = dict(zip(self.sources, pool.map(self.read_includes, self.sources)))
        self.noticed = collections.Counter()  # mutants by (header, test): the likeliest test runs first

    def call(self, command):
        return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=True, cwd=self.root).stdout

    def read_includes(self, source):
        said = self.call([*self.compiler, *self.flags, "-MM", source])
        return {(self.root / name).resolve() for name in said.replace("\\\n", " ").split()[1:]}

    def of(self, header):
        """The tests that include a header: those that noticed its mutants before, those of its name, the short ones."""
        def order(source):
            name = source.stem.removeprefix("test_")
            far = 0 if name == header.stem else 1 if header.stem.startswith(name) or name.startswith(header.stem) else 2
            return -self.noticed[header, source], far, len(self.includes[source]), source
        return sorted((s for s in self.sources if header.resolve() in self.includes[s]), key=order)

    def compile(self, source, overlay, out, more=()):
        """Compiles a test; headers in `overlay` come before the library's. Without `out` only the grammar is checked.
        @return the compiler's refusal, else None."""
        first = [f"-I{overlay}"] if overlay else []
        included = [self.work / "common.hpp", *([overlay / "switches.hpp"] if overlay and (overlay / "switches.hpp").exists() else [])]
        command = [*self.compiler, *(f"-include{h}" for h in included), *first, *self.flags, *more, "-c", source,
                   *(["-o", out] if out else ["-fsyntax-only"])]
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, cwd=self.root, check=False)
        return done.stderr if done.returncode else None

    def link(self, objects, program):
        self.call([*self.compiler, *objects, *self.libraries, "-o", program])

    def run(self, program, cpu_seconds, **environment):
        """Runs a test until a part of it fails. @return ('passed', 'failed' or 'timeout', seconds of CPU)."""
        command = ["prlimit", f"--cpu={cpu_seconds}:{cpu_seconds + 2}", f"--as={BYTES_MAX}", "--core=0",
                   str(program), "--gtest_fail_fast", "--gtest_brief=1"]
        # the wall's clock ends only what sleeps: the machine may be busy with other work
        end = time.monotonic() + 60 * cpu_seconds
        with open(os.devnull, "wb") as nowhere:
            process = subprocess.Popen(command, stdout=nowhere, stderr=nowhere, cwd=self.root, env={**os.environ, **environment})
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > end:
                process.kill()
            time.sleep(0.02)
        process.returncode = os.waitstatus_to_exitcode(status)
        late = time.monotonic() > end or process.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
        return "timeout" if late else "failed" if process.returncode else "passed", usage.ru_utime + usage.ru_stime

    def limit(self, seconds):
        return int(self.cpu_seconds_min + 5 * seconds)

    def judge(self, header, overlay, differs, seconds):  # one mutant, compiled by itself
        """What the tests say of the changed copy of a header in `overlay`. differs(test): may it be another program? seconds: of
        CPU that a test takes on the original, as far as known. @return (outcome, by which test)."""
        for source in self.of(header):
            if not differs(source):
                continue
            out = overlay / f"{source.parent.name}_{source.stem}.o"
            refused = self.compile(source, overlay, out)
            if refused is not None:
                return ("killed" if "static assertion failed" in refused else "stillborn"), source.stem
            program = out.with_suffix(".run")
            self.link([out], program)
            outcome, _ = self.run(program, self.limit(seconds.get(source, self.cpu_seconds_min)))
            program.unlink()
            if outcome != "passed":
                self.noticed[header, source] += 1
                return ("killed" if outcome == "failed" else "timeout"), source.stem
            out.unlink()
        return "survived", ""
