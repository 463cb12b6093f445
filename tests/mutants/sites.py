"""Where a C++ source can be mutated, and how: operators, and the places in a text where each applies.

The sources are in the project's format, so that a binary operator stands between blanks, and a bracket of a template
does not. Comments, strings, directives, assertions and declarations of templates are left alone."""
import re

SWAPS = {
    "relation": [(" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > ")],
    "negated relation": [(" < ", " >= "), (" > ", " <= "), (" == ", " != "), (" != ", " == ")],
    "arithmetic": [(" + ", " - "), (" - ", " + "), (" * ", " / "), (" / ", " * "), (" += ", " -= "), (" -= ", " += ")],
    "logic": [(" && ", " || "), (" || ", " && "), (" & ", " | "), (" | ", " & "), (" << ", " >> "), (" >> ", " << ")],
    "extreme": [("(std::min)(", "(std::max)("), ("(std::max)(", "(std::min)("), ("std::min<", "std::max<"),
                ("std::max<", "std::min<")],
    "step": [("++", "--"), ("--", "++")],
}
NUMBER = re.compile(r"(?<![\w.'])(\d+(?:\.\d+)?(?:e-?\d+)?)(f|u)?(?![\w.'])")
CONDITION = re.compile(r"\b(if|while) \(")
STATEMENT = re.compile(r"^\s+(?:[\w.\[\]>()-]+ (?:[-+*/|&]?|<<|>>)= .*;|[\w.>-]+\(.*\);|\+\+\S+;|--\S+;)$")
UNTOUCHED = re.compile(r"^\s*(#|static_assert|FAIRLEAD_ASSERT|template|using|namespace|friend|explicit \w+\(|\[\[)")
OPERATORS = [*SWAPS, "constant", "condition", "statement", "sign"]


def blanked(text):
    """The text with comments and strings turned into blanks, at the same length."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group(0))
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', blank, text, flags=re.S)


def closing(text, at):
    """Index of the bracket that closes the one at `at`."""
    depth = 0
    for i in range(at, len(text)):
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        if depth == 0:
            return i
    return -1


def constant(value, suffix):
    if suffix == "f" or "." in value or "e" in value:
        return "1.0" if float(value) == 0 else f"({value}{suffix or ''} * 2)"
    return str(int(value) + 1)


def in_line(line, start, text):
    """Mutations of one line: operator, place, old, new."""
    for operator, swaps in SWAPS.items():
        for old, new in swaps:
            for match in re.finditer(re.escape(old), line):
                yield operator, start + match.start(), old, new
    for match in NUMBER.finditer(line):
        new = constant(match.group(1), match.group(2)) + (match.group(2) or "" if match.group(2) == "u" else "")
        if match.group(2) == "f" and new == "1.0":
            new = "1.0f"
        yield "constant", start + match.start(), match.group(0), new
    for match in CONDITION.finditer(line):
        end = closing(text, start + match.end() - 1)
        if end < 0 or "constexpr" in line[max(0, match.start() - 1):match.end() + 10]:
            continue
        inside = text[start + match.end():end]
        if not inside or ";" in inside or re.match(r"\s*(const )?[\w:<>]+[&*]? \w+ = ", inside):
            continue  # a declaration in the condition
        yield "condition", start + match.end(), inside, f"!({inside})"
    if STATEMENT.match(line) and not re.match(r"\s*(return|const|constexpr|static|auto)\b", line):
        body = line.strip()
        yield "statement", start + line.index(body), body, ";"
    for match in re.finditer(r"(?<=[(,=] )-(?=[a-z_])|(?<=\()-(?=[a-z_])|(?<=return )-(?=[a-z_])", line):
        yield "sign", start + match.start(), "-", "+"


def sites(text):
    """All mutations of a source: (operator, place, old, new)."""
    bare = blanked(text)
    start = 0
    for line in bare.split("\n"):
        if not UNTOUCHED.match(line) and "operator" not in line:
            for operator, at, old, new in in_line(line, start, bare):
                if text[at:at + len(old)] == old:
                    yield operator, at, old, new
        start += len(line) + 1


def mutated(text, site):
    _, at, old, new = site
    return text[:at] + new + text[at + len(old):]
