"""The dearest path through linked machine code (implicit path enumeration). Every basic block gets a variable, how often
it runs in one push; what flows into a block flows out; a call runs its callee; and no loop head runs more often than a cap.
The linear program's maximum of executed instructions is a bound for every path that keeps the caps, also for those that
no stream took. Caps are counts per push: the loop constants of the code, as the loop heads reached them in the emulator.

The compiler's own helpers (soft floating point, division) branch by their operands: zeros, denormals, carries, shifts. Where
each of their blocks is capped like a loop head, too, the bound is that of operands as the streams bring them; without, of
operands that are all the dearest at once, which no number manages."""
import re
import subprocess


# what the search takes for one record, and what one frame's bytes take: no push does the most of each part of it
BUDGETED = re.compile(r"^_Z+NK?8fairlead\d+(?:(?P<search>reduce?|curve)|(?P<frames>wire?|code))\d")


def read_caps(path):
    """{address: runs} and {part: instructions}, as the counting plugin left them."""
    caps, parts = {}, {}
    for line in open(path):
        words = line.split()
        if words[0] == "part":
            parts[int(words[1])] = int(words[2])
        else:
            caps[int(words[0], 16)] = int(words[1])
    return caps, parts


class Graph:
    """Basic blocks of all code that the root can come to."""

    def __init__(self, image, root):
        self.root, flow = root, image.flow
        seen, starts, todo = set(), {root}, [root]
        while todo:
            at = todo.pop()
            if at in seen or at not in flow:
                continue
            seen.add(at)
            step, follower = flow[at]
            if step.jumps or step.call is not None or step.may_return:
                starts.update(t for t in (step.call, follower, *step.jumps) if t is not None)
            todo += [t for t in (step.call, follower if step.falls else None, *step.jumps) if t is not None]
        self.size, self.next, self.calls, self.returning, self.detouring = {}, {}, {}, set(), set()
        for start in sorted(starts & seen):
            at, size = start, 0
            while True:
                step, follower = flow[at]
                size += 1
                ends = (step.jumps or step.call is not None or step.may_return or not step.falls or follower in starts)
                if ends:
                    break
                at = follower
            self.size[start] = size
            if step.may_return:
                self.returning.add(start)
            if step.may_call:
                self.detouring.add(start)
            self.next[start] = list(dict.fromkeys(t for t in (*step.jumps, follower if step.falls else None) if t in seen))
            if step.call is not None:
                self.calls.setdefault(step.call, []).append(start)
        self.entries = {root} | set(self.calls)
        self.heads, self.back = self.loop_heads()
        self.branches = [b for b in self.size if image.is_helper(b) and b not in self.back]
        found = {b: BUDGETED.search(image.home(b)) for b in self.size}
        self.part = {b: ("search", "frames").index(f.lastgroup) + 1 if f else 0 for b, f in found.items()}

    def capped(self):
        """Lines for the counting plugin: whose runs must be counted; the first tells the calls that matter."""
        counted = [self.root] + self.heads + self.branches
        counted += [b for b in self.size if self.part[b] and b not in self.back]
        return ["%x %d %d\n" % (b, self.size[b], self.part[b]) for b in counted]

    def loop_heads(self):
        """Targets of edges that lead back up a depth-first walk: every cycle runs through one."""
        state, back = {}, {}
        for entry in sorted(self.entries):
            if entry in state:
                continue
            stack, state[entry] = [(entry, iter(self.next[entry]))], "open"
            while stack:
                block, rest = stack[-1]
                following = next(rest, None)
                if following is None:
                    state[block] = "done"
                    stack.pop()
                elif state.get(following) == "open":
                    back.setdefault(following, set()).add(block)
                elif following not in state:
                    state[following] = "open"
                    stack.append((following, iter(self.next[following])))
        return sorted(back), back

    def entered_only_by_head(self, head):
        """True where the loop's body cannot be reached but through its head."""
        seen, todo = set(), [e for e in self.entries if e != head]
        while todo:
            block = todo.pop()
            if block in seen or block == head:
                continue
            seen.add(block)
            todo += self.next[block]
        return not self.back[head] & seen

    def bound(self, caps, work, parts=None, any_operands=False):
        """Most instructions from the root's entry to its return. caps: block -> runs per push, parts: part -> instructions."""
        into = {b: [] for b in self.size}
        called = {callee: ["%s%x" % ("c" if b in self.detouring else "b", b) for b in callers]
                  for callee, callers in self.calls.items()}
        for block, following in self.next.items():
            for f in following:
                into[f].append("e%x_%x" % (block, f))
        lines = ["Maximize", " n: " + " + ".join("%d b%x" % (s, b) for b, s in self.size.items()), "Subject To"]
        for block in self.size:
            sources = into[block] + called.get(block, [])
            once = 1 if block == self.root else 0
            lines.append(" b%x %s = %d" % (block, "".join(" - " + s for s in sources), once))
            out = ["e%x_%x" % (block, f) for f in self.next[block]]
            if block in self.detouring:  # what follows runs with or without the detour or call
                lines += [" b%x - %s >= 0" % (block, v) for v in out + ["c%x" % block]]
            elif out:
                lines.append(" b%x %s %s 0" % (block, "".join(" - " + e for e in out), ">=" if block in self.returning else "="))
        for number, cap in (parts or {}).items():
            terms = ["%d b%x" % (s, b) for b, s in self.size.items() if self.part[b] == number]
            if terms:
                lines.append(" %s <= %d" % (" + ".join(terms), cap))
        for block in [] if any_operands else self.branches:
            lines.append(" b%x <= %d" % (block, caps[block]))
        for head in self.heads:
            cap = caps[head]
            lines.append(" b%x <= %d" % (head, cap))
            if cap > 0 and self.entered_only_by_head(head):
                inside = {"e%x_%x" % (b, head) for b in self.back[head]}
                entries = [s for s in into[head] if s not in inside] + called.get(head, [])
                if entries and head != self.root:
                    lines.append(" b%x %s <= 0" % (head, "".join(" - %d %s" % (cap, e) for e in entries)))
        with open(work + ".lp", "w") as file:
            file.write("\n".join(lines + ["End", ""]))
        done = subprocess.run(["glpsol", "--lp", work + ".lp", "-o", work + ".sol"], capture_output=True, text=True)
        text = open(work + ".sol").read() if done.returncode == 0 else ""
        value = re.search(r"^Objective: +\S+ = (\S+)", text, re.M)
        if "OPTIMAL" not in text or not value:
            raise RuntimeError("%s.lp has no solution: %s" % (work, done.stdout[-300:]))
        return int(float(value[1]) + 0.5)
