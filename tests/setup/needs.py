"""What a target of the Makefile needs, found without looking at what it asks for.

A dry run of the target tells its commands. From these follow the sources that it compiles, with all headers
that they include, and the scripts that it runs, with all modules that they import. Each package of
.ci/packages has a mark here: a pattern that shows in commands, sources or scripts when it is needed."""
import functools
import os
import pathlib
import re
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def word(*names):
    """A program's name, as a whole word of a command line or a quoted word of a script."""
    return r"(?<![\w./+-])(?:" + "|".join(map(re.escape, names)) + r")(?![\w+/-])"


def header(*names):
    return r"#include <(?:" + "|".join(map(re.escape, names)) + ")"


ARM, RISCV = word("arm-none-eabi-g++"), word("riscv64-unknown-elf-g++")
MARKS = {
    # languages and tools
    "g++": word("g++", "clang-tidy"), "gcc": word("gcc", "cc"), "clang": word("clang++"), "libclang-rt-14-dev": "-fsanitize=",
    "python3": r"\.py\b|/usr/bin/python3", "python3-yaml": r"import yaml",
    "python3-clang-14": r"import clang\.cindex", "libclang-common-14-dev": r"import clang\.cindex", "llvm": r'"llvm-cov"',
    "doxygen": word("doxygen"), "clang-format": word("clang-format"), "clang-tidy": word("clang-tidy"),
    "cmake": r'\bcmake -|"cmake", ', "pkgconf": word("pkg-config"),
    "gnuplot-nox": r'fairlead-sim (?:replay|compare|experiment)|"make".*"demo"|\["gnuplot"\]',
    "g++-11": word("g++-11"), "g++-12": word("g++-12"), "g++-12-multilib": r"-m32\b", "clang-14": word("clang++-14"),
    "clang-16": word("clang++-16"), "clang-19": word("clang++-19"), "gcc-xtensa-lx106": r"xtensa-lx106-elf-g\+\+",
    "python3-kconfiglib": r"import kconfiglib",
    "debootstrap": word("debootstrap"), "util-linux": word("unshare"),
    # libraries
    "libcli11-dev": header("CLI/"),
    "zlib1g-dev": header("zlib.h") + r"|-lz\b",
    "libeigen3-dev": header("Eigen/"),
    "libgtest-dev": header("gtest/") + r"|-lgtest\b",
    "libbenchmark-dev": header("benchmark/") + r"|-lbenchmark\b",
    "libsisl-dev": header("sisl.h") + r"|-lsisl\b",
    "libgpiod-dev": header("gpiod.h") + r"|-lgpiod\b",
    "libmodbus-dev": header("modbus/") + r"|-lmodbus\b",
    "libsystemd-dev": header("systemd/") + r"|-lsystemd\b",
    "libtomlplusplus-dev": header("toml++/"),
    "libcpp-httplib-dev": header("httplib.h"),
    # pages: libraries that are embedded in them, and a browser to test them
    "libjs-dygraphs": r"/usr/share/[\w/]*dygraph", "libjs-three": r"/usr/share/[\w/]*three",
    "chromium": r'"chromium"', "chromium-driver": r'"chromedriver"', "python3-selenium": r"from selenium",
    # the Debian package of the programs
    "dpkg-dev": r"\bdpkg-shlibdeps\b", "lintian": word("lintian"),
    # Modbus clients
    "mbpoll": word("mbpoll"), "python3-pymodbus": r"from pymodbus", "python3-serial-asyncio": r"from pymodbus",
    "nodejs": r'\["node", ',
    # microcontrollers; the RISC-V build borrows the headers of the Arm one
    "gcc-arm-none-eabi": ARM, "libnewlib-arm-none-eabi": ARM, "libstdc++-arm-none-eabi-newlib": ARM + "|" + RISCV,
    "gcc-riscv64-unknown-elf": RISCV, "picolibc-riscv64-unknown-elf": RISCV, "qemu-system-misc": RISCV,
    "qemu-system-arm": r"qemu-system-arm", "glpk-utils": word("glpsol"),
    # the emulated Linux machine
    "qemu-system-x86": r"qemu-system-x86_64", "busybox-static": r"/bin/busybox", "cpio": word("cpio"),
    "kmod": word("depmod"), "xz-utils": word("xz"), "libelf1": r"linux-kbuild",
    "python3-smbus2": r"\bimport .*\bsmbus2\b|from smbus2",
}
# packages that come with another one
COMES_WITH = {"gcc": ["g++"], "python3": ["python3-yaml", "python3-smbus2"]}
# marks that show although the target does without the package
UNNEEDED = {
    "test": {"clang"},  # test_same_bytes compares with clang++ where it is installed
    "compilers": {"g++", "gcc", "qemu-system-misc"},  # it takes compilers by their versions, and runs nothing on RISC-V
    "attitude-counts": {"glpk-utils"},  # it imports the module with the stack bound and does not use it
}


