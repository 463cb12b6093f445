#!/usr/bin/env python3
"""Makes the release archives, unpacks each into an empty folder, and uses it as its ecosystem does: builds programs with the
single header, with FetchContent, find_package, add_subdirectory and pkg-config, and runs them; compiles the Arduino sketches
against a stand-in for the boards' cores and runs them; reads the other manifests. All programs must produce the same frames.

usage: check.py [PART...]      parts: archives cmake single arduino platformio esp_idf zephyr release"""
import glob
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile

import kconfiglib
import yaml

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
USER = HERE + "/user.cpp"
WARN = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
CMAKE = """cmake_minimum_required(VERSION 3.16)
project(user CXX)
%s
add_executable(user %s)
target_link_libraries(user fairlead::fairlead)
"""
# Arduino boards: compiler, its flags as the core has them, the sketch
ARM_FLAGS = "-Os -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffunction-sections -w -mthumb"
BOARDS = [
    ("UNO R4", "arm-none-eabi-g++", "-std=gnu++17 -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16 -fsigned-char " + ARM_FLAGS,
     "UnoR4Attitude"),
    ("Raspberry Pi Pico", "arm-none-eabi-g++", "-std=gnu++17 -mcpu=cortex-m0plus " + ARM_FLAGS, "PicoFrames"),
    ("ESP32 (by the LX106 compiler)", "xtensa-lx106-elf-g++", "-std=gnu++2b -Os -w -mlongcalls -fno-exceptions -fno-rtti XTENSA",
     "Esp32Frames"),
]


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=options.pop("text", True), **options)
    return done.returncode == 0, done.stdout + (done.stderr if isinstance(done.stdout, str) else b"")


class Check:
    def __init__(self, folder):
        self.folder, self.failed, self.digests = folder, False, {}
        self.dist, self.version = folder + "/dist", version()

    def line(self, name, fine, said=""):
        self.failed |= not fine
        print("%-4s %s%s" % ("ok" if fine else "FAIL", name, "" if fine else "\n" + str(said)[-1500:]), flush=True)
        return fine

    def archive(self, ending):
        return "%s/fairlead-%s%s" % (self.dist, self.version, ending)

    def unpack(self, ending):
        to = self.folder + "/unpacked-" + ending.split(".")[0].strip("-")
        shutil.rmtree(to, ignore_errors=True)
        name = self.archive(ending)
        with (zipfile.ZipFile(name) if name.endswith("zip") else tarfile.open(name)) as packed:
            packed.extractall(to)
        return to

    def user(self, name, program):
        """A built user.cpp: runs, exact arithmetic, and the same frames as all others."""
        fine, said = run(program)
        digest = re.search(r"digest (\w+) arithmetic exact", said)
        fine = fine and digest is not None
        if fine:
            self.digests[name] = digest[1]
        return self.line(name, fine and len(set(self.digests.values())) == 1, said + str(self.digests))

    def with_cmake(self, name, how, *options, source=USER):
        folder = self.folder + "/" + re.sub(r"\W", "_", name)
        os.makedirs(folder)
        with open(folder + "/CMakeLists.txt", "w") as file:
            file.write(CMAKE % (how, source))
        for command in (["cmake", "-S", folder, "-B", folder + "/build", *options], ["cmake", "--build", folder + "/build"]):
            fine, said = run(*command)
            if not fine:
                return self.line(name, False, said)
        return self.user(name, folder + "/build/user")


def version():
    text = open(ROOT + "/lib/include/fairlead/version.hpp").read()
    return ".".join(re.search(r"define FAIRLEAD_VERSION_%s (\d+)" % p, text)[1] for p in ("MAJOR", "MINOR", "PATCH"))


