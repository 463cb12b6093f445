#!/usr/bin/env python3
"""The steps of C2 cubics in integers of any size, and the moves of their charts in single precision, written from
docs/stream.md (Cubics) and docs/cubics.md: walks the courses of the unit tests
WalksAFixedCourseToTheSameBitsEverywhere of Cubic and CubicRotation, and compares the digests."""
import pathlib
import re
import struct
import sys
import zlib
from fractions import Fraction

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "ref"))
import stream_decoder as sp  # single precision, half angles and products of docs/stream.md

LENGTHS = [1, 2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 80, 120]
UNIT = 960**3
JUMP, TO_END, LINE = 17, 16, 19
AXIS_WEIGHTS = (113, 115, 122), (84, 69, 89)
ROTATION_WEIGHTS = (125, 124, 127), (66, 51, 98)


def away(x):
    """Rounds a fraction to nearest, halves away from 0."""
    n = (2 * abs(x) + 1) // 2
    return int(n if x >= 0 else -n)


class Track:
    weights = AXIS_WEIGHTS

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
        rise = 64 * part + self.weights[0][ratio] * travel + self.weights[1][ratio] * bend
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


class Draw:
    """The numbers of the courses."""

    def __init__(self):
        self.x = 1

    def __call__(self, n):
        self.x = (self.x * 6364136223846793005 + 1442695040888963407) % 2**64
        return (self.x >> 33) % n


def course():
    draw = Draw()
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


# ---- rotations

class Axis(Track):
    weights = ROTATION_WEIGHTS


def single(n):
    """An integer of any size in single precision: to nearest, ties to even, rounded once."""
    size = abs(n)
    shift = max(0, size.bit_length() - 24)
    m, rest = size >> shift, size & ((1 << shift) - 1)
    half = 1 << shift >> 1
    if shift and (rest > half or (rest == half and m & 1)):
        m += 1
    return float(m << shift) * (1 if n >= 0 else -1)


def scaled(f, x):
    return [sp.mul(f, c) for c in x]


def plus(x, y):
    return [sp.add(a, b) for a, b in zip(x, y)]


def minus(x, y):
    return [sp.sub(a, b) for a, b in zip(x, y)]


def turn(theta, d):
    n2 = sp.dot(theta, theta)
    if n2 < 1:
        f = sp.poly(n2, -1 / 24, 1 / 360, -1 / 13440, 1 / 907200)
        g = sp.poly(n2, 1 / 6, -1 / 120, 1 / 5040, -1 / 362880, 1 / 39916800)
        e = sp.poly(n2, -1 / 120, 1 / 2520, -1 / 120960, 1 / 9979200)
    else:
        c, s = sp.half_angle(theta)
        sine, cosine = sp.mul(c, s), sp.sub(sp.mul(2.0, c, c), 1.0)
        g = sp.div(sp.sub(1.0, sine), n2)
        f = sp.div(sp.sub(sp.mul(0.5, sine), sp.mul(0.5, s, s)), n2)
        e = sp.div(sp.sub(sp.div(sp.mul(0.5, sp.sub(sine, cosine)), n2), g), n2)
    x, k = sp.cross(theta, d), sp.mul(2.0, sp.dot(theta, d))
    return plus(minus(scaled(g, sp.cross(d, x)), scaled(sp.mul(k, f), x)), scaled(sp.mul(k, e), sp.cross(theta, x)))


def speed(theta, w):
    n2 = sp.dot(theta, theta)
    if n2 < sp.f32(1e-12):
        return w
    c, s = sp.half_angle(theta)
    g = minus(w, scaled(sp.div(sp.dot(theta, w), n2), theta))
    less = sp.sub(1.0, sp.div(c, s))
    return minus(plus(w, scaled(0.5, sp.cross(theta, w))), scaled(less, g))


