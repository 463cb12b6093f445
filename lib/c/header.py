#!/usr/bin/env python3
"""Writes fairlead.h for one configuration and one machine.

usage: header.py --nm PROGRAM --config FILE --machine NAME TEMPLATE CONSTANTS.o >fairlead.h
       header.py --say FOLDER...     prints what the folder's library is, and the memory of its objects

CONSTANTS.o is compiled from constants.cpp for that machine; the size of each of its arrays is a constant
plus one."""
import argparse
import re
import subprocess
import sys


def constants(nm, path):
    listing = subprocess.run([nm, "-S", path], check=True, capture_output=True, text=True).stdout
    found = re.findall(r"^\w+ (\w+) \w fairlead_constant_(\w+)$", listing, re.MULTILINE)
    return {name: int(size, 16) - 1 for size, name in found}


def say(folder):
    with open(f"{folder}/fairlead.h", encoding="utf-8") as file:
        text = file.read()
    about = {name: re.search(rf"^ \* +{name} +(\S+)$", text, re.MULTILINE)[1] for name in ("configuration", "machine")}
    print(f"{folder}/fairlead.h and {folder}/libfairlead.a: {about['configuration']}, for {about['machine']}")
    for name in ("pipeline", "decoder", "live", "attitude"):
        size = re.search(rf"define FAIRLEAD_{name.upper()}_BYTES (\d+)", text)[1]
        print(f"  fairlead_{name:<9}{int(size):>7,} bytes of RAM")


def main():
    if sys.argv[1:2] == ["--say"]:
        for folder in sys.argv[2:]:
            say(folder)
        return
    parser = argparse.ArgumentParser()
    for name in ("--nm", "--config", "--machine", "template", "constants"):
        parser.add_argument(name)
    a = parser.parse_args()
    values = constants(a.nm, a.constants)
    number = values["VERSION_NUMBER"]
    values |= {"VERSION": f"{number // 10000}.{number // 100 % 100}.{number % 100}", "CONFIG": a.config, "MACHINE": a.machine}
    with open(a.template, encoding="utf-8") as file:
        text = file.read()
    for name, value in values.items():
        if f"@{name}@" not in text:
            sys.exit(f"header.py: {a.template} does not use the constant {name}")
        text = text.replace(f"@{name}@", str(value))
    left = re.findall(r"@[A-Z_]+@", text)
    if left:
        sys.exit(f"header.py: {a.template} uses unknown constants: {' '.join(left)}")
    sys.stdout.write(text)


main()