def archives(check):
    """Twice the same bytes, each header in each archive, no version anywhere but in one place."""
    for folder in ("/dist", "/again"):
        fine, said = run(ROOT + "/lib/packages/dist.py", check.folder + folder)
        check.line("dist.py", fine, said)
    made = {n: open(check.dist + "/" + n, "rb").read() for n in os.listdir(check.dist)}
    same = all(open(check.folder + "/again/" + n, "rb").read() == made[n] for n in made)
    check.line("%d files, the same bytes twice" % len(made), same and len(made) == 7, sorted(made))
    sums = dict(line.split()[::-1] for line in made["SHA256SUMS"].decode().splitlines())
    check.line("SHA256SUMS tells the truth", sums == {n: hashlib.sha256(b).hexdigest() for n, b in made.items() if n != "SHA256SUMS"})
    headers = {os.path.relpath(h, ROOT + "/lib/include") for h in glob.glob(ROOT + "/lib/include/**/*.hpp", recursive=True)}
    for ending in ("-cmake.tar.gz", "-arduino.zip", "-platformio.tar.gz", "-esp-idf.zip", "-zephyr.tar.gz"):
        to = check.unpack(ending)
        found = {h.partition("/fairlead/")[2] for h in glob.glob(to + "/**/fairlead/**/*.hpp", recursive=True)}
        lacking = [h for h in headers if not any(f.endswith(h.partition("/")[2]) for f in found)]
        licence = glob.glob(to + "/**/LICENSE", recursive=True)
        check.line("%s: %d headers and the licence" % (ending.strip("-"), len(headers)), not lacking and licence, lacking)
    tracked = run("git", "-C", ROOT, "grep", "-nwF", check.version, "--", "lib", "host_sim", "port", "examples", "Makefile")[1]
    check.line("no other file of the tree holds %s" % check.version,
               not [l for l in tracked.splitlines() if "version.hpp" not in l], tracked)


def cmake(check):
    archive = check.archive("-cmake.tar.gz")
    fetch = "include(FetchContent)\nFetchContent_Declare(fairlead URL file://%s)\nFetchContent_MakeAvailable(fairlead)"
    check.with_cmake("FetchContent of the archive", fetch % archive)
    check.with_cmake("add_subdirectory of the tree", "add_subdirectory(%s/lib fairlead)" % ROOT)
    root = glob.glob(check.unpack("-cmake.tar.gz") + "/*")[0]
    prefix, build = check.folder + "/usr", check.folder + "/install"
    fine, said = run("cmake", "-S", root, "-B", build, "-DCMAKE_INSTALL_PREFIX=" + prefix)
    fine = fine and run("cmake", "--install", build)[0]
    check.line("cmake --install of the archive", fine, said)
    moved = check.folder + "/elsewhere"  # a package must not know the folder that it was installed to
    os.rename(prefix, moved)
    short = ".".join(check.version.split(".")[:2])
    check.with_cmake("find_package(fairlead %s)" % short, "find_package(fairlead %s REQUIRED)" % short,
                     "-DCMAKE_PREFIX_PATH=" + moved)
    refused = check.folder + "/refused"
    os.makedirs(refused)
    with open(refused + "/CMakeLists.txt", "w") as file:
        file.write(CMAKE % ("find_package(fairlead 99 REQUIRED)", USER))
    fine, said = run("cmake", "-S", refused, "-B", refused + "/build", "-DCMAKE_PREFIX_PATH=" + moved)
    check.line("find_package(fairlead 99) is refused", not fine and "99" in said, said)
    pkg_config(check, moved, "pkg-config")
    fine, said = run("make", "-C", ROOT, "-s", "install", "PREFIX=/usr", "DESTDIR=" + check.folder + "/root", "BUILD=" + check.folder + "/b")
    check.line("make install", fine, said)
    pkg_config(check, check.folder + "/root/usr", "pkg-config after make install")
    run("make", "-C", ROOT, "-s", "uninstall", "PREFIX=/usr", "DESTDIR=" + check.folder + "/root")
    left = [f for _, _, files in os.walk(check.folder + "/root") for f in files]
    check.line("make uninstall leaves nothing", not left, left)


def pkg_config(check, prefix, name):
    where = dict(os.environ, PKG_CONFIG_PATH=prefix + "/share/pkgconfig", PKG_CONFIG_ALLOW_SYSTEM_CFLAGS="1")
    known, flags = run("pkg-config", "--cflags", "fairlead = " + check.version, env=where)
    fine, said = run("g++", "-std=c++17", "-O1", *WARN, *flags.split(), USER, "-o", check.folder + "/user")
    if check.line(name + " builds a program", known and fine, flags + said):
        check.user(name + ": the program runs", check.folder + "/user")


