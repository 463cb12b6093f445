#!/usr/bin/env python3
"""Makes the release archives of fairlead, one for each ecosystem, from the headers and the manifests beside this file.

    fairlead-V-cmake.tar.gz       CMake: FetchContent, add_subdirectory, install, find_package, pkg-config
    fairlead-V-arduino.zip        Arduino library
    fairlead-V-platformio.tar.gz  PlatformIO library
    fairlead-V-esp-idf.zip        ESP-IDF component
    fairlead-V-zephyr.tar.gz      Zephyr module
    fairlead-V.hpp                the whole library in one header
    SHA256SUMS

V is FAIRLEAD_VERSION of fairlead/version.hpp. The same tree gives the same bytes: files are sorted, without owners, and all
have the time SOURCE_DATE_EPOCH (by default 1980-01-01).

usage: dist.py [--url URL] FOLDER      --url: the project's page, for the manifests that name one"""
import argparse
import glob
import gzip
import hashlib
import io
import json
import os
import re
import tarfile
import time
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
INCLUDE = os.path.join(ROOT, "lib/include")
SKETCHES = os.path.join(ROOT, "examples/arduino")
EPOCH = int(os.environ.get("SOURCE_DATE_EPOCH", 315532800))  # zip knows no earlier time

# Arduino and PlatformIO users cannot always set flags: ask the compiler in the sketch itself
NO_CONTRACTION = """
// The same bits on every machine need a product and a sum to be rounded one after the other. GCC and
// Clang fuse them by default where the processor can; from here to the end of the file they do not.
#if defined(__clang__)
#pragma clang fp contract(off)
#else
#pragma GCC optimize("fp-contract=off", "no-math-errno")
#endif
"""


def read(path):
    with open(os.path.join(ROOT, path), "rb") as file:
        return file.read()


def headers():
    found = glob.glob(INCLUDE + "/fairlead/**/*.hpp", recursive=True)
    return sorted(os.path.relpath(h, INCLUDE).replace(os.sep, "/") for h in found)


def version():
    text = read("lib/include/fairlead/version.hpp").decode()
    return ".".join(re.search(r"define FAIRLEAD_VERSION_%s (\d+)" % part, text)[1] for part in ("MAJOR", "MINOR", "PATCH"))


def filled(name, **values):
    """A manifest of this folder with its @NAMES@ replaced."""
    text = read("lib/packages/" + name).decode()
    for key, value in dict(values, PROJECT_VERSION=version()).items():
        text = text.replace("@%s@" % key, value)
    left = re.findall(r"@[A-Z_]+@", text)
    if left:
        raise SystemExit("dist: %s: nobody fills %s" % (name, " ".join(left)))
    return text.encode()


def umbrella():
    includes = "".join('#include "%s"\n' % h for h in headers())
    return filled("fairlead.h.in", FLAGS=NO_CONTRACTION, INCLUDES=includes)


def single_header():
    """All headers in one file, each once, in the order in which they include one another."""
    done, standard = set(), set()

    def inline(header):
        if header in done:
            return ""
        done.add(header)
        out = "// ---- %s\n" % header
        for line in read("lib/include/" + header).decode().splitlines(keepends=True):
            ours = re.match(r'\s*#\s*include\s+[<"](fairlead/[^">]+)[">]', line)
            theirs = re.match(r"\s*#\s*include\s+(<[^>]+>)", line)
            if ours:
                out += inline(ours[1])
            elif theirs:
                out += "" if theirs[1] in standard else line
                standard.add(theirs[1])
            elif line.strip() != "#pragma once":
                out += line
        return out

    body = inline("fairlead/base/compiler.hpp") + "".join(inline(h) for h in headers())
    licence = "".join(("// " + line).rstrip() + "\n" for line in read("LICENSE").decode().splitlines())
    return licence.encode() + filled("fairlead.h.in", FLAGS="", INCLUDES=body)


def sketches():
    return sorted(os.listdir(SKETCHES))


def common(folder=""):
    """What every archive holds: licence, changes, headers at `folder`."""
    files = {folder + "/" + h if folder else h: read("lib/include/" + h) for h in headers()}
    files.update({"LICENSE": read("LICENSE"), "CHANGELOG.md": read("CHANGELOG.md"), "README.md": read("lib/packages/README.md")})
    return files


def examples():
    return {"examples/%s/%s.ino" % (s, s): read("examples/arduino/%s/%s.ino" % (s, s)) for s in sketches()}


def layouts(url):
    """End of the archive's name -> (top folder, {path: bytes})."""
    listed = [{"name": s, "base": "examples/" + s, "files": [s + ".ino"]} for s in sketches()]
    cmake_files = {"CMakeLists.txt": read("lib/CMakeLists.txt"), "packages/fairlead.pc.in": read("lib/packages/fairlead.pc.in")}
    zephyr = {"zephyr/" + n: read("lib/zephyr/" + n) for n in ("module.yml", "CMakeLists.txt", "Kconfig")}
    return {
        "-cmake.tar.gz": ("fairlead-" + version(), {**common("include"), **cmake_files}),
        "-arduino.zip": ("fairlead", {**common("src"), **examples(), "src/fairlead.h": umbrella(),
                                     "library.properties": filled("library.properties.in", URL=url)}),
        "-platformio.tar.gz": ("", {**common("include"), **examples(), "include/fairlead.h": umbrella(),
                                   "library.json": filled("library.json.in", EXAMPLES=json.dumps(listed))}),
        "-esp-idf.zip": ("fairlead", {**common("include"), "CMakeLists.txt": read("lib/CMakeLists.txt"),
                                     "idf_component.yml": filled("idf_component.yml.in")}),
        "-zephyr.tar.gz": ("fairlead", {**common("include"), **zephyr}),
    }


def tar_gz(files):
    raw = io.BytesIO()
    with tarfile.open(fileobj=raw, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for path in sorted(files):
            entry = tarfile.TarInfo(path)
            entry.size, entry.mtime, entry.mode = len(files[path]), EPOCH, 0o644
            tar.addfile(entry, io.BytesIO(files[path]))
    packed = io.BytesIO()
    with gzip.GzipFile(fileobj=packed, mode="wb", mtime=0, filename="", compresslevel=9) as file:
        file.write(raw.getvalue())
    return packed.getvalue()


def zipped(files):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for path in sorted(files):
            entry = zipfile.ZipInfo(path, time.gmtime(EPOCH)[:6])
            entry.external_attr, entry.compress_type, entry.create_system = 0o644 << 16, zipfile.ZIP_DEFLATED, 3
            archive.writestr(entry, files[path], compresslevel=9)
    return packed.getvalue()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--url", default="", help="the project's page")
    parser.add_argument("folder")
    options = parser.parse_args()
    os.makedirs(options.folder, exist_ok=True)
    for old in glob.glob(glob.escape(options.folder) + "/fairlead-*"):
        os.remove(old)
    made = {"fairlead-%s.hpp" % version(): single_header()}
    for name, (top, files) in layouts(options.url).items():
        placed = {(top + "/" if top else "") + path: content for path, content in files.items()}
        made["fairlead-%s%s" % (version(), name)] = zipped(placed) if name.endswith("zip") else tar_gz(placed)
    sums = "".join("%s  %s\n" % (hashlib.sha256(made[n]).hexdigest(), n) for n in sorted(made))
    for name, content in [*made.items(), ("SHA256SUMS", sums.encode())]:
        with open(os.path.join(options.folder, name), "wb") as file:
            file.write(content)
        print("%9d  %s" % (len(content), os.path.join(options.folder, name)))


if __name__ == "__main__":
    main()