class Rotation:
    units = {"p": 6 * UNIT, "v": 2 * UNIT, "a": UNIT}

    def __init__(self, anchor, step):
        self.anchor, self.step = anchor, sp.f32(step)
        self.axes = [Axis(0) for _ in range(3)]

    def steps(self, what):
        return scaled(sp.div(1.0, float(self.units[what])), [single(getattr(x, what)) for x in self.axes])

    def set(self, **told):
        found = [{w: int(sp.mul(x[c], float(self.units[w]))) for w, x in told.items()} for c in range(3)]
        trial = Axis(0)
        for f in found:
            trial.__dict__.update(f)
            if not trial.inside():
                return False
        for axis, f in zip(self.axes, found):
            axis.__dict__.update(f)
        return True

    def rebase(self):
        theta, v, a = scaled(self.step, self.steps("p")), self.steps("v"), self.steps("a")
        anchor = sp.normalise(sp.product(self.anchor, sp.exp(theta)))
        bend = plus(sp.body_rate(theta, a), scaled(self.step, turn(theta, v)))
        if self.set(p=[0.0] * 3, v=sp.body_rate(theta, v), a=bend):
            self.anchor = anchor

    def begin_run(self, anchor):
        v, a = self.steps("v"), self.steps("a")
        theta = sp.log(sp.product(sp.conjugate(anchor), self.anchor))
        d = speed(theta, v)
        bend = speed(theta, minus(a, scaled(self.step, turn(theta, d))))
        if self.set(p=scaled(sp.div(1.0, self.step), theta), v=d, a=bend):
            self.anchor = anchor
            for axis in self.axes:
                axis.restart()

    def piece(self, code, h, k):
        old = [dict(axis.__dict__) for axis in self.axes]
        if all(axis.piece(code, h, x) for axis, x in zip(self.axes, k)):
            return
        for axis, was in zip(self.axes, old):
            axis.__dict__ = was
        for axis in self.axes:
            axis.jump(0)


def to_grid(q, step):
    """The nearest rotation of the grid: an encoder's choice, as the library's."""
    m = 0
    for i in range(4):
        if abs(q[i]) > abs(q[m]):
            m = i
    per = sp.div(-1.0 if q[m] < 0 else 1.0, sp.grid_step(step))
    rounded = []
    for i in range(4):
        x = sp.mul(q[i], per)
        if i != m:
            rounded.append(int(sp.sub(x, 0.5) if x < 0 else sp.add(x, 0.5)))
    return m, rounded


def rotation_course():
    draw = Draw()
    step = sp.f32(0.005)
    r = Rotation(sp.from_grid((0, [10, -20, 30]), step), step)
    crc = 0
    for _ in range(4000):
        what, axis = draw(12), r.axes[0]
        if axis.run == 0 and what < 3:
            r.rebase()
            m, n = to_grid(r.anchor, step)
            n = [x + draw(41) - 20 for x in n]
            if what == 0:
                r.begin_run(sp.from_grid((m, n), step))
        length = draw(8)
        k = [draw(5) - 2, draw(5) - 2, draw(5) - 2]
        if axis.run == 0 and axis.code == JUMP:
            r.piece(LINE + length, LENGTHS[length], k)
        elif axis.run in (1, 2):
            r.piece(axis.code, axis.ticks, [3 * x for x in k])
        else:
            r.piece(length, LENGTHS[length], k)
        for x in r.axes:
            for n in (x.p, x.v, x.a):
                crc = zlib.crc32((n % 2**64).to_bytes(8, "little"), crc)
        crc = zlib.crc32(struct.pack("<4f", *r.anchor), crc)
    return crc


def compare(test, found, what):
    text = (ROOT / "tests" / "unit" / test).read_text()
    told = int(re.search(r"digest = (0x[0-9a-f]+)", text)[1], 16)
    if told != found:
        sys.exit(f"{test} says {told:#010x}, docs/cubics.md gives {found:#010x}")
    print(f"ok  {what} of C2 cubics, to the bit")


def main():
    compare("test_cubic.cpp", course(), "20000 pieces")
    compare("test_cubic_rotation.cpp", rotation_course(), "4000 pieces of rotations")


if __name__ == "__main__":
    main()