def single(check):
    header = check.archive(".hpp")
    for compiler, standard in (("g++", "c++17"), ("clang++", "c++20")):
        program = check.folder + "/single"
        command = [compiler, "-std=" + standard, "-O1", "-ffp-contract=off", *WARN, '-DUSER_HEADER="%s"' % header, USER]
        fine, said = run(*command, "-o", program)
        if check.line("single header, " + compiler, fine, said):
            check.user("single header, %s: the program runs" % compiler, program)
    fine, said = run("g++", "-std=c++17", "-ffast-math", "-fsyntax-only", "-x", "c++", header)
    first = next((l for l in said.splitlines() if "error" in l), "")
    check.line("single header refuses fast-math", not fine and "fairlead: -ffast-math" in first, said)
    page = open(ROOT + "/lib/packages/README.md").read()
    code = re.search(r"^```cpp\n#include [^\n]*\n(.*?)^// for each[^\n]*\n(.*?)^```", page, re.M | re.S)
    with open(check.folder + "/page.cpp", "w") as file:
        file.write("void send(const std::uint8_t*, std::size_t);\n%svoid each(const fairlead::Pose& pose) {\n%s}\n" % (code[1], code[2]))
    fine, said = run("g++", "-std=c++17", *WARN, "-fsyntax-only", "-include", header, check.folder + "/page.cpp")
    check.line("the example of the archives' README compiles", fine, said)
    two = "#define USER_HEADER \"%s\"\n#include USER_HEADER\n#include USER_HEADER\n" % header
    pair = [check.folder + n for n in ("/one.cpp", "/two.cpp")]
    for path, more in zip(pair, ("int main() {}\n", "int other() { return 0; }\n")):
        with open(path, "w") as file:
            file.write(two + more)
    fine, said = run("g++", "-std=c++17", *pair, "-o", check.folder + "/pair")
    check.line("single header twice in a file, and in two files of a program", fine, said)


def sketch_source(check, root, name):
    """The .ino as the Arduino tools compile it."""
    with open("%s/examples/%s/%s.ino" % (root, name, name)) as file:
        text = file.read()
    path = check.folder + "/%s.cpp" % name
    with open(path, "w") as file:
        file.write("#include <Arduino.h>\n#line 1 \"%s.ino\"\n" % name + text)
    return path


def arduino(check):
    root = check.unpack("-arduino.zip") + "/fairlead"
    properties = dict(line.strip().split("=", 1) for line in open(root + "/library.properties"))
    wanted = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures", "includes"}
    categories = {"Sensors", "Signal Input/Output", "Data Processing", "Communication", "Other"}
    check.line("library.properties: every field, one version, no AVR",
               wanted <= set(properties) and properties["version"] == check.version and properties["category"] in categories
               and not {"avr", "*"} & set(properties["architectures"].split(",")), properties)
    check.line("library.properties: the umbrella header is there", os.path.exists(root + "/src/" + properties["includes"]))
    newlib = sorted(glob.glob("/usr/include/newlib/c++/*"))[-1]
    xtensa = ["-nostdinc++", "-isystem", newlib, "-isystem", newlib + "/arm-none-eabi", "-isystem", "/usr/include/newlib"]
    libraries = ["-I" + root + "/src", "-I" + HERE + "/arduino"]
    sketches = sorted(os.listdir(root + "/examples"))
    check.line("a sketch for each of three boards", sketches == sorted(b[3] for b in BOARDS), sketches)
    for board, compiler, flags, name in BOARDS:
        flags = [f for flag in flags.split() for f in (xtensa if flag == "XTENSA" else [flag])]
        made = check.folder + "/sketch.o"
        source = sketch_source(check, root, name)
        for style in ([], ["-DAVR_STYLE"]):
            fine, said = run(compiler, *flags, *style, *libraries, "-c", source, "-o", made)
            check.line("%s compiles for %s%s" % (name, board, " behind AVR-style macros" if style else ""), fine, said)
        if compiler.startswith("arm"):
            code = run(compiler.replace("g++", "objdump"), "-d", made)[1]
            fused = re.findall(r"\tvfn?m[as]\S*", code)
            check.line("%s: no fused multiply-add without a flag" % name, len(code) > 10000 and not fused, fused[:3])
    run_sketches(check, root, libraries)


