#!/usr/bin/python3
"""The tool of `make mutants` on a small library of its own: what a test holds is killed, what no test holds survives, and what
the compiler evaluates by itself is seen too."""
import pathlib
import sys
import tempfile

import sites
import suite
from together import Together

HEADER = """#pragma once
namespace small {
template <int N>
struct Sized { static constexpr int n = N; };
inline int larger(int a, int b) { return a > b ? a : b; }
inline int sum(int a, int b) {
    int s = a;
    s += b;
    return s;
}
inline int unused(int a) { return a - 1; }
inline int untested(int a) { return a * 3; }
inline long long forever(long long n) {  // counts the wrong way for centuries, not for a second
    long long i = 0;
    while (i < n) ++i;
    return i;
}
inline int size() { return Sized<4>::n; }
constexpr int at_build(int a) { return a + 2; }
constexpr int at_run(int a) { return a << 1; }
struct Begins { int n{6}; };
struct Half { int n; };
inline Half operator/(Half a, int b) { return {a.n >= 0 ? b : -1}; }
template <class T>
T first(T a, T) { return a; }
template <class T>
T divided(T a, T b) {
    return first(a,
                 b) / 2;  // the compiler refuses a product where the template is used, not here
}
}  // namespace small
"""
TEST = """#include "small/math.hpp"
static_assert(small::at_build(1) == 3);
int main(int argc, char**) {
    small::untested(7);
    if (small::at_run(argc) > 99) return 1;
    static_assert(small::Begins{}.n > 0);
    if (small::divided(small::Half{1}, small::Half{1}).n != 2) return 1;
    return small::larger(2, 1) == 2 && small::larger(1, 2) == 2 && small::sum(1, 2) == 3 && small::forever(5) == 5 &&
                   small::size() == 4 ? 0 : 1;
}
"""
EXPECTED = {  # the text before, the operator: what becomes of it
    (" > ", "negated relation"): "killed", (" > ", "relation"): "survived", (" += ", "arithmetic"): "killed",
    ("s += b;", "statement"): "killed", (" - ", "arithmetic"): "not reached", (" * ", "arithmetic"): "survived",
    ("++", "step"): "timeout", ("4", "constant"): "killed", (" + ", "arithmetic"): "killed", ("i < n", "condition"): "killed",
    (" / ", "arithmetic"): "stillborn", (" << ", "logic"): "survived", ("6", "constant"): "survived",
}


def main():
    suite.PRECOMPILED = ""
    suite.Suite.cpu_seconds_min = 1
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder).resolve()
        lib, tests = root / "lib/include/small", root / "tests/unit"
        for place in (lib, tests):
            place.mkdir(parents=True)
        header = lib / "math.hpp"
        header.write_text(HEADER, encoding="utf-8")
        (tests / "test_math.cpp").write_text(TEST, encoding="utf-8")
        judge = suite.Suite(root / "build", "-std=c++17 -O1 -fwrapv -Ilib/include", [], 1, root)
        found = [s for s in sites.sites(HEADER) if (s[2], s[0]) in EXPECTED]
        together = Together(judge, lib, [(header, s) for s in found], 1)
        assert len(found) == len(EXPECTED), found
        # what the compiler evaluates itself is found: in a static_assert, in an argument of a template
        test = judge.sources[0]
        folded = {site[2] for k, site in enumerate(found, 1) if k in together.spans and together.folds(k, test)}
        assert folded == {" + ", "4", "6"}, folded
        for k, site in enumerate(found, 1):
            outcome, _ = together.judge(k)
            ok = outcome == EXPECTED[site[2], site[0]]
            print(f"{'ok' if ok else 'FAIL'} {site[0]} {site[2].strip()!r} -> {site[3].strip()!r}: {outcome}", flush=True)
            if not ok:
                sys.exit(1)


main()
