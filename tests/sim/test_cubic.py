#!/usr/bin/env python3
"""The steps of C2 cubics in integers of any size, written from docs/cubics.md: walks the course of
the unit test Cubic.WalksAFixedCourseToTheSameBitsEverywhere, and compares the digests."""
import pathlib
import re
import sys
import zlib
from fractions import Fraction

LENGTHS = [1, 2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 80, 120]
UNIT = 960**3
JUMP, TO_END, LINE = 17, 16, 19


def away(x):
    """Rounds a fraction to nearest, halves away from 0."""
    n = (2 * abs(x) + 1) // 2
    return int(n if x >= 0 else -n)


class Track:
    def __init__(self, value):
        self.p, self.v, self.a = 6 * UNIT * value, 0, 0
        self.code, self.ticks, self.run = JUMP, 1, 0
        self.last, self.before, self.sign = 0, 0, 0
        self.c = [0, 0]
        self.j = 0

    def near(self):
        return (self.p + 3 * UNIT) // (6 * UNIT)

    def restart(self):
        self.last = self.before = self.sign = 0
        self.code, self.ticks, self.run = TO_END, 1, 3

    def control(self, h):
        if self.run:
            if self.run == 3:
                return 0
            return self.c[1] if self.run == 2 else self.c[1] + (9 * (self.c[1] - self.c[0]) + 5) // 10
        ratio = 0 if h == self.ticks else 1 if h > self.ticks else 2
        part = (self.p - 6 * UNIT * self.near()) * 1024 // (6 * UNIT)
        travel = h * self.v * 1024 // (2 * UNIT)
        bend = h * h * self.a * 1024 // UNIT
        rise = 64 * part + (113, 115, 122)[ratio] * travel + (84, 69, 89)[ratio] * bend
        return self.near() + (rise + 32768) // 65536

    def end_of_line(self, h):
        return self.near() + (h * self.v * 1024 // (2 * UNIT) + 512) // 1024

    def inside(self):
        return (abs(self.p) <= 6 * UNIT << 30 and abs(self.v) <= 2 * UNIT << 13
                and abs(self.a) <= UNIT << 11)

    def jump(self, k):
        self.__init__((0 if self.run else self.near()) + k)

    def piece(self, code, h, k):
        """@return False, with the state as it was, where a bound is left."""
        old = dict(self.__dict__)
        line = code >= LINE
        aim = (self.end_of_line(h) if line else self.control(h)) + k
        good = abs(aim - self.near()) <= 1 << 17
        if line:
            self.v, self.a = away(Fraction(6 * UNIT * aim - self.p, 3 * h)), 0
            good = good and self.inside()
        rest = 6 * UNIT * aim - self.p - 6 * h * self.v - 11 * h * h * self.a
        self.j = 0 if line else away(Fraction(rest, 6 * h**3))
        self.p += 3 * h * self.v + 3 * h * h * self.a + h**3 * self.j
        self.v += 2 * h * self.a + h * h * self.j
        self.a += h * self.j
        if self.run:
            if self.run == 1:
                one, two = self.c
                self.p = UNIT * (one + 4 * two + aim)
                self.v = UNIT * (aim - one) // h
                self.a = UNIT * (one - 2 * two + aim) // h**2
            self.c = [self.c[1], aim]
            self.run -= 1
        else:
            self.before, self.last = (0, 0) if line else (self.last, max(-100, min(100, k)))
            self.sign = 0 if line else (k > 0) - (k < 0) or self.sign
        self.code, self.ticks = code - LINE if line else code, h
        if good and self.inside():
            return True
        self.__dict__ = old
        return False


def course():
    x = 1

    def draw(n):
        nonlocal x
        x = (x * 6364136223846793005 + 1442695040888963407) % 2**64
        return (x >> 33) % n

    track = Track(100)
    crc = 0
    for _ in range(20000):
        if draw(97) == 0 and track.run == 0:
            track.restart()
        what, length, k = draw(50), draw(10), draw(9) - 4
        loose = track.run == 0 and track.code == JUMP
        if loose or (what == 1 and track.run == 0):
            good = track.piece(LINE + length, LENGTHS[length], k)
        elif track.run == 3:
            good = track.piece(length, LENGTHS[length], track.near() + k)
        elif track.run:
            good = track.piece(track.code, track.ticks, k)
        elif what == 0:
            good = True
            track.jump(100 * k)
        else:
            good = track.piece(length, LENGTHS[length], int(k / 2))
        if not good:
            track.jump(0)
        for n in (track.p, track.v, track.a, track.j):
            crc = zlib.crc32((n % 2**64).to_bytes(8, "little"), crc)
        for n in (track.last, track.before, track.sign):
            crc = zlib.crc32(bytes([n % 256]), crc)
    return crc


def main():
    test = pathlib.Path(__file__).resolve().parents[1] / "unit" / "test_cubic.cpp"
    told = int(re.search(r"digest = (0x[0-9a-f]+)", test.read_text())[1], 16)
    found = course()
    if told != found:
        sys.exit(f"{test.name} says {told:#010x}, integers of any size give {found:#010x}")
    print("ok  20000 pieces of C2 cubics, to the bit")


if __name__ == "__main__":
    main()