def run_sketches(check, root, libraries):
    reader = check.folder + "/frames"
    fine, said = run("g++", "-std=c++17", "-O1", '-DUSER_HEADER="%s"' % check.archive(".hpp"), HERE + "/frames.cpp", "-o", reader)
    check.line("a reader of frames, by the single header", fine, said)
    for name in sorted(os.listdir(root + "/examples")):
        program = check.folder + "/" + name
        fine, said = run("g++", "-std=gnu++17", "-O1", "-w", *libraries, sketch_source(check, root, name), HERE + "/arduino/board.cpp",
                         "-o", program)
        if not check.line("%s builds with the stand-in board" % name, fine, said):
            continue
        out = subprocess.run([program], capture_output=True, timeout=120).stdout
        if name.endswith("Frames"):
            done = subprocess.run([reader], input=out, capture_output=True)
            said = done.stdout.decode()
            events = int(re.search(r"events (\d+)|$", said)[1] or 0)
            check.line("%s runs: %s" % (name, said.strip()), done.returncode == 0 and events == (2 if "Pico" in name else 0), said)
        else:
            rows = [line.split() for line in out.decode().splitlines()]
            last = [float(v) for v in rows[-1][:3]] if rows else [0, 0, 0]
            turned = (last[2] - float(rows[35][2])) % 360 if len(rows) > 36 else 0
            check.line("%s runs: %d lines, the last says %s" % (name, len(rows), rows[-1] if rows else ""),
                       len(rows) > 100 and abs(last[0] - 20) < 1 and abs(last[1]) < 1 and abs(turned - 240) < 3, rows[-3:])


def platformio(check):
    root = check.unpack("-platformio.tar.gz")
    library = json.load(open(root + "/library.json"))
    fine = (library["version"] == check.version and 0 < len(library["name"]) <= 50 and 0 < len(library["description"]) <= 255
            and isinstance(library["keywords"], (list, str)) and library["license"] == "MIT" and "atmelavr" not in library["platforms"])
    check.line("library.json: fields, lengths, one version", fine, library)
    files = [os.path.join(root, e["base"], f) for e in library["examples"] for f in e["files"]]
    folder = os.path.join(root, library["build"]["includeDir"])
    check.line("library.json: all that it names exists",
               len(files) == 3 and all(map(os.path.exists, files + [os.path.join(folder, h) for h in library["headers"]])), files)
    fine, said = run("g++", *library["build"]["flags"], "-I" + folder, '-DUSER_HEADER="fairlead.h"', USER, "-o", check.folder + "/pio")
    if check.line("library.json: its flags and folder build a program", fine, said):
        check.user("PlatformIO layout: the program runs", check.folder + "/pio")


def esp_idf(check):
    root = check.unpack("-esp-idf.zip") + "/fairlead"
    component = yaml.safe_load(open(root + "/idf_component.yml"))
    check.line("idf_component.yml: version, description, licence, targets",
               component["version"] == check.version and component["description"] and component["license"] == "MIT"
               and all(re.fullmatch(r"esp32\w*", t) for t in component["targets"]) and "idf" in component["dependencies"], component)
    stand_in = ("set(ESP_PLATFORM 1)\nfunction(idf_component_register)\n"
                "cmake_parse_arguments(A \"\" \"\" \"SRCS;INCLUDE_DIRS;REQUIRES\" ${ARGN})\n"
                "add_library(component INTERFACE)\nadd_library(fairlead::fairlead ALIAS component)\n"
                "target_include_directories(component INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/${A_INCLUDE_DIRS})\n"
                "set(COMPONENT_LIB component PARENT_SCOPE)\nendfunction()\nset(CMAKE_CXX_STANDARD 23)\n")
    check.with_cmake("ESP-IDF component, by a stand-in for idf_component_register", stand_in + "add_subdirectory(%s fairlead)" % root)