def dry_run(*arguments):
    """The commands of a call of make when nothing is built yet."""
    env = {k: v for k, v in os.environ.items() if not k.startswith("MAKE") and k not in ("MFLAGS", "BUILD", "CXX", "V")}
    done = subprocess.run(["make", "-n", "SETUP=no", "BUILD=/nowhere", *arguments], cwd=ROOT, env=env, text=True,
                          capture_output=True, timeout=120, check=False)
    assert done.returncode == 0, f"make -n {' '.join(arguments)}: {done.stderr[-500:]}"
    return done.stdout


@functools.cache
def text_of(path):
    return path.read_text(encoding="utf-8", errors="replace")


@functools.cache
def system_headers(path):
    """The lines '#include <...>' of a source file and of all project headers that it includes, and the paths of the
    system's files that they embed."""
    found, seen, open_files = set(), set(), [path]
    while open_files:
        file = open_files.pop()
        if file in seen or not file.is_file():
            continue
        seen.add(file)
        found |= set(re.findall(r"^#include <[^>]+>", text_of(file), re.MULTILINE))
        found |= set(re.findall(r'"/usr/share/[^"]+"', text_of(file)))
        for name in re.findall(r'^#include [<"]([^>"]+)[>"]', text_of(file), re.MULTILINE):
            open_files += [folder / name for folder in (file.parent, ROOT, ROOT / "lib/include")]
    return frozenset(found)


@functools.cache
def script_text(path):
    """A script without its comments and long strings, with the scripts of the project that it names or imports."""
    text = re.sub(r'"""[^"]*"""', "", text_of(path))
    text = re.sub(r"^\s*#.*$", "", text, flags=re.MULTILINE)
    for name in re.findall(r"^(?:from|import) (\w+)", text, re.MULTILINE):
        for folder in (path.parent, ROOT / "tests/sim"):
            if (folder / f"{name}.py").is_file() and folder / f"{name}.py" != path:
                text += script_text(folder / f"{name}.py")
    for name in set(re.findall(r"[\w/]+(?:\.py)?\b", text)):  # files beside it: linux_vm/stub.py, compilers/cells
        file = path.parent / name.lstrip("/")
        if file != path and (file.suffix == ".py" or f'"{name}"' in text or f"/{name}" in text) and file.is_file():
            text += script_text(file)
    if "tests/target/target.mk" in text:
        text += everything_in(dry_run("-f", "tests/target/target.mk", *re.findall(r'"(CORES=[^"]*)"', text)))
    return text


@functools.cache
def everything_in(commands):
    """The commands, the system headers of the sources and the text of the scripts that they name; nothing twice."""
    parts, files = {}, {}
    for line in commands.splitlines():
        compiles = "-std=" in line
        parts.update(dict.fromkeys(line.split() if compiles else [line]))
        for name in re.findall(r"(?<![\w/])(?:[.\w-]+/)+[\w.-]+", line):
            files[name] = files.get(name, False) or compiles
    for name, compiled in files.items():
        file = ROOT / name
        if not file.is_file():
            continue
        if file.suffix in (".cpp", ".hpp", ".c"):
            parts.update(dict.fromkeys(sorted(system_headers(file)) if compiled else []))
        elif text_of(file).startswith("#!") and file.name != "step" and file.parent != HERE:
            parts[script_text(file)] = None
    return "\n".join(parts)


def needed(target):
    """The packages that a documented target needs, by its commands."""
    text = everything_in(dry_run(target))
    return {package for package, mark in MARKS.items() if re.search(mark, text)} - UNNEEDED.get(target, set())
