#!/usr/bin/env python3
"""Does the firmware fit? Flash and static RAM from the image, the deepest stack by walking its code: main() and, on top of
it, the interrupt, each with what the core itself saves. Fails above the limits, and where the README tells other figures."""
import argparse
import re
import sys

import budgets
import elf


def readme(path, sentence, accept):
    """What is wrong with the sentence of figures in the README; writes it instead where asked to."""
    text = open(path).read()
    told = re.sub(r"^On a Cortex-M4F it takes .*$", sentence, text, flags=re.M)
    if accept:
        open(path, "w").write(told)
    elif told != text or sentence not in text:
        return ["%s is stale: run make size ACCEPT=1" % path]
    return []


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ram-max", type=int, default=16 * 1024)
    parser.add_argument("--readme", required=True)
    parser.add_argument("--accept", action="store_true", help="write the figures into the README")
    parser.add_argument("image")
    options = parser.parse_args()
    image = elf.Image(options.image, "arm-none-eabi-")
    flash, static = elf.sizes(options.image, "arm-none-eabi-")
    interrupt = "systick_handler"
    saved = 104 + 4  # an interrupt saves 26 words where floats are in use, and aligns
    roots = ["main"] + [n for n in image.address if "_GLOBAL__sub_I" in n]  # constructors run before main()
    start_up = 16  # what reset_handler itself keeps
    stack = start_up + max(image.bound(image.address[r])[0] for r in roots) + saved + image.bound(image.address[interrupt])[0]
    ram = static + stack
    broken = elf.problems(image, options.image + ".map", roots + [interrupt])
    figures = tuple(format(n, ",") for n in (flash, ram, static, stack))
    print("firmware on Cortex-M4F: flash %s bytes, RAM %s bytes (static %s, stack at most %s)" % figures)
    broken += readme(options.readme, "On a Cortex-M4F it takes %s bytes of flash and %s bytes of RAM: %s static, %s of stack "
                     "at most." % figures, options.accept)
    target, budget = budgets.read()["flash_firmware"][:2]
    for name, value, limit in (("flash", flash, budget), ("RAM", ram, options.ram_max)):
        if value > limit:
            broken.append("%s is %d bytes, the limit is %d" % (name, value, limit))
    for b in broken:
        print("FAIL firmware: " + b)
    if broken:
        sys.exit(1)
    print("ok firmware fits in %d bytes of flash (the target is %d) and %d KB RAM, without heap" %
          (budget, target, options.ram_max // 1024))


if __name__ == "__main__":
    main()
