#!/usr/bin/env python3
"""A second decoder of the stream, written from docs/stream.md alone.

stream_decoder.py FILE prints one line for each run, piece and event. It shares nothing with the library but the
page and its tables; tests/golden and tests/sim hold the two to the same numbers.
"""
import functools
import json
import pathlib
import struct
import sys
import zlib

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs"
VERSION = 5
UNWRAPS, UNWRAPS_NEAR = 64, 4  # times that a reader that joins tries; those that need no further check
LENGTHS = [1, 2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 80, 120]
TO_END, JUMP, REBASE, LINE = 16, 17, 18, 19
CUBICS = 3
U = 960 ** 3
POWERS = [32768, 31379, 30049, 28775, 27555, 26386, 25268, 24196, 23171, 22188, 21248, 20347, 19484, 18658, 17867, 17109]


class Nonsense(Exception):
    """The bytes are none that an encoder writes."""


def frequency(cost):
    return -(-POWERS[cost % 16] >> cost // 16)


def load_tables():
    tables = {}
    for t in json.loads((PAGE / "stream_tables.json").read_text()):
        rows = {name: [[frequency(c) for c in row] for row in t[name]] for name in t if name not in ("kind", "components")}
        tables[t["kind"], t["components"]] = rows
    return tables


# ---- checks

def crc16_of(byte):
    crc = byte << 8
    for _ in range(8):
        crc = (crc << 1 ^ 0x1021) & 0xffff if crc & 0x8000 else crc << 1
    return crc


CRC16 = [crc16_of(byte) for byte in range(256)]
CRC16_BACK = {crc & 0xff: byte for byte, crc in enumerate(CRC16)}


def crc16(data, crc):
    for byte in data:
        crc = (crc << 8 & 0xffff) ^ CRC16[crc >> 8 ^ byte]
    return crc


@functools.lru_cache(maxsize=4096)
def start_value(frame):
    """The start value that makes the check of the frame right: found backwards."""
    crc = frame[-2] << 8 | frame[-1]
    for byte in reversed(frame[:-2]):
        i = CRC16_BACK[crc & 0xff]
        crc = (crc ^ CRC16[i]) >> 8 | (i ^ byte) << 8
    return crc


def check_fits(frame, link):
    return crc16(struct.pack("<IqI", *link[:3]), 0xffff) == start_value(frame)


def frame_size(data, at):
    """Size of the frame that would begin at `at`; 0: none does. None: not known yet."""
    first = data[at]
    if 1 <= first <= 247:
        return first + 3
    if first in (0xf8, 0xf9):
        if at + 1 == len(data):
            return None
        return data[at + 1] + 6 if 0 < data[at + 1] <= 244 else 0
    return 0


# ---- range coder

class RangeDecoder:
    def __init__(self, data):
        self.data, self.at, self.range = data, 4, 0xffffffff
        self.code = int.from_bytes((data + bytes(4))[:4], "big")

    def byte(self, i):
        return self.data[i] if i < len(self.data) else 0

    def peek(self, bits):
        return min(self.code // (self.range >> bits), (1 << bits) - 1)

    def take(self, cum, freq, bits):
        unit = self.range >> bits
        self.code = (self.code - unit * cum) & 0xffffffff
        self.range = unit * freq
        while self.range < 1 << 24:
            self.code = (self.code << 8 | self.byte(self.at)) & 0xffffffff
            self.at += 1
            self.range <<= 8

    def finished(self):
        window = [self.byte(i) for i in range(self.at - 4, self.at)]
        low = (int.from_bytes(bytes(window), "big") - self.code) & 0xffffffff
        steps = [-low & m for m in (0xffffffff, 0xffffff, 0xffff, 0xff)]
        shortest = next((s for s in steps if s < self.range), 0)
        while window and window[-1] == 0:
            window.pop()
        return self.code == shortest and len(self.data) == max(1, self.at - 4 + len(window))

    def symbol(self, row):
        place, cum = self.peek(15), 0
        for s, freq in enumerate(row):
            if place < cum + freq:
                self.take(cum, freq, 15)
                return s
            cum += freq
        raise Nonsense("symbol")

    def raw(self, n):
        v = 0
        while n > 0:
            part = min(n, 12)
            n -= part
            some = self.peek(part)
            self.take(some, 1, part)
            v = v << part | some
        return v

    def flag(self, ones, bits):
        zeros = (1 << bits) - ones
        v = self.peek(bits) >= zeros
        self.take(zeros if v else 0, ones if v else zeros, bits)
        return v

    def half(self):
        return self.flag(1, 1)

    def golomb(self, k):
        m = 0
        while self.half():
            m += 1
            if m + k > 32:
                raise Nonsense("golomb")
        v = (1 << m + k) + self.raw(m + k) - (1 << k)
        if v >> 32:
            raise Nonsense("golomb")
        return v

    def values(self, n):
        width, out = 0, []
        if self.half():
            width = self.raw(4) + 1
            if width == 16:
                width += self.raw(4)
        for _ in range(n):
            size = self.raw(width)
            out.append(-size if size and self.half() else size)
        return out

    def places(self, origin):
        v = [a + b for a, b in zip(origin, self.values(len(origin)))]
        if max(map(abs, v)) > 1 << 30:
            raise Nonsense("places")
        return v

    def uniform(self, n):
        highs = n if n <= 4096 else -(-n // 256)
        width = 32768 // highs
        v = self.peek(15) // width
        if v >= highs:
            raise Nonsense("uniform")
        self.take(v * width, width, 15)
        if n > 4096:
            v = v << 8 | self.raw(8)
        if v >= n:
            raise Nonsense("uniform")
        return v

    def grid(self, step, origin):
        most = grid_size(step)
        if not self.half():
            n = [a + b for a, b in zip(origin[1], self.values(3))]
            if max(map(abs, n)) > most:
                raise Nonsense("grid")
            return origin[0], n
        return self.raw(2), [self.uniform(2 * most + 1) - most for _ in range(3)]

    def sized(self, bits, most):
        width = self.raw(bits)
        if width > most:
            raise Nonsense("sized")
        if width == 0:
            return 0
        if width - 1 > 32:
            high = self.raw(width - 33)
            return 1 << width - 1 | high << 32 | self.raw(32)
        return 1 << width - 1 | self.raw(width - 1)


# ---- single precision

def f32(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def mul(*factors):
    x = factors[0]
    for f in factors[1:]:
        x = f32(x * f)
    return x


def add(*terms):
    x = terms[0]
    for t in terms[1:]:
        x = f32(x + t)
    return x


def sub(a, *b):
    for t in b:
        a = f32(a - t)
    return a


def div(a, b):
    return f32(a / b)


def sqrt(x):
    return f32(x ** 0.5)


def poly(z, *coefficients):
    c = [f32(x) for x in coefficients]
    x = c[-1]
    for k in reversed(c[:-1]):
        x = add(mul(x, z), k)
    return x


def dot(a, b):
    return add(*(mul(x, y) for x, y in zip(a, b)))


def cross(a, b):
    return [sub(mul(a[i], b[j]), mul(a[j], b[i])) for i, j in ((1, 2), (2, 0), (0, 1))]


def normalise(q):
    n = dot(q, q)
    if not n > 0:
        return [1.0, 0.0, 0.0, 0.0]
    f = div(1.0, sqrt(n))
    return [mul(c, f) for c in q]


def product(a, b):
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return [sub(mul(aw, bw), mul(ax, bx), mul(ay, by), mul(az, bz)),
            sub(add(mul(aw, bx), mul(ax, bw), mul(ay, bz)), mul(az, by)),
            add(sub(mul(aw, by), mul(ax, bz)), mul(ay, bw), mul(az, bx)),
            add(sub(add(mul(aw, bz), mul(ax, by)), mul(ay, bx)), mul(az, bw))]


def conjugate(q):
    return [q[0]] + [-c for c in q[1:]]


def half_angle(theta):
    """cos(a) and sin(a) / a, a half the angle."""
    x, halved = mul(0.25, dot(theta, theta)), 0
    while halved < 32 and x > 1.25:
        x, halved = mul(x, 0.25), halved + 1
    c = poly(x, 1.0, -0.49999994, 0.0416662544, -0.00138796587, 2.39535511e-5)
    s = poly(x, 1.0, -0.166666657, 0.00833329558, -0.000198328533, 2.6784553e-6)
    for _ in range(halved):
        c, s = sub(mul(2.0, c, c), 1.0), mul(c, s)
    return c, s


def exp(theta):
    c, s = half_angle(theta)
    return [c] + [mul(mul(0.5, s), x) for x in theta]


def log(q):
    d = div(-1.0 if q[0] < 0 else 1.0, add(1.0, abs(q[0])))
    t = [mul(d, c) for c in q[1:]]
    p = poly(dot(t, t), 0.999999881, -0.333318114, 0.199669614, -0.140032902, 0.0986886546, -0.0588297546, 0.0237805191,
             -0.00455979211)
    return [mul(mul(4.0, p), c) for c in t]


def body_rate(theta, d):
    n2 = dot(theta, theta)
    if n2 < f32(1e-12):
        return d
    c, s = half_angle(theta)
    along = div(dot(theta, d), n2)
    turn, less = mul(0.5, s, s), sub(1.0, mul(c, s))
    return [sub(d[i], mul(turn, w), mul(less, sub(d[i], mul(along, theta[i])))) for i, w in enumerate(cross(theta, d))]


def nearest_slope(x):
    x = sub(x, 0.5) if x < 0 else add(x, 0.5)
    return int(max(-float(1 << 23), min(float(1 << 23), x)))


def grid_step(step):
    return mul(step, 0.25)


def grid_size(step):
    return int(div(f32(0.70710678), grid_step(step))) + 1


def from_grid(grid, step):
    m, n = grid
    g, rest, q, left = grid_step(step), 1.0, [0.0] * 4, list(n)
    for i in range(4):
        if i != m:
            q[i] = mul(f32(left.pop(0)), g)
            rest = sub(rest, mul(q[i], q[i]))
    q[m] = sqrt(rest) if rest > 0 else 0.0
    return normalise(q)


# ---- curves

def rounded(n, d):
    size = (abs(n) + d // 2) // d
    return -size if n < 0 else size


class Track:
    """State of a curve of n components; a rotation has an anchor."""

    def __init__(self, n):
        self.n, self.v, self.s = n, [0] * n, [0] * n
        self.anchor = [1.0, 0.0, 0.0, 0.0]
        self.forget(True)

    def forget(self, fresh):
        self.last_k, self.sign = [0] * self.n, [0] * self.n
        self.last_code, self.last_ticks, self.phase, self.fresh = TO_END, 1, 0, fresh

    def loose(self):
        return self.last_code == JUMP and not self.fresh

    def step(self, code, subs, k):
        jump, line, h = code == JUMP, code >= LINE, subs // 64
        rise, s = [], []
        for c in range(self.n):
            ahead = 0 if jump or self.fresh else (self.s[c] * h + 480) // 960
            r = k[c] + ahead
            if abs(r) > (1 << 30 if jump else 32767) or abs(self.v[c] + r) > 1 << 30:
                raise Nonsense("rise")
            rise.append(r)
            s.append(0 if jump else rounded(960 * r, h) if self.fresh or line else rounded(1920 * r, h) - self.s[c])
            if abs(s[c]) > 1 << 23:
                raise Nonsense("slope")
        self.v = [a + b for a, b in zip(self.v, rise)]
        self.s = s
        self.remember(code, subs, k)
        return rise

    def remember(self, code, subs, k):
        jump = code == JUMP
        for c in range(self.n):
            self.last_k[c] = 0 if jump or self.fresh else max(-100, min(100, k[c]))
            if not jump and k[c]:
                self.sign[c] = 1 if k[c] > 0 else -1
        self.last_code = code - LINE if code >= LINE else code
        self.last_ticks = 1 if jump else subs // 64
        self.fresh = False
        self.phase = (self.phase + subs) % 64

    def rebase(self, step):
        theta = [mul(f32(v), step) for v in self.v]
        rate = body_rate(theta, [f32(s) for s in self.s])
        self.anchor = normalise(product(self.anchor, exp(theta)))
        self.v, self.s = [0] * 3, [nearest_slope(x) for x in rate]

    def land(self, code, subs, target, step):
        """Ends at a rotation that was told. Returns the rises of the piece there."""
        inverse = div(1.0, step)
        end = [mul(c, inverse) for c in log(product(conjugate(self.anchor), target))]
        rise = [sub(e, f32(v)) for e, v in zip(end, self.v)]
        if code != JUMP:
            chord, h = self.fresh or code >= LINE, f32(subs // 64)
            for c in range(3):
                t = div(mul(960.0, rise[c]), h)
                self.s[c] = nearest_slope(t if chord else sub(mul(2.0, t), f32(self.s[c])))
            self.remember(code, subs, [0] * 3)
            self.phase = 0
        rate = body_rate([mul(e, step) for e in end], [f32(s) for s in self.s])
        self.anchor, self.v, self.s = target, [0] * 3, [nearest_slope(x) for x in rate]
        return rise


class Cubic:
    """State of an axis of cubics. p, v, a in 1 / (6 U), 1 / (2 U), 1 / U."""
    n = 1

    def __init__(self, value=None):
        self.p, self.v, self.a = 6 * U * (value or 0), 0, 0
        self.c1 = self.c2 = self.last_k = self.before_k = self.sign = 0
        self.last_code, self.last_ticks, self.phase, self.run = JUMP, 1, 0, 0
        self.known = value is not None  # a reader that joins knows no value
        if not self.known:
            self.restart()

    def restart(self):
        self.last_k = self.before_k = self.sign = 0
        self.last_code, self.last_ticks, self.phase, self.run = TO_END, 1, 0, 3

    def loose(self):
        return self.last_code == JUMP and self.run == 0

    def near(self):
        return (self.p + 3 * U) // (6 * U)

    def bend(self, h):
        return 1024 * h * h * self.a // U

    def ratio(self, h):
        return 0 if h == self.last_ticks else 1 if h > self.last_ticks else 2

    def control(self, h):
        if self.run == 3:
            return 0
        if self.run == 2:
            return self.c1
        if self.run == 1:
            return self.c2 + (9 * (self.c2 - self.c1) + 5) // 10
        wt, wb = ((113, 84), (115, 69), (122, 89))[self.ratio(h)]
        part, travel = 1024 * (self.p - 6 * U * self.near()) // (6 * U), 1024 * h * self.v // (2 * U)
        return self.near() + (64 * part + wt * travel + wb * self.bend(h) + 32768) // 65536

    def step(self, code, subs, k):
        """Returns p, v, a, j of the piece; None of a jump, and where they are not known."""
        if code == JUMP:
            aim = (0 if self.run else self.near()) + k
            if abs(aim) > 1 << 30:
                raise Nonsense("jump")
            self.p, self.v, self.a = 6 * U * aim, 0, 0
            self.last_k = self.before_k = self.sign = self.run = 0
            self.last_code, self.last_ticks, self.known = JUMP, 1, True
            self.phase = (self.phase + subs) % 64
            return None
        h, line, run = subs // 64, code >= LINE, self.run
        if self.loose() and not line:
            raise Nonsense("piece")
        if run and (line or code == TO_END or run < 3 and h != self.last_ticks):
            raise Nonsense("run")
        aim = k + (self.near() + (1024 * h * self.v // (2 * U) + 512) // 1024 if line else self.control(h))
        if abs(aim) > 1 << 30 or abs(k) > (1 << 30 if run == 3 else 1 << 20):
            raise Nonsense("aim")
        drawn = None
        if self.known:
            if abs(aim - self.near()) > 1 << 17:
                raise Nonsense("aim")
            p, v, a, j = self.p, self.v, self.a, 0
            if line:
                v, a = rounded(6 * U * aim - p, 3 * h), 0
            else:
                j = rounded(6 * U * aim - p - 6 * h * v - 11 * h * h * a, 6 * h ** 3)
            drawn = p, v, a, j
            self.p, self.v, self.a = p + 3 * h * v + 3 * h * h * a + h ** 3 * j, v + 2 * h * a + h * h * j, a + h * j
            if abs(v) > U << 14 or abs(a) > U << 11:
                raise Nonsense("bounds")
        if run == 1:
            self.p, self.v, self.a = (U * (self.c1 + 4 * self.c2 + aim), U * (aim - self.c1) // h,
                                      U * (self.c1 - 2 * self.c2 + aim) // h ** 2)
            self.known = True
        if abs(self.p) > 6 * U << 30 or abs(self.v) > U << 14 or abs(self.a) > U << 11:
            raise Nonsense("bounds")
        if run == 3:
            self.c1 = aim
        elif run == 2:
            self.c2 = aim
        elif run == 0:
            self.before_k, self.last_k = (0, 0) if line else (self.last_k, max(-100, min(100, k)))
            self.sign = 0 if line else (1 if k > 0 else -1) if k else self.sign
        self.run = max(0, run - 1)
        self.last_code, self.last_ticks = code - LINE if line else code, h
        return drawn


# ---- the stream

class Channel:
    def __init__(self, rotates, kind, axes, tolerance, steps, origin):
        self.rotates, self.kind, self.axes, self.tolerance = rotates, kind, axes, tolerance
        self.step = [f32(m * 2.0 ** e) for m, e in steps]
        self.origin = (origin[0] & 3, [origin[0] >> 2] + origin[1:]) if rotates else origin
        self.cubic = kind == CUBICS
        self.tracks = [Track(3)] if rotates else [Cubic(0) if self.cubic else Track(1) for _ in range(axes)]
        self.live, self.hidden, self.grid = False, False, None


def unfolded(z):
    return -(z + 1) // 2 if z & 1 else z // 2


class Header:
    def __init__(self, payload):
        if payload[0] != VERSION:
            raise Nonsense(f"the stream has version {payload[0]} of the format; this reader knows version {VERSION}")
        self.at, self.data = 1, payload
        self.stream_id, self.run = self.varying(), self.varying()
        self.base_ns = self.zigzag()
        self.sub_ns = self.varying()
        form = self.number(1)
        self.time_bits, self.independent = (form & 31) + 1, form > 127
        self.usual, self.restart_frames = self.number(1), self.number(1)
        self.channels = [self.channel() for _ in range((form >> 5 & 3) + 1)]
        self.digest = zlib.crc32(payload[:self.at])
        place = self.varying()
        self.starts, self.end = bool(place & 1), unfolded(place >> 1)

    def number(self, n):
        self.at += n
        return int.from_bytes(self.data[self.at - n:self.at], "little")

    def varying(self):
        v = shift = 0
        while True:
            byte = self.number(1)
            v |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return v

    def zigzag(self):
        return unfolded(self.varying())

    def channel(self):
        form = self.number(1)
        tolerance = (36409 if form > 127 else 27307) + self.zigzag()
        count = (form & 7) + 1
        steps = []
        for _ in range(count if form & 8 else 1):
            m, e = 256 + self.number(1), self.number(1)
            steps.append((m, e - 256 if e > 127 else e))
        if len(steps) == 1:
            steps *= count
        origin = [self.zigzag() for _ in range(count)]
        return Channel(form > 127, form >> 4 & 7, count, tolerance / 32768, steps, origin)


class Decoder:
    """Reads a stream from its header on; `told` is called with each line."""

    def __init__(self, told):
        self.told, self.tables = told, load_tables()
        self.header, self.events, self.runs = None, None, 0
        self.lost = 0

    # -- frames

    def read(self, data):
        at = 0
        while at < len(data):
            size = frame_size(data, at)
            if not size or at + size > len(data) or not self.frame(data[at:at + size]):
                at = self.resume(data, at)
            else:
                at += size

    def frame(self, frame):
        """In step: one frame. Returns whether it was believed."""
        if frame[0] >= 0xf8:
            return self.long_frame(frame)
        if self.header is None or self.link is None or not check_fits(frame, self.link):
            return False
        self.data_frame(frame, "in step")
        return True

    def long_frame(self, frame):
        seed = 0 if frame[0] == 0xf8 else self.header.digest if self.header else None
        if seed is None or zlib.crc32(frame[:-4], seed) != int.from_bytes(frame[-4:], "little"):
            return False
        if frame[0] == 0xf9:
            self.event_frame(frame[2:-4])
            return True
        header = Header(frame[2:-4])
        if header.starts or self.header is None or header.digest != self.header.digest:
            self.header = header
            self.runs += 1
            self.link = (header.digest, header.end, 0, 0) if header.starts else None
            self.near = header.end
            self.told(f"run {header.run} stream {header.stream_id} base {header.base_ns} sub {header.sub_ns}")
        return True

    def resume(self, data, at):
        """Out of step: the next place from which two checks in a row fit. Returns it."""
        self.lost += 1
        for p in range(at, len(data) - 3):
            size = frame_size(data, p)
            if not size or p + size > len(data):
                continue
            frame = data[p:p + size]
            if frame[0] == 0xf8 and zlib.crc32(frame[:-4]) == int.from_bytes(frame[-4:], "little"):
                return p
            if frame[0] == 0xf9:
                self.long_frame(frame)
            if frame[0] >= 0xf8 or self.header is None:
                continue
            if self.link and check_fits(frame, self.link) and self.follows(data, p + size, frame, self.link):
                return p
            first = self.joinable(data, p, frame)
            if first is not None:
                self.join(frame, first)
                return p + size
        return len(data)

    def next_link(self, frame, end, restart, before):
        since = 0 if restart else before[3] + 1
        return (self.header.digest, end, zlib.crc32(frame, self.header.digest if restart else before[2]), since)

    def follows(self, data, at, frame, link, count=1, first=False):
        """Do the checks of `count` frames behind this one fit? first: it follows a restart frame."""
        try:
            _, end, restart = self.head(RangeDecoder(frame[1:-2]), link)
        except Nonsense:
            return False
        if first and restart and not self.header.independent:
            return False
        return self.chain(data, at, self.next_link(frame, end, restart, link), count)

    def chain(self, data, at, link, count, first=False):
        if at >= len(data):
            return False
        size = frame_size(data, at)
        if not size or at + size > len(data):
            return False
        frame = data[at:at + size]
        if frame[0] >= 0xf8:
            return self.chain(data, at + size, link, count, first)
        if not check_fits(frame, link):
            return False
        return count == 1 or self.follows(data, at + size, frame, link, count - 1, first)

    def joinable(self, data, p, frame):
        """The time that a restart frame tells, where its followers agree."""
        try:
            start, end, _ = self.head(RangeDecoder(frame[1:-2]), (0, self.near, 0, 0), True)
        except Nonsense:
            return None
        for i in range(UNWRAPS):
            checks = 2 if i < UNWRAPS_NEAR else 3
            if self.chain(data, p + len(frame), self.next_link(frame, end, True, None), checks, True):
                return start if self.header.independent else end
            start, end = (x + (64 << self.header.time_bits) for x in (start, end))
        return None

    def join(self, frame, time):
        if self.header.independent:
            self.data_frame(frame, "lone", time)
        else:
            self.data_frame(frame, "joining", time)

    # -- head

    def time(self, io, start):
        sub_ticks = io.raw(6) if io.flag(1, 4) else 0
        bits = self.header.time_bits
        low = io.raw(bits)
        from_tick = -((sub_ticks - start) // 64)
        return (from_tick + ((low - from_tick) & (1 << bits) - 1)) * 64 + sub_ticks

    def ticks(self, io):
        usual = self.header.usual
        if io.flag(7, 3):
            return usual
        v = io.golomb(2)
        n = usual + (v + 1) // 2 if v & 1 else usual - v // 2
        if v == 0 or not 0 <= n <= 255:
            raise Nonsense("ticks")
        return n

    def head(self, io, link, joining=False):
        _, before, _, since = link
        restart = self.header.independent
        if not restart:
            due = 0 < self.header.restart_frames <= since + 1
            restart = io.flag(1, 4) != due or joining
        jump = 0
        if io.flag(1, 5):
            high = io.golomb(0)
            jump = high << 16 | io.raw(16)
            if high >> 28 or jump == 0:
                raise Nonsense("jump")
        start = before + jump
        length = 64 * self.ticks(io)
        if restart:
            known = start if self.header.independent else start + length
            told = self.time(io, before if joining else known)
            if not joining and told != known:
                raise Nonsense("time")
            start = told if self.header.independent else told - length
        return start, start + length, restart

    # -- content

    def data_frame(self, frame, reading, before=None):
        io = RangeDecoder(frame[1:-2])
        joining = reading != "in step"
        start, end, restart = self.head(io, (0, before, 0, 0) if joining else self.link, joining)
        channels, ticks = self.header.channels, (end - start) // 64
        independent = self.header.independent
        tells, restart = restart, restart and not independent
        if joining:
            for c in channels:
                c.tracks = [Cubic() if c.cubic else Track(t.n) for t in c.tracks]
                c.live = False
        for c in channels:
            self.ends(io, c, restart, independent, reading)
        if reading == "joining":
            for c in channels:
                c.live = c.hidden = c.goes_on
                for i, t in enumerate(c.tracks if c.live and not c.cubic else []):
                    t.anchor = from_grid(c.told, c.step[0]) if c.rotates else t.anchor
                    t.v = [0] * 3 if c.rotates else [c.told[i]]
        else:
            for c in channels:
                self.times(io, c, ticks, start, end)
            lines = []
            for number, c in enumerate(channels):
                for i, t in enumerate(c.tracks if c.over else []):
                    zero = [0] * t.n
                    lines.append(self.line(number, i, start, start, JUMP, 0, zero, zero, zero, c, [1.0, 0.0, 0.0, 0.0]))
            for number, c in enumerate(channels):  # curves of a single vertex
                for i, t in enumerate(c.tracks if c.present and c.first == c.last and not c.goes_on else []):
                    at = start + 64 * c.first
                    if c.cubic:
                        lines.append(self.line(number, i, at, at, JUMP, 0, [t.near()], [0], [0], c, None))
                        continue
                    lines.append(self.line(number, i, at, at, JUMP, t.fresh, t.v, t.s, [0] * t.n, c, t.anchor))
            for number, c in enumerate(channels):
                for i, t in enumerate(c.tracks if c.present else []):
                    if c.cubic:
                        self.cubics(io, lines, number, c, i, t, start)
                    else:
                        self.pieces(io, lines, number, c, i, t, start, restart, independent)
            if not io.finished():
                raise Nonsense("the payload is not what an encoder writes")
            for line in lines:
                self.told(line)
            for c in channels:
                self.close(c, restart, independent)
        self.link = self.next_link(frame, end, tells, self.link)
        self.near = end

    def ends(self, io, c, restart, independent, reading):
        if independent:
            live = io.flag(15, 4)
            if reading == "in step" and live and not c.live:
                raise Nonsense("live")
            c.over = reading == "in step" and c.live and not live
            c.live = live
            if live:
                self.start_told(io, c, reading)
        usual = restart or c.live
        c.goes_on = usual if io.flag(15, 4) else not usual
        c.told = None
        if c.goes_on and (restart or independent and c.rotates) and not c.cubic:
            c.told = io.grid(c.step[0], c.origin) if c.rotates else io.places(c.origin)

    def start_told(self, io, c, reading):
        if c.rotates:
            grid, slopes = io.grid(c.step[0], c.origin), io.values(3)
            states = [([0] * 3, slopes, from_grid(grid, c.step[0]))]
        else:
            v, s = io.places(c.origin), io.values(c.axes)
            states = [([a], [b], c.tracks[0].anchor) for a, b in zip(v, s)]
        for t, state in zip(c.tracks, states):
            if reading == "in step" and (t.v, t.s, t.anchor) != state:
                raise Nonsense("start")
            t.v, t.s, t.anchor = state
            if reading != "in step":
                t.forget(False)

    def times(self, io, c, ticks, start, end):
        c.over = c.over if self.header.independent else c.live and io.flag(1, 5)
        c.live = c.live and not c.over
        c.present = c.live or c.goes_on or io.flag(1, 4)
        if not c.present:
            return
        c.starts = not c.live
        c.first = 0 if c.live else io.uniform(ticks + 1)
        c.last = ticks if c.goes_on else c.first + io.uniform(ticks + 1 - c.first)
        if c.starts and c.rotates:
            c.tracks = [Track(3)]
            c.tracks[0].anchor = from_grid(io.grid(c.step[0], c.origin), c.step[0])
        elif c.starts:
            c.tracks = [Cubic(0) if c.cubic else Track(1) for _ in range(c.axes)]
            for i, (t, v) in enumerate(zip(c.tracks, io.places(c.origin))):
                if c.cubic:
                    c.tracks[i] = Cubic(v)
                else:
                    t.v = [v]
        elif c.cubic and c.last > c.first and c.tracks[0].run == 3:
            c.first_controls = io.places(c.origin)

    def pieces(self, io, lines, number, c, axis, t, start, restart, independent):
        left = 64 * (c.last - c.first)
        told = c.told is not None
        if left == 0 and told:
            if (t.anchor, t.v) != (from_grid(c.told, c.step[0]), [0] * 3) if c.rotates else t.v != [c.told[axis]]:
                raise Nonsense("end")
        rebased = False
        while left > 0:
            code, subs, k, ends = self.piece(io, c, t, left, told)
            if code == REBASE:
                if rebased:
                    raise Nonsense("rebase")
                rebased = True
                t.rebase(c.step[0])
                continue
            rebased = False
            at = start + 64 * c.last - left
            fresh, v, s, anchor = t.fresh, t.v, t.s, t.anchor
            hidden = c.hidden and fresh and code != JUMP
            if ends and not c.rotates:
                k = [c.told[axis] - t.v[0] - (0 if fresh else (t.s[0] * (subs // 64) + 480) // 960)]
            if ends and c.rotates:
                t.s = list(t.s)
                rise = t.land(code, subs, from_grid(c.told, c.step[0]), c.step[0])
            else:
                rise = t.step(code, subs, k)
            if code == JUMP:
                v, s, rise = [a + b for a, b in zip(v, k)], k, [0] * t.n
                if told and c.rotates and left == subs:
                    t.land(code, subs, from_grid(c.told, c.step[0]), c.step[0])
            left -= subs
            if left == 0 and told and not c.rotates and t.v != [c.told[axis]]:
                raise Nonsense("end")
            if not hidden:
                lines.append(self.line(number, axis, at, at + subs, code, fresh, v, s, rise, c, anchor))

    def cubics(self, io, lines, number, c, axis, t, start):
        left = 64 * (c.last - c.first)
        while left > 0:
            known, near = t.known, t.near()
            code, subs, k = self.cubic(io, c, axis, t, left)
            drawn = t.step(code, subs, k)
            at = start + 64 * c.last - left
            left -= subs
            if not known:
                continue
            if code == JUMP:
                lines.append(self.line(number, axis, at, at + subs, code, 0, [t.near()], [t.near() - near], [0], c, None))
            else:
                lines.append(f"cubic {number} {axis} {at} {at + subs} {code} " + " ".join(map(str, drawn)))

    def cubic(self, io, c, axis, t, left):
        rows = self.tables[CUBICS, 1]
        code = JUMP if t.phase else self.cubic_code(io, rows, t, left // 64)
        if code == JUMP:
            subs = self.duration(io, t.phase)
            if subs > left:
                raise Nonsense("duration")
            return code, subs, self.plain(io)
        length, line = code - LINE if code >= LINE else code, code >= LINE
        subs = left if length == TO_END else 64 * LENGTHS[length]
        if subs > left or left % 64:
            raise Nonsense("duration")
        if t.run == 3:
            return code, subs, c.first_controls[axis]
        h = subs // 64
        size = 0 if h <= 12 else 1 if h <= 30 else 2
        if line:
            row = 78 + size
        elif t.run:
            row = size + (0 if t.run == 2 else 3)
        else:
            x = 512 * abs(t.last_k) + 256 * abs(t.before_k) + abs(t.bend(h)) // 4 + 12
            n = sum(x > limit for limit in (358, 819, 1536, 2662, 4301, 7168, 12288))
            row = 6 + (3 * n + t.ratio(h)) * 3 + size
        return code, subs, self.k(io, rows["value"][row], 0 if line or t.run else t.sign)

    @staticmethod
    def k(io, row, sign):
        y = io.symbol(row)
        x = (y + 1) // 2 if y & 1 else -(y // 2)
        if y == 31:
            size = io.golomb(0)
            if size > 1 << 30:
                raise Nonsense("k")
            x = -(size + 16) if io.half() else size + 16
        return -x if sign < 0 else x

    @staticmethod
    def cubic_code(io, rows, t, left):
        if t.run:
            if io.flag(1, 6):
                return JUMP
            return io.symbol(rows["length"][17]) if t.run == 3 else t.last_code
        r = min(t.last_code, 16)
        if not t.loose():
            b = sum(limit * t.last_ticks <= 10 * left for limit in (4, 7, 10, 13, 17, 25, 40))
            way = io.symbol(rows["way"][8 * r + b])
            if way == 0:
                return io.symbol(rows["length"][r])
            if way == 1:
                return TO_END
        return JUMP if io.flag(1, 5) else LINE + io.symbol(rows["line"][0])

    def piece(self, io, c, t, left, told):
        """Code, duration, k, and whether the piece ends where it was told."""
        rows = self.tables[c.kind, t.n]
        code = JUMP if t.phase else io.symbol(rows["length"][18 if t.fresh else t.last_code])
        if t.loose() and not t.phase:
            if code >= LINE:
                raise Nonsense("line")
            code += LINE if code <= TO_END else 0
        if code == REBASE:
            if not c.rotates:
                raise Nonsense("rebase")
            return code, 0, None, False
        if code == JUMP:
            subs = self.duration(io, t.phase)
            if subs > left:
                raise Nonsense("duration")
            return code, subs, [self.plain(io) for _ in range(t.n)], False
        length = code - LINE if code >= LINE else code
        subs = left if length == TO_END else 64 * LENGTHS[length]
        if subs > left or left % 64:
            raise Nonsense("duration")
        if told and subs == left:
            return code, subs, None, True
        h, k = subs // 64, []
        for i in range(t.n):
            k.append(self.k(io, rows["value"][self.row(c.kind, t, code, h, i, any(k))], t.sign[i]))
        return code, subs, k, False

    @staticmethod
    def row(kind, t, code, h, i, before):
        base = (33 if t.n == 1 else 48) if code >= LINE and kind == 2 else 0
        if t.fresh or t.loose():
            return base + (0 if h <= 12 else 1 if h <= 30 else 2)
        size = abs(t.last_k[i])
        a = size if size <= 2 else 3 if size <= 4 else 4
        b = 0 if h < t.last_ticks else 1 if h == t.last_ticks else 2
        g = 3 * a + b
        if t.n == 1:
            return base + 3 + 2 * g + (h >= 16)
        return base + 3 + 3 * g + (0 if i == 0 else 2 if before else 1)

    @staticmethod
    def duration(io, phase):
        to_tick = 64 - phase
        if io.flag(29, 5):
            return to_tick
        if io.half():
            return to_tick + 64 * (io.raw(6) + 1)
        n = io.raw(6)
        if not 0 < n < to_tick:
            raise Nonsense("duration")
        return n

    @staticmethod
    def plain(io):
        n = io.raw(5)
        if n > 30:
            raise Nonsense("jump")
        if n == 0:
            return 0
        size = 1 << n - 1 | io.raw(n - 1)
        return -size if io.half() else size

    def close(self, c, restart, independent):
        if c.present and c.last > c.first:
            c.hidden = False
        c.live = c.goes_on
        for t in c.tracks if c.live else []:
            if c.cubic:
                if restart:
                    t.restart()
            elif restart or independent:
                t.forget(restart)
            elif c.rotates:
                t.rebase(c.step[0])

    @staticmethod
    def line(number, axis, start, end, code, fresh, v, s, rise, c, anchor):
        numbers = " ".join(f"{a} {b} {struct.pack('>f', r).hex()}" for a, b, r in zip(v, s, rise))
        tail = " " + " ".join(struct.pack(">f", x).hex() for x in anchor) if c.rotates else ""
        return f"piece {number} {axis} {start} {end} {code} {int(fresh and code != JUMP)} {numbers}{tail}"

    # -- events

    def event_frame(self, payload):
        io = RangeDecoder(payload)
        number, count = io.raw(16), io.raw(5)
        if not 1 <= count <= 14:
            raise Nonsense("events")
        back, t, items = count, self.header.base_ns, []
        for _ in range(count):
            if not io.flag(3, 2):
                back = io.raw(16)
            gap = io.flag(1, 4)
            z = io.sized(7, 64)
            t += -((z + 1) // 2) if z & 1 else z // 2
            t = (t + (1 << 63)) % (1 << 64) - (1 << 63)
            items.append((back, gap, t, io.sized(5, 16), io.sized(5, 16)))
            back -= 1
        if not io.finished() or any(i[0] <= 0 for i in items):
            raise Nonsense("events")
        ahead = None if self.events is None else (number - self.events) % 65536
        for back, _, t, channel, value in items:
            if ahead is None or ahead >= 32768 or back <= ahead:
                self.told(f"event {t} {channel} {value}")
        self.events = number


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: stream_decoder.py FILE: prints what the stream in FILE says")
    try:
        Decoder(print).read(pathlib.Path(sys.argv[1]).read_bytes())
    except Nonsense as why:
        sys.exit(f"{sys.argv[1]}: {why}")


if __name__ == "__main__":
    main()