def zephyr(check):
    root = check.unpack("-zephyr.tar.gz") + "/fairlead"
    module = yaml.safe_load(open(root + "/zephyr/module.yml"))
    build = module["build"]
    check.line("zephyr/module.yml names files that exist",
               all(os.path.exists(root + "/" + p) for p in (build["kconfig"], build["cmake"] + "/CMakeLists.txt")), module)
    with open(check.folder + "/Kconfig", "w") as file:
        file.write("config CPP\n\tbool \"C++\"\nsource \"%s/%s\"\n" % (root, build["kconfig"]))
    config = kconfiglib.Kconfig(check.folder + "/Kconfig", warn_to_stderr=False)
    symbol = config.syms["FAIRLEAD"]
    symbol.set_value("y")
    without = symbol.str_value
    config.syms["CPP"].set_value("y")
    check.line("zephyr/Kconfig: off without C++, on with it", (without, symbol.str_value) == ("n", "y") and not config.warnings,
               config.warnings)
    stand_in = ("set(CONFIG_FAIRLEAD y)\nadd_library(zephyr_interface INTERFACE)\nadd_library(fairlead::fairlead ALIAS zephyr_interface)\n"
                "function(zephyr_include_directories)\ntarget_include_directories(zephyr_interface INTERFACE ${ARGN})\nendfunction()\n"
                "function(zephyr_compile_options)\ntarget_compile_options(zephyr_interface INTERFACE ${ARGN})\nendfunction()\n"
                "set(CMAKE_CXX_STANDARD 17)\n")
    check.with_cmake("Zephyr module, by a stand-in for its functions", stand_in + "add_subdirectory(%s/%s z)" % (root, build["cmake"]))


def release(check):
    """release.py says yes to a clone that is ready, and names each thing that is not."""
    tree, version_file = check.folder + "/clone", "lib/include/fairlead/version.hpp"
    files = run("git", "-C", ROOT, "ls-files", "-co", "--exclude-standard")[1].splitlines()
    for name in files:
        if os.path.isfile(os.path.join(ROOT, name)):
            os.makedirs(os.path.dirname(os.path.join(tree, name)), exist_ok=True)
            shutil.copy2(os.path.join(ROOT, name), os.path.join(tree, name))
    who = ["-c", "user.name=fairlead", "-c", "user.email=fairlead@localhost"]

    def change(name, how):
        with open(os.path.join(tree, name)) as file:
            before = file.read()
        with open(os.path.join(tree, name), "w") as file:
            file.write(how(before))

    def commit():
        run("git", "-C", tree, "add", "-A")
        run("git", "-C", tree, *who, "commit", "-qm", "change")

    def expect(name, word, *options):
        fine, said = run(sys.executable, tree + "/tests/packages/release.py", *(options or ("--url", "https://localhost/fairlead")))
        complaints = [l for l in said.splitlines() if l.startswith("FAIL")]
        right = fine and "ready. When" in said if not word else not fine and len(complaints) == 1 and word in complaints[0]
        check.line("release-check: " + name, right, said)

    run("git", "init", "-q", tree)
    change("CHANGELOG.md", lambda t: re.sub(r"^## Unreleased\n", "## Unreleased\n\n## %s (2030-01-01)\n" % check.version, t, flags=re.M))
    commit()
    expect("a commit that is ready", "")
    expect("no page named", "page", "--url", "")
    change("README.md", lambda t: t + "more\n")
    expect("a change that is not committed", "uncommitted")
    run("git", "-C", tree, "checkout", "-q", "README.md")
    run("git", "-C", tree, "tag", "v" + check.version)
    expect("a tag that exists", "is free")
    change(version_file, lambda t: t.replace("MINOR %s\n" % check.version.split(".")[1], "MINOR 99\n"))
    commit()
    expect("a version without its section", "CHANGELOG")
    change("CHANGELOG.md", lambda t: t.replace("## %s (" % check.version, "## %s (" % re.sub(r"\.\d+\.", ".99.", check.version)))
    commit()
    expect("the next version", "")
    run("git", "-C", tree, "tag", "v99.0.0")
    expect("a later tag", "later")
    run("git", "-C", tree, "tag", "-d", "v99.0.0")
    change("CHANGELOG.md", lambda t: t.replace("## Unreleased\n", "## Unreleased\n- something new\n"))
    commit()
    expect("entries left in Unreleased", "Unreleased")


PARTS = {f.__name__: f for f in (archives, cmake, single, arduino, platformio, esp_idf, zephyr, release)}


def main():
    wanted = sys.argv[1:] or list(PARTS)
    if any(p not in PARTS for p in wanted):
        sys.exit("usage: check.py [%s]..." % "|".join(PARTS))
    os.environ.update({k: "" for k in ("MAKEFLAGS", "MFLAGS")})
    with tempfile.TemporaryDirectory() as folder:
        check = Check(folder)
        for part in dict.fromkeys(["archives", *wanted]):
            PARTS[part](check)
    print("packages: %s" % ("FAILED" if check.failed else "all fine"))
    sys.exit(check.failed)


if __name__ == "__main__":
    main()
