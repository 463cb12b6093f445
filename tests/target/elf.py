"""What a linked image can be shown to do, from its disassembly alone: the deepest stack of a function and all that it
calls (the compiler's own helpers included), recursion, indirect calls, fused arithmetic, and who else is linked in.

The stack is followed through every path of every function: a push deepens it, a pop gives it back, a call adds the
callee's own bound at that place. What cannot be followed is reported, never guessed."""
import re
import subprocess


class Instruction:
    __slots__ = ("address", "name", "text", "comment")

    def __init__(self, address, name, text, comment):
        self.address, self.name, self.text, self.comment = address, name, text, comment


class Trouble(Exception):
    pass


def disassemble(path, prefix):
    out = subprocess.run([prefix + "objdump", "-d", "--no-show-raw-insn", path], capture_output=True, text=True,
                         check=True).stdout
    functions, current = {}, None
    for line in out.splitlines():
        head = re.match(r"^([0-9a-f]+) <(.+)>:$", line)
        if head:
            current = functions.setdefault(int(head[1], 16), (head[2], []))[1]
            continue
        body = re.match(r"^\s*([0-9a-f]+):\s+(\S+)\s*(.*)$", line)
        if body and current is not None:
            text, _, comment = body[3].partition("@" if prefix.startswith("arm") else "#")
            current.append(Instruction(int(body[1], 16), body[2], text.strip(), comment.strip()))
    return functions


def target_of(text):
    found = re.search(r"\b([0-9a-f]+) <", text)
    return int(found[1], 16) if found else None


class Step:
    """One instruction as the stack sees it. table: the jump goes to one of the targets that a table holds; may_return,
    may_call: the function may end here, the call may be left out, by a condition."""

    def __init__(self, deeper=0, call=None, jump=None, falls=True, trouble=None, table=None, may_return=False, may_call=False):
        self.deeper, self.call, self.falls, self.trouble, self.table = deeper, call, falls, trouble, table
        self.may_return, self.may_call = may_return, may_call
        self.jumps = [] if jump is None else [jump]


def registers(text):
    count = 0
    for item in text[text.index("{") + 1:text.index("}")].split(","):
        low, dash, high = item.strip().partition("-")
        count += int(re.sub(r"\D", "", high)) - int(re.sub(r"\D", "", low)) + 1 if dash else 1
    return count


ARM_CONDITIONS = "eq|ne|cs|hs|cc|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le|al"


def arm_step(instruction, literals):
    name, text = re.sub(r"\.[wn]$", "", instruction.name), instruction.text
    if name in ("push", "pop", "vpush", "vpop"):
        size = registers(text) * (8 if name.startswith("v") and "d" in text else 4)
        if name.endswith("pop"):
            return Step(-size, falls="pc" not in text)
        return Step(size)
    if name in ("stmdb", "stmfd", "ldmia", "ldmfd", "ldm") and text.startswith("sp!"):
        size = 4 * registers(text)
        return Step(size) if name.startswith("st") else Step(-size, falls="pc" not in text)
    written = re.search(r"\[sp, #(-?\d+)\]!", text) or re.search(r"\[sp\], #(-?\d+)", text)
    if written:
        return Step(-int(written[1]), falls=not (name.startswith("ldr") and text.startswith("pc")))
    moved = re.match(r"sp, (?:sp, )?#(\d+)$", text)
    if moved and name in ("sub", "subw", "add", "addw", "subs", "adds"):
        return Step(int(moved[1]) if name.startswith("sub") else -int(moved[1]))
    by_register = re.match(r"sp, (?:sp, )?(r\d+)$", text)
    if by_register and name in ("add", "sub") and by_register[1] in literals:
        value = literals[by_register[1]]
        return Step(-value if name == "add" else value)
    stores_there = name[:3] in ("stm", "ldm") and text.startswith("sp, {")  # without write-back
    if re.match(r"sp,|sp$", text) and name[:3] not in ("str", "cmp", "tst") and not stores_there:
        return Step(trouble="moves the stack pointer by an unknown amount: " + name + " " + text)
    if name in ("bl", "blx"):
        callee = target_of(text)
        return Step(call=callee) if callee is not None else Step(trouble="calls through a register")
    if name == "mov" and text.startswith("pc, r"):
        return Step(falls=False, table=4)
    if re.match(r"(bx|pop|ldm(ia|fd)?)(%s)$" % ARM_CONDITIONS, name) and re.search(r"\b(lr|pc)\b", text):
        return Step(may_return=True)
    if name == "bx":
        return Step(falls=False) if text in ("lr", "ip") or literals.get(text) == "popped" else \
            Step(falls=False, trouble="jumps through a register")
    if name in ("tbb", "tbh"):
        return Step(falls=False, table=1 if name == "tbb" else 2)
    called = re.match(r"bl(%s)$" % ARM_CONDITIONS, name)
    if called:
        return Step(call=target_of(text), may_call=True)
    if name in ("cbz", "cbnz"):
        return Step(jump=target_of(text))
    if re.match(r"b(%s)?$" % ARM_CONDITIONS, name):
        return Step(jump=target_of(text), falls=name not in ("b", "bal"))
    if name.startswith(".") or name == "udf":  # data after a call that never returns
        return Step(falls=False)
    return Step()


