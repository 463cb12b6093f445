"""Builds many mutants into one program: each mutated expression becomes a choice between the changed one and
the original.

A switch is looked up when the program runs, so a test is compiled once for all mutants instead of once for each. Where the
compiler evaluates an expression itself, the original stands: such mutants are judged by compilations of their own, of the tests
that do not compile where such an evaluation is an error (FOLDED)."""
import pathlib
import re

import clang.cindex
from clang.cindex import CursorKind

HEADER = """#pragma once
namespace mutants {
extern int chosen;
extern unsigned char reached[];
inline bool now(int k) noexcept { reached[k] = 1; return chosen == k; }
#ifndef FOLDED
#define FOLDED false
#endif
inline void folds() noexcept {}  // no constant expression calls it
constexpr bool on(int k) noexcept {
    if (__builtin_is_constant_evaluated()) {
        if (k >= 0 && (FOLDED)) folds();
        return false;
    }
    return now(k);
}
}  // namespace mutants
"""
# MUTANT=k chooses a mutant; REACHED=file: which switches the run met, a byte each
SOURCE = """#include <cstdio>
#include <cstdlib>
namespace mutants {
extern unsigned char reached[];
unsigned char reached[%d];
static int choice() { const char* k = std::getenv("MUTANT"); return k ? std::atoi(k) : -1; }
extern int chosen;
int chosen = choice();
struct Tell {
    ~Tell() {
        const char* const path = std::getenv("REACHED");
        std::FILE* const file = path ? std::fopen(path, "wb") : nullptr;
        if (!file) return;
        std::fwrite(reached, 1, sizeof reached, file);
        std::fclose(file);
    }
} tell;
}  // namespace mutants
"""
FUNCTIONS = (CursorKind.FUNCTION_DECL, CursorKind.CXX_METHOD, CursorKind.CONSTRUCTOR, CursorKind.DESTRUCTOR,
             CursorKind.FUNCTION_TEMPLATE, CursorKind.CONVERSION_FUNCTION)


def whole(cursor):
    return cursor.extent.start.offset, cursor.extent.end.offset


def path_to(cursor, at, end):
    """The cursors from `cursor` down to the deepest that covers [at, end)."""
    path = [cursor]
    while True:
        found = None
        for child in path[-1].get_children():
            a, b = whole(child)
            if a <= at and end <= b:
                found = child
                break
        if found is None:
            return path
        path.append(found)


class Headers:
    """The library's headers, parsed."""

    def __init__(self, headers, flags):
        text = "".join(f'#include "{h}"\n' for h in headers)
        self.unit = clang.cindex.Index.create().parse("all.cpp", args=["-x", "c++", *flags], unsaved_files=[("all.cpp", text)])
        self.top = {}
        for child in self.unit.cursor.get_children():
            if child.location.file:  # as the compiler found it, which may be by a relative path
                self.top.setdefault(pathlib.Path(child.location.file.name).resolve(), []).append(child)

    def path(self, header, at, end):
        for top in self.top.get(header.resolve(), []):
            a, b = whole(top)
            if a <= at and end <= b:
                return path_to(top, at, end)
        return []


def extent(path, text, site):
    """What the switch of a mutation encloses: (begin, end), or None."""
    operator, at, old, _ = site
    token, end = at + len(old) - len(old.lstrip()), at + len(old.rstrip())
    if operator in ("constant", "condition", "statement"):
        return at, at + len(old)
    for cursor in reversed(path):
        a, b = whole(cursor)
        if not cursor.kind.is_expression():
            continue
        if operator in ("sign", "step", "extreme"):
            if a == token or (operator == "step" and b == end):
                # a call, not the name of what it calls
                if operator != "extreme" or text[b - 1] == ")" and b > end + 1:
                    return a, b
        elif a < token and b > end:
            return a, b
    return None


def in_constant(path, text):
    """Whether the compiler evaluates the place by itself: always, sometimes (a constexpr function, the value that a member begins
    with) or never."""
    function, sometimes = None, False
    for cursor in path:
        if cursor.kind in FUNCTIONS:
            function = cursor
        if cursor.kind in FUNCTIONS or cursor.kind == CursorKind.VAR_DECL:
            a, b = whole(cursor)
            if "constexpr" in text[a:min(text.find(c, a, b) % (b + 1) for c in "{=")]:
                if cursor.kind == CursorKind.VAR_DECL:
                    return "always"
                sometimes = True
    member = path and path[-1].kind.is_expression() and any(c.kind == CursorKind.FIELD_DECL for c in path)
    return "sometimes" if sometimes or member else "never" if function else "always"


def replacement(text, site, span, k):
    """The text of `span` with a switch."""
    operator, at, old, new = site
    a, b = span
    original = text[a:b]
    # on one line, so that the original stays on its own lines and a refusal names the first one
    changed = " ".join(re.sub(r"//[^\n]*", "", text[a:at] + new + text[at + len(old):b]).split())
    if operator == "statement":
        return f"{{ if (!mutants::on({k})) {original} }}"
    if operator == "condition":
        return f"mutants::on({k}) ? {changed} : static_cast<bool>({original})"
    return f"(mutants::on({k}) ? ({changed}) : ({original}))"


def switched(text, switches):
    """The text with all switches: a list of (k, site, span) whose spans do not overlap."""
    for k, site, span in sorted(switches, key=lambda s: -s[2][0]):
        text = text[:span[0]] + replacement(text, site, span, k) + text[span[1]:]
    return text
