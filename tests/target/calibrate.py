#!/usr/bin/env python3
"""Checks that the counting plugin counts exactly, on code whose instructions are known."""
import sys

from measure import Core, read_words

build, failed = sys.argv[1], False
for name in sys.argv[2:]:
    out = "%s/%s/calibrate" % (build, name)
    Core(name).run(out + ".elf", build, [], out + ".counts")
    seen = list(read_words(out + ".counts"))
    failed |= seen != [0, 1, 7, 501] * 3
    print("%s counts are exact on %s: %s" % ("ok" if seen == [0, 1, 7, 501] * 3 else "FAIL", name, seen[:4]))
sys.exit(failed)
