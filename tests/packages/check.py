#!/usr/bin/env python3
"""Uses the library as others will: installed and found by pkg-config and by CMake, as a CMake subdirectory, as an Arduino
library on a bare core; and checks that every manifest can be read and names one version."""
import json
import os
import re
import subprocess
import sys
import tempfile

import yaml

USER = """#include <fairlead/pipeline.hpp>
struct Config : fairlead::PipelineConfig {};
int main() {
    static fairlead::Pipeline<Config> pipeline{{}};
    return pipeline.push({}).empty() ? 0 : 1;
}
"""
CMAKE = """cmake_minimum_required(VERSION 3.16)
project(user CXX)
%s
add_executable(user user.cpp)
target_link_libraries(user fairlead::fairlead)
"""
failed = False


def check(name, fine, detail=""):
    global failed
    failed |= not fine
    print("%s %s%s" % ("ok" if fine else "FAIL", name, "" if fine else "\n" + detail))


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    return done.returncode == 0, done.stdout + done.stderr


def versions():
    found = {"library.json": json.load(open("lib/library.json"))["version"],
             "idf_component.yml": yaml.safe_load(open("lib/idf_component.yml"))["version"]}
    for name, pattern in (("library.properties", r"^version=(.*)$"), ("fairlead.pc", r"^Version: (.*)$"),
                          ("cmake/fairleadConfigVersion.cmake", r"PACKAGE_VERSION ([\d.]+)\)")):
        found[name] = re.search(pattern, open("lib/" + name).read(), re.M)[1]
    return found


def manifests():
    found = versions()
    check("manifests name one version: " + found["library.json"], len(set(found.values())) == 1, str(found))
    keys = {line.split("=")[0] for line in open("lib/library.properties")}
    wanted = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures"}
    check("library.properties has every field", wanted <= keys, str(wanted - keys))
    module = yaml.safe_load(open("lib/zephyr/module.yml"))["build"]
    check("zephyr/module.yml names files that exist",
          all(os.path.exists("lib/" + p) for p in (module["kconfig"], module["cmake"] + "/CMakeLists.txt")))


def with_cmake(folder, name, how, *options):
    os.makedirs(folder)
    open(folder + "/CMakeLists.txt", "w").write(CMAKE % how)
    open(folder + "/user.cpp", "w").write(USER)
    fine, said = run("cmake", "-S", folder, "-B", folder + "/build", *options)
    if fine:
        fine, said = run("cmake", "--build", folder + "/build")
    if fine:
        fine, said = run(folder + "/build/user")
    check(name, fine, said)


def installed(folder):
    fine, said = run("make", "-s", "install", "PREFIX=/usr", "DESTDIR=" + folder + "/root")
    check("make install", fine, said)
    open(folder + "/user.cpp", "w").write(USER)
    where = dict(os.environ, PKG_CONFIG_PATH=folder + "/root/usr/share/pkgconfig", PKG_CONFIG_ALLOW_SYSTEM_CFLAGS="1")
    fine, flags = run("pkg-config", "--cflags", "fairlead", env=where)
    check("pkg-config knows fairlead", fine, flags)
    fine, said = run("g++", "-std=c++17", *flags.split(), folder + "/user.cpp", "-o", folder + "/user")
    check("a program builds by pkg-config and runs", fine and run(folder + "/user")[0], said)
    with_cmake(folder + "/found", "find_package(fairlead 0.1)", "find_package(fairlead 0.1 REQUIRED)",
               "-DCMAKE_PREFIX_PATH=" + folder + "/root/usr")
    run("make", "-s", "uninstall", "PREFIX=/usr", "DESTDIR=" + folder + "/root")
    left = [f for _, _, files in os.walk(folder + "/root") for f in files]
    check("make uninstall leaves nothing", not left, str(left))


def main():
    manifests()
    with tempfile.TemporaryDirectory() as folder:
        installed(folder)
        with_cmake(folder + "/sub", "add_subdirectory", "add_subdirectory(%s/lib fairlead)" % os.getcwd())
        open(folder + "/sketch.cpp", "w").write("#include <fairlead.h>\n" + USER.partition("\n")[2])
        fine, said = run("arm-none-eabi-g++", "-std=gnu++17", "-mcpu=cortex-m4", "-mthumb", "-fno-exceptions", "-fno-rtti",
                         "-ffp-contract=off", "-Ibuild/arduino/fairlead/src", "-c", folder + "/sketch.cpp",
                         "-o", folder + "/sketch.o")
        check("the Arduino folder compiles for a Cortex-M4", fine, said)
    sys.exit(failed)


if __name__ == "__main__":
    main()
