"""Judges many mutants with one compilation of each test: every mutation is a switch (switches.py), and a run chooses one."""
import concurrent.futures
import hashlib
import json
import pathlib
import re
import tempfile
import threading

import switches
from sites import mutated


class Together:
    """Test programs that hold all switches.

    @param mutants  list of (header, site); those that are switches have a span in `spans`, by their number from 1"""

    def __init__(self, suite, lib, mutants, jobs):
        self.suite, self.lib, self.mutants = suite, lib, mutants
        self.texts = {h: h.read_text(encoding="utf-8") for h, _ in mutants}
        headers = switches.Headers(sorted(self.texts), suite.flags)
        self.spans, self.constant = {}, {}
        for k, (header, site) in enumerate(mutants, 1):
            text = self.texts[header]
            path = headers.path(header, site[1], site[1] + len(site[2].rstrip()))
            span = switches.extent(path, text, site)
            self.constant[k] = switches.in_constant(path, text)
            if span and not any(h == header and span[0] < b and a < span[1] for h, (a, b) in
                                ((mutants[j - 1][0], s) for j, s in self.spans.items())):
                self.spans[k] = span
        self.overlay, self.lock = suite.work / "together", threading.Lock()
        self.refused = self.overlay / "refused.json"  # digests of switches that do not compile, of this call and earlier ones
        if self.refused.exists():
            known = set(json.loads(self.refused.read_text(encoding="utf-8")))
            self.spans = {k: span for k, span in self.spans.items() if self.digest(k) not in known}
        self.generation = 0  # of the switched headers
        self.write()
        with tempfile.NamedTemporaryFile("w", suffix=".cpp", dir=suite.work) as source:
            source.write(switches.SOURCE % (len(mutants) + 1))
            source.flush()
            suite.call([*suite.compiler, *suite.flags, "-c", source.name, "-o", self.overlay / "switches.o"])
        self.drop_refused(lambda: suite.compile(self.everything(), self.overlay, None))
        tests = [s for s in suite.sources if any(h.resolve() in suite.includes[s] for h in self.changed())]
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            self.tests = dict(t for t in pool.map(self.prepare, tests) if t)

    def changed(self):
        return {self.mutants[k - 1][0] for k in self.spans}

    def place(self, header):
        return self.overlay / header.relative_to(self.lib.parent)

    def digest(self, k):
        """Of a mutant and its header."""
        header, site = self.mutants[k - 1]
        return hashlib.sha256(f"{self.texts[header]} {site}".encode()).hexdigest()

    def write(self):
        """Writes the headers with their switches, and removes those of an earlier draw. Each stays on its line."""
        for old in set(self.overlay.rglob("*.hpp")) - {self.place(h) for h in self.texts}:
            old.unlink()
        for header, text in self.texts.items():
            found = [(k, self.mutants[k - 1][1], span) for k, span in self.spans.items() if self.mutants[k - 1][0] == header]
            place = self.place(header)
            place.parent.mkdir(parents=True, exist_ok=True)
            whole = switches.switched(text, found)
            if not place.exists() or place.read_text(encoding="utf-8") != whole:
                beside = place.with_suffix(".new")
                beside.write_text(whole, encoding="utf-8")
                beside.replace(place)  # a compiler that runs reads the old one or the new one
        (self.overlay / "switches.hpp").write_text(switches.HEADER, encoding="utf-8")

    def everything(self):
        source = self.overlay / "everything.cpp"
        source.write_text("".join(f'#include "{h.relative_to(self.lib.parent)}"\n' for h in sorted(self.texts)), encoding="utf-8")
        return source

    def drop_refused(self, compile_once):
        """Compiles until it passes; switches on refused lines are taken out. @return whether it passed"""
        for _ in range(20):
            texts = self.generation
            refused = compile_once()
            if refused is None:
                return True
            at = {(f, int(line)) for f, line in re.findall(rf"({re.escape(str(self.overlay))}/\S+?):(\d+):", refused)}
            guilty = [k for k, (a, _) in list(self.spans.items()) if (str(self.place(self.mutants[k - 1][0])),
                      self.texts[self.mutants[k - 1][0]].count("\n", 0, a) + 1) in at]
            if not guilty and texts == self.generation:  # another test may have had it taken out
                raise SystemExit(f"FAIL the switched headers do not compile:\n{refused[:3000]}")
            with self.lock:
                for k in guilty:
                    self.spans.pop(k, None)
                earlier = json.loads(self.refused.read_text(encoding="utf-8")) if self.refused.exists() else []
                self.refused.write_text(json.dumps([*earlier, *(self.digest(k) for k in guilty)]), encoding="utf-8")
                self.write()
                self.generation += 1
        return False

    def key(self, source):
        """Changes with everything of ours that the program is made of."""
        made = hashlib.sha256(" ".join(self.suite.flags).encode() + switches.SOURCE.encode() + bytes([len(self.mutants) % 256]))
        for file in sorted(f for f in self.suite.includes[source] if self.suite.root in f.parents):
            ours = self.place(file) if file in self.texts else file
            made.update(ours.read_bytes())
        return made.hexdigest()

    def prepare(self, source):
        """Compiles, links and runs a test, unless the last call left it so. @return (test, (program, seconds of CPU,
        which switches it met))"""
        name = f"{source.parent.name}_{source.stem}"
        out, program, known = (self.overlay / f"{name}{end}" for end in (".o", "", ".json"))
        if known.exists():
            kept = json.loads(known.read_text(encoding="utf-8"))
            if kept["key"] == self.key(source):
                return source, (program, kept["seconds"], bytes.fromhex(kept["reached"]))
        if not self.drop_refused(lambda: self.suite.compile(source, self.overlay, out)):
            return None
        key = self.key(source)
        self.suite.link([out, self.overlay / "switches.o"], program)
        out.unlink()
        reached = self.overlay / f"{name}.reached"
        outcome, seconds = self.suite.run(program, 600, REACHED=str(reached))
        if outcome != "passed":
            raise SystemExit(f"FAIL {source.name} fails with every switch off")
        met = reached.read_bytes()
        known.write_text(json.dumps({"key": key, "seconds": seconds, "reached": met.hex()}), encoding="utf-8")
        return source, (program, seconds, met)

    def judge(self, k):
        """@return (outcome, by which test)"""
        outcome, by = self.judge_switch(k) if k in self.spans else (None, "")
        return self.judge_alone(k) if outcome is None else (outcome, by)

    def folds(self, k, source):
        """Does the compiler evaluate the place itself in this test? If not, the runs with the switch on have judged it."""
        if k not in self.spans or source not in self.tests or self.constant[k] == "always":
            return True
        return self.suite.compile(source, self.overlay, None, [f"-DFOLDED=k == {k}"]) is not None

    def judge_alone(self, k):
        """By compilations of its own."""
        header, site = self.mutants[k - 1]
        with tempfile.TemporaryDirectory(dir=self.suite.work) as folder:
            overlay = pathlib.Path(folder)
            changed = overlay / header.relative_to(self.lib.parent)
            changed.parent.mkdir(parents=True)
            changed.write_text(mutated(self.texts[header], site), encoding="utf-8")
            seconds = {s: t[1] for s, t in self.tests.items()}
            return self.suite.judge(header, overlay, lambda source: self.folds(k, source), seconds)

    def judge_switch(self, k):
        """By runs with the switch on. @return (outcome, by which test); outcome None: this cannot tell"""
        header = self.mutants[k - 1][0]
        met = [s for s in self.suite.of(header) if s in self.tests and self.tests[s][2][k]]
        met.sort(key=lambda s: (-self.suite.noticed[header, s], self.tests[s][1]))
        for source in met:
            program, seconds, _ = self.tests[source]
            outcome, _ = self.suite.run(program, self.suite.limit(seconds), MUTANT=str(k))
            if outcome != "passed":
                self.suite.noticed[header, source] += 1
                return ("killed" if outcome == "failed" else "timeout"), source.stem
        # a number may stand in a type, or be the size of an array
        if self.constant[k] != "never" or (not met and self.mutants[k - 1][1][0] == "constant"):
            return None, ""
        return ("survived" if met else "not reached"), ""