def riscv_step(instruction, literals):
    name, text = instruction.name, instruction.text
    moved = re.match(r"sp,sp,(-?\d+)$", text)
    if name in ("add", "addi") and moved:
        return Step(-int(moved[1]))
    by_register = re.match(r"sp,sp,(\w+)$", text)
    if by_register and name in ("add", "sub") and isinstance(literals.get(by_register[1]), int):
        value = literals[by_register[1]]
        return Step(-value if name == "add" else value)
    if text.startswith("sp,") and name not in ("sw", "fsw", "sb", "sh"):
        return Step(trouble="moves the stack pointer by an unknown amount: " + name + " " + text)
    saved = re.search(r"<__riscv_(save|restore)_(\d+)>", text)  # the compiler's shared prologue and epilogue
    if saved:
        return Step(16 + int(saved[2]) // 4 * 16) if saved[1] == "save" else Step(falls=False)
    if name == "jal":
        return Step(call=target_of(text))
    if name == "jalr":
        callee = target_of(instruction.comment)
        return Step(call=callee) if callee is not None else Step(trouble="calls through a register")
    if name in ("ret", "ebreak", "unimp") or name.startswith("."):
        return Step(falls=False)
    if name == "jr":
        callee = target_of(instruction.comment)
        return Step(jump=callee, falls=False) if callee is not None else Step(falls=False, table=4)
    if name == "j":
        return Step(jump=target_of(text), falls=False)
    if name.startswith("b"):
        return Step(jump=target_of(text))
    return Step()


class Memory:
    """The code section as it is stored, constants included."""

    def __init__(self, path, prefix):
        out = subprocess.run([prefix + "objdump", "-s", "-j", ".text", path], capture_output=True, text=True,
                             check=True).stdout
        rows = re.findall(r"^ ([0-9a-f]+) ((?:[0-9a-f]{2,8} ){1,4})", out, re.M)
        self.start = int(rows[0][0], 16)
        self.data = bytes.fromhex("".join(words for _, words in rows))

    def get(self, address, size):
        at = address - self.start
        return self.data[at:at + size] if 0 <= at <= len(self.data) - size else bytes(size)


class Image:
    """step and follower of every instruction, by address: self.flow[address] = (Step, address after it)."""

    def __init__(self, path, prefix):
        functions = disassemble(path, prefix)
        self.address = {name: at for at, (name, _) in functions.items()}
        self.names = {at: name for at, (name, _) in functions.items()}
        self.bounds, self.open, self.flow, self.text = {}, [], {}, {}
        self.memory = Memory(path, prefix)
        step_of = arm_step if prefix.startswith("arm") else riscv_step
        for entry, (_, body) in functions.items():
            known, last = self.literals(body), body[-1].address if body else entry
            for n, i in enumerate(body):
                step = step_of(i, known[i.address])
                if step.call is not None and entry < step.call <= last:
                    # on v6-M a far jump inside a function is a bl; elsewhere a bl with a condition is a detour, and comes back
                    step.jumps, step.call, step.falls = [step.call], None, step.may_call
                if step.table:
                    step.jumps = self.table(body, n, step.table)
                    if not step.jumps:
                        step.trouble = "jumps through a register"
                self.flow[i.address], self.text[i.address] = [step, None], (entry, i)
        order = sorted(self.flow)
        for at, follower in zip(order, order[1:] + [None]):
            self.flow[at][1] = follower
            if self.flow[at][0].call is not None and follower in functions:
                self.flow[at][0].falls = False  # the callee never returns

    def table(self, body, n, size):
        """Targets of a jump through a table: of halfwords behind the jump (tbb, tbh), or of offsets from the table."""
        if size < 4:
            base, end = body[n].address + 4, n + 1
            while end < len(body) and body[end].name.startswith("."):
                end += 1
            limit = body[end].address if end < len(body) else base
            entries = range(base, min(limit, base + 2 * size * 256), size)
            jumps = {base + 2 * int.from_bytes(self.memory.get(a, size), "little") for a in entries}
        else:
            for base in self.table_bases(body, n):
                jumps = self.offsets(body, base, base) or self.offsets(body, base, 0)
                if jumps:
                    break
            else:
                jumps = set()
        inside = {i.address for i in body if not i.name.startswith(".")}
        return sorted(jumps & inside)

    def table_bases(self, body, n):
        """Addresses that were loaded shortly before a computed jump."""
        before = body[max(0, n - 10):n]
        bases = [int(w[1], 16) for i in before for w in [re.match(r"([0-9a-f]+) <", i.comment)] if w]
        # RISC-V: the upper part alone, where the lower is zero; last, for it may fall into the table of a lower one
        upper = [i.address + (int(w[1], 16) << 12) & 0xFFFFFFFF for i in before if i.name == "auipc"
                 for w in [re.search(r",(0x[0-9a-f]+)", i.text)] if w]
        known = [v for v in self.literals(body)[body[n].address].values() if isinstance(v, int) and v > 0]
        return known + bases[::-1] + upper[::-1]

    def offsets(self, body, base, origin):
        """Targets in the body that words from base on name, counted from origin."""
        targets = set()
        for a in range(base, base + 4 * 256, 4):
            target = (origin + int.from_bytes(self.memory.get(a, 4), "little", signed=True)) & 0xFFFFFFFF
            if not body[0].address <= target <= body[-1].address:
                break
            targets.add(target)
        return targets

    def name(self, address):
        return self.names.get(address, "0x%x" % address)

    def home(self, address):
        return self.names[self.text[address][0]]

    def is_helper(self, address):
        """Is this code of the compiler's runtime library?"""
        return self.home(address).startswith("__")

    @staticmethod
    def literals(body):
        """Registers with a known value after each instruction, in textual order: enough for large frames."""
        words = {i.address: int(i.text, 16) for i in body if i.name == ".word"}
        known, after = {}, {}
        for i in body:
            loaded = re.match(r"(\w+), \[pc", i.text)
            where = re.search(r"\(?\b([0-9a-f]+)\b", i.comment)
            upper = re.match(r"(\w+),(0x[0-9a-f]+)$", i.text)
            added = re.match(r"(\w+),(\w+),(-?\d+)$", i.text)
            if i.name.startswith("ldr") and loaded and where and int(where[1], 16) in words:
                value = words[int(where[1], 16)]
                known[loaded[1]] = value - (1 << 32) if value >> 31 else value
            elif i.name in ("movw", "mov", "mov.w", "movs") and re.match(r"(\w+), #(\d+)$", i.text):
                register, value = i.text.split(", #")
                known[register] = int(value)
            elif i.name in ("lui", "c.lui") and upper:
                value = int(upper[2], 16) << 12
                known[upper[1]] = value - (1 << 32) if value >> 31 & 1 else value
            elif i.name == "addi" and added and added[1] == added[2] and isinstance(known.get(added[1]), int):
                known[added[1]] += int(added[3])
            elif i.name.startswith("pop"):
                for register in re.findall(r"r\d+", i.text):
                    known[register] = "popped"
            after[i.address] = dict(known)
        return after

    def bound(self, address):
        """(bytes, chain of names) of the deepest path from a function's entry. A jump that leaves the function (a tail
        call, the shared tails of the compiler's helpers) is followed as part of it; a call adds the callee's bound."""
        if address in self.bounds:
            return self.bounds[address]
        if address in self.open:
            ring = self.open[self.open.index(address):] + [address]
            raise Trouble("recursion: " + " -> ".join(self.name(a) for a in ring))
        self.open.append(address)
        name = self.name(address)
        deepest, seen, todo = (0, [name]), {}, [(address, 0)]
        while todo:
            at, depth = todo.pop()
            if seen.get(at, -1) >= depth:
                continue
            seen[at] = depth
            if at not in self.flow:
                raise Trouble("%s leads out of the image, to 0x%x" % (name, at))
            step, follower = self.flow[at]
            if step.trouble:
                raise Trouble("%s %s (at 0x%x)" % (self.home(at), step.trouble, at))
            depth += step.deeper
            if depth < 0 or depth > 1 << 16:
                raise Trouble("%s: the stack cannot be followed at 0x%x" % (name, at))
            deepest = max(deepest, (depth, [name]), key=lambda x: x[0])
            if step.call is not None:
                below, chain = self.bound(step.call)
                deepest = max(deepest, (depth + below, [name] + chain), key=lambda x: x[0])
            todo += [(target, depth) for target in step.jumps]
            if step.falls:
                todo.append((follower, depth))
        self.open.pop()
        self.bounds[address] = deepest
        return deepest

    def reachable(self, roots):
        """Addresses of all instructions that the roots can come to."""
        todo, seen = [self.address[r] for r in roots], set()
        while todo:
            at = todo.pop()
            if at in seen or at not in self.flow:
                continue
            seen.add(at)
            step, follower = self.flow[at]
            todo += [t for t in (step.call, follower if step.falls else None, *step.jumps) if t is not None]
        return seen


HEAP = re.compile(r"^_?(malloc|free|calloc|realloc|_malloc_r|_free_r|_sbrk|_sbrk_r|sbrk|_Zn[wa].*|_Zd[la]Pv.*)$")
FUSED = re.compile(r"^(vfma|vfms|vfnma|vfnms|fmadd|fmsub|fnmadd|fnmsub)")
# of the C library: copying and filling memory, and the square root, which IEEE 754 defines to the bit (with its errno, and
# the rounding mode that one of them reads)
C_LIBRARY = re.compile(r"(mem(cpy|move|set|cmp)|sqrt|errno|impure|lib_ver|math_err|fpclassify|fegetround)")


def members(map_path):
    """Library members that the linker drew in: (archive, member)."""
    found, text = set(), open(map_path).read()
    head = text.split("Discarded input sections")[0].split("Memory Configuration")[0]
    for archive, member in re.findall(r"^(\S+\.a)\(([^)]+)\)", head, re.M):
        found.add((archive.rsplit("/", 1)[-1], member))
    return found


def problems(image, map_path, roots):
    """What the rules of the library forbid, found in a linked image."""
    found = []
    for name in image.address:
        if HEAP.match(name):
            found.append("heap: %s is linked in" % name)
    for archive, member in sorted(members(map_path)):
        if archive.startswith(("libm", "libc")) and not C_LIBRARY.search(member):
            found.append("C library: %s(%s) is linked in" % (archive, member))
    for at in sorted(image.reachable(roots)):
        if FUSED.match(image.text[at][1].name) and not image.is_helper(at):  # the compiler's own are exact
            found.append("fused multiply-add: %s in %s" % (image.text[at][1].name, image.home(at)))
            break
    return found


def sizes(path, prefix):
    """(flash, RAM) of an image: what is stored, and what lives in memory, the stack apart."""
    text, data, bss = (int(x) for x in subprocess.run([prefix + "size", path], capture_output=True, text=True,
                                                      check=True).stdout.splitlines()[1].split()[:3])
    return text + data, data + bss
