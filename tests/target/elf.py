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
    """One instruction as the stack sees it."""

    def __init__(self, deeper=0, call=None, jump=None, falls=True, trouble=None):
        self.deeper, self.call, self.jump, self.falls, self.trouble = deeper, call, jump, falls, trouble


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
    if re.match(r"(stmdb|stmfd|ldmia|ldmfd|ldm)", name) and text.startswith("sp!"):
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
    if re.match(r"sp,|sp$", text) and name[:3] not in ("str", "cmp", "tst"):
        return Step(trouble="moves the stack pointer by an unknown amount: " + name + " " + text)
    if name in ("bl", "blx"):
        callee = target_of(text)
        return Step(call=callee) if callee is not None else Step(trouble="calls through a register")
    if name == "bx":
        return Step(falls=False) if text in ("lr", "ip") or literals.get(text) == "popped" else \
            Step(falls=False, trouble="jumps through a register")
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
        return Step(jump=callee, falls=False, trouble=None if callee or "t0" in text or "a5" in text else
                    "jumps through a register")
    if name == "j":
        return Step(jump=target_of(text), falls=False)
    if name.startswith("b"):
        return Step(jump=target_of(text))
    return Step()


class Image:
    def __init__(self, path, prefix):
        functions = disassemble(path, prefix)
        self.address = {name: at for at, (name, _) in functions.items()}
        self.names = {at: name for at, (name, _) in functions.items()}
        self.bounds, self.open, self.flow, self.text = {}, [], {}, {}
        step_of = arm_step if prefix.startswith("arm") else riscv_step
        lines = [(entry, i) for entry, (_, body) in sorted(functions.items()) for i in body]
        followers = [i.address for _, i in lines[1:]] + [None]
        for (entry, i), follower in zip(lines, followers):
            known = self.literals(functions[entry][1]) if i.address == entry or not self.flow else known
            step = step_of(i, known[i.address])
            if step.call is not None and step.call != entry and step.call in range(entry, functions[entry][1][-1].address):
                step.jump, step.call, step.falls = step.call, None, False  # on v6-M a far jump inside a function is a bl
            if step.call is not None and follower in functions:
                step.falls = False  # the callee never returns
            self.flow[i.address], self.text[i.address] = (step, follower), (entry, i)

    def name(self, address):
        return self.names.get(address, "0x%x" % address)

    def home(self, address):
        return self.names[self.text[address][0]]

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
            if step.jump is not None:
                todo.append((step.jump, depth))
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
            todo += [t for t in (step.call, step.jump, follower if step.falls else None) if t is not None]
        return seen


HEAP = re.compile(r"^_?(malloc|free|calloc|realloc|_malloc_r|_free_r|_sbrk|_sbrk_r|sbrk|_Zn[wa].*|_Zd[la]Pv.*)$")
FUSED = re.compile(r"^(vfma|vfms|vfnma|vfnms|fmadd|fmsub|fnmadd|fnmsub)")
# of the C library: copying and filling memory, and the square root, which IEEE 754 defines to the bit (with its errno)
C_LIBRARY = re.compile(r"(mem(cpy|move|set|cmp)|sqrt|errno|impure|lib_ver|math_err|fpclassify)")


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
        if FUSED.match(image.text[at][1].name):
            found.append("fused multiply-add: %s in %s" % (image.text[at][1].name, image.home(at)))
            break
    return found


def sizes(path, prefix):
    """(flash, RAM) of an image: what is stored, and what lives in memory, the stack apart."""
    text, data, bss = (int(x) for x in subprocess.run([prefix + "size", path], capture_output=True, text=True,
                                                      check=True).stdout.splitlines()[1].split()[:3])
    return text + data, data + bss
