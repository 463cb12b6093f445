// The stream of docs/stream.md in JavaScript, for the report and the live page. Float arithmetic is
// rounded by Math.fround after every operation, so that all numbers are those of the library, bit
// for bit (tests/sim/test_stream.py). Without imports; works in a browser and in node.
//
//   const decoder = new StreamDecoder(tables, {piece(p) {...}, event(e) {...}, run(r) {...}});
//   decoder.feed(bytes);      // Uint8Array, any part of a stream
//
// tables: the content of docs/stream_tables.json. A piece tells channel, axis, start and end
// (sub-ticks since the run's base), code, fresh, v, s, rise, anchor, step (StreamDecoder.value); of
// a cubic, `cubic` is [p, v, a, j], BigInts in the units of docs/stream.md.
"use strict";

const STREAM_VERSION = 5;
/// Times that a reader that joins tries, and those of them that need no further check.
const UNWRAPS = 64, UNWRAPS_NEAR = 4;
const LENGTHS = [1, 2, 4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 80, 120];
const TO_END = 16, JUMP = 17, REBASE = 18, LINE = 19, CUBICS = 3;
const POWERS = [32768, 31379, 30049, 28775, 27555, 26386, 25268, 24196, 23171, 22188, 21248, 20347,
                19484, 18658, 17867, 17109];

class Nonsense extends Error {}

// ---- checks

const CRC32 = Uint32Array.from({length: 256}, (_, i) => {
    for (let k = 0; k < 8; ++k) i = i & 1 ? 0xedb88320 ^ (i >>> 1) : i >>> 1;
    return i >>> 0;
});
function crc32(bytes, seed = 0) {
    let c = ~seed >>> 0;
    for (const b of bytes) c = (CRC32[(c ^ b) & 255] ^ (c >>> 8)) >>> 0;
    return ~c >>> 0;
}
const CRC16 = Uint16Array.from({length: 256}, (_, i) => {
    let crc = i << 8;
    for (let k = 0; k < 8; ++k) crc = crc & 0x8000 ? ((crc << 1) ^ 0x1021) & 0xffff : crc << 1;
    return crc;
});
const CRC16_BACK = new Uint8Array(256);
CRC16.forEach((crc, i) => { CRC16_BACK[crc & 255] = i; });
function crc16(bytes, crc) {
    for (const b of bytes) crc = (crc << 8 & 0xffff) ^ CRC16[crc >> 8 ^ b];
    return crc;
}
/// The start value that makes the check of the frame right: found backwards.
function startValue(frame) {
    const n = frame.length;
    let crc = frame[n - 2] << 8 | frame[n - 1];
    for (let i = n - 3; i >= 0; --i) {
        const at = CRC16_BACK[crc & 255];
        crc = (crc ^ CRC16[at]) >> 8 | (at ^ frame[i]) << 8;
    }
    return crc;
}
const KEY = new DataView(new ArrayBuffer(16)), KEY_BYTES = new Uint8Array(KEY.buffer);
function linkStart(link) {
    KEY.setUint32(0, link.digest, true);
    KEY.setBigInt64(4, BigInt(link.end), true);
    KEY.setUint32(12, link.previous, true);
    return crc16(KEY_BYTES, 0xffff);
}
function checkFits(frame, link) { return startValue(frame) === linkStart(link); }
function crcFits(frame, seed) {
    const n = frame.length, told = new DataView(frame.buffer, frame.byteOffset + n - 4, 4);
    return crc32(frame.subarray(0, n - 4), seed) === told.getUint32(0, true);
}
/// Size of the frame that would begin at `at`; 0: none does; -1: not known yet.
function frameSize(data, at) {
    const first = data[at];
    if (first >= 1 && first <= 247) return first + 3;
    if (first !== 0xf8 && first !== 0xf9) return 0;
    if (at + 1 >= data.length) return -1;
    return data[at + 1] > 0 && data[at + 1] <= 244 ? data[at + 1] + 6 : 0;
}

// ---- range coder

class RangeReader {
    constructor(data) {
        this.data = data;
        this.at = 0;
        this.range = 0xffffffff;
        this.code = 0;
        for (let i = 0; i < 4; ++i) this.code = (this.code * 256 + this.byte(this.at++)) >>> 0;
    }
    byte(i) { return i < this.data.length ? this.data[i] : 0; }
    peek(bits) {
        return Math.min(Math.floor(this.code / (this.range >>> bits)), 2 ** bits - 1);
    }
    take(cum, freq, bits) {
        const unit = this.range >>> bits;
        this.code = (this.code - unit * cum) >>> 0;
        this.range = unit * freq;
        while (this.range < 1 << 24) {
            this.code = ((this.code << 8) | this.byte(this.at++)) >>> 0;
            this.range = (this.range << 8) >>> 0;
        }
    }
    finished() {
        let window = 0, size = this.at - 4;
        for (let i = this.at - 4; i < this.at; ++i) window = ((window << 8) | this.byte(i)) >>> 0;
        const low = (window - this.code) >>> 0;
        let shortest = 0;
        for (const mask of [0xffffffff, 0xffffff, 0xffff, 0xff]) {
            const step = (-low & mask) >>> 0;
            if (step < this.range) { shortest = step; break; }
        }
        for (let rest = window; rest !== 0; rest = (rest << 8) >>> 0) ++size;
        return this.code === shortest && this.data.length === Math.max(1, size);
    }
    symbol(row) {
        const place = this.peek(15);
        let cum = 0;
        for (let s = 0; s < row.length; ++s) {
            if (place < cum + row[s]) {
                this.take(cum, row[s], 15);
                return s;
            }
            cum += row[s];
        }
        throw new Nonsense("symbol");
    }
    raw(n) {
        let v = 0;
        while (n > 0) {
            const part = Math.min(n, 12), some = this.peek(part);
            n -= part;
            this.take(some, 1, part);
            v = v * 2 ** part + some;
        }
        return v;
    }
    flag(ones, bits) {
        const zeros = 2 ** bits - ones, v = this.peek(bits) >= zeros;
        this.take(v ? zeros : 0, v ? ones : zeros, bits);
        return v;
    }
    half() { return this.flag(1, 1); }
    golomb(k) {
        let m = 0;
        while (this.half())
            if (++m + k > 32) throw new Nonsense("golomb");
        const v = 2 ** (m + k) + this.raw(m + k) - 2 ** k;
        if (v >= 2 ** 32) throw new Nonsense("golomb");
        return v;
    }
    values(n) {
        let width = this.half() ? this.raw(4) + 1 : 0;
        if (width === 16) width += this.raw(4);
        return Array.from({length: n}, () => {
            const size = this.raw(width);
            return size > 0 && this.half() ? -size : size;
        });
    }
    /// Places of a vector, told against its origin.
    places(origin) {
        const v = this.values(origin.length).map((x, i) => x + origin[i]);
        if (v.some((x) => Math.abs(x) > 2 ** 30)) throw new Nonsense("places");
        return v;
    }
    uniform(n) {
        const highs = n <= 4096 ? n : Math.ceil(n / 256), width = Math.floor(32768 / highs);
        let v = Math.floor(this.peek(15) / width);
        if (v >= highs) throw new Nonsense("uniform");
        this.take(v * width, width, 15);
        if (n > 4096) v = v * 256 + this.raw(8);
        if (v >= n) throw new Nonsense("uniform");
        return v;
    }
    grid(step, origin) {
        const most = gridSize(step);
        if (!this.half()) {
            const n = this.values(3).map((x, i) => x + origin.n[i]);
            if (n.some((x) => Math.abs(x) > most)) throw new Nonsense("grid");
            return {largest: origin.largest, n};
        }
        return {largest: this.raw(2), n: [0, 0, 0].map(() => this.uniform(2 * most + 1) - most)};
    }
    /// A BigInt.
    sized(bits, most) {
        const width = this.raw(bits);
        if (width > most) throw new Nonsense("sized");
        if (width === 0) return 0n;
        const first = 1n << BigInt(width - 1);
        if (width - 1 <= 32) return first | BigInt(this.raw(width - 1));
        const high = BigInt(this.raw(width - 33));
        return first | high << 32n | BigInt(this.raw(32));
    }
}

// ---- single precision

const f = Math.fround;
const add = (a, b) => f(a + b), sub = (a, b) => f(a - b), mul = (a, b) => f(a * b);
const div = (a, b) => f(a / b), root = (a) => f(Math.sqrt(a));

function poly(z, c) {
    let x = f(c[c.length - 1]);
    for (let i = c.length - 2; i >= 0; --i) x = add(mul(x, z), f(c[i]));
    return x;
}
const dot = (a, b) => a.reduce((sum, x, i) => i === 0 ? mul(x, b[0]) : add(sum, mul(x, b[i])), 0);
const cross = (a, b) => [[1, 2], [2, 0], [0, 1]].map(([i, j]) => sub(mul(a[i], b[j]), mul(a[j], b[i])));
function normalise(q) {
    const n = dot(q, q);
    if (!(n > 0)) return [1, 0, 0, 0];
    const s = div(1, root(n));
    return q.map((c) => mul(c, s));
}
function product(a, b) {
    const [aw, ax, ay, az] = a, [bw, bx, by, bz] = b;
    return [sub(sub(sub(mul(aw, bw), mul(ax, bx)), mul(ay, by)), mul(az, bz)),
            sub(add(add(mul(aw, bx), mul(ax, bw)), mul(ay, bz)), mul(az, by)),
            add(add(sub(mul(aw, by), mul(ax, bz)), mul(ay, bw)), mul(az, bx)),
            add(sub(add(mul(aw, bz), mul(ax, by)), mul(ay, bx)), mul(az, bw))];
}
const conjugate = (q) => [q[0], -q[1], -q[2], -q[3]];
const COS = [1, -0.49999994, 0.0416662544, -0.00138796587, 2.39535511e-5];
const SINC = [1, -0.166666657, 0.00833329558, -0.000198328533, 2.6784553e-6];
const ATAN = [0.999999881, -0.333318114, 0.199669614, -0.140032902, 0.0986886546, -0.0588297546,
              0.0237805191, -0.00455979211];
/// cos(a) and sin(a) / a, a half the angle.
function halfAngle(theta) {
    let x = mul(0.25, dot(theta, theta)), halved = 0;
    for (; halved < 32 && x > 1.25; ++halved) x = mul(x, 0.25);
    let c = poly(x, COS), s = poly(x, SINC);
    for (; halved > 0; --halved) [c, s] = [sub(mul(mul(2, c), c), 1), mul(c, s)];
    return [c, s];
}
function exp(theta) {
    const [c, s] = halfAngle(theta), h = mul(0.5, s);
    return [c, ...theta.map((x) => mul(h, x))];
}
function log(q) {
    const d = div(q[0] < 0 ? -1 : 1, add(1, Math.abs(q[0]))), t = q.slice(1).map((c) => mul(d, c));
    const p = mul(4, poly(dot(t, t), ATAN));
    return t.map((c) => mul(p, c));
}
function bodyRate(theta, d) {
    const n2 = dot(theta, theta);
    if (n2 < f(1e-12)) return d;
    const [c, s] = halfAngle(theta), along = div(dot(theta, d), n2), across = cross(theta, d);
    const turn = mul(mul(0.5, s), s), less = sub(1, mul(c, s));
    return d.map((x, i) => sub(sub(x, mul(turn, across[i])), mul(less, sub(x, mul(along, theta[i])))));
}
function nearestSlope(x) {
    x = x < 0 ? sub(x, 0.5) : add(x, 0.5);
    return Math.trunc(Math.max(-(2 ** 23), Math.min(2 ** 23, x))) + 0;
}
const gridStep = (step) => mul(step, 0.25);
const gridSize = (step) => Math.trunc(div(f(0.70710678), gridStep(step))) + 1;
function fromGrid(grid, step) {
    const g = gridStep(step), q = [0, 0, 0, 0], left = [...grid.n];
    let rest = 1;
    for (let i = 0; i < 4; ++i) {
        if (i === grid.largest) continue;
        q[i] = mul(f(left.shift()), g);
        rest = sub(rest, mul(q[i], q[i]));
    }
    q[grid.largest] = rest > 0 ? root(rest) : 0;
    return normalise(q);
}

// ---- curves

const rounded = (n, d) => Math.sign(n) * Math.floor((Math.abs(n) + Math.floor(d / 2)) / d);

class Track {
    constructor(n) {
        this.n = n;
        this.v = Array(n).fill(0);
        this.s = Array(n).fill(0);
        this.anchor = [1, 0, 0, 0];
        this.forget(true);
    }
    forget(fresh) {
        this.lastK = Array(this.n).fill(0);
        this.sign = Array(this.n).fill(0);
        this.lastCode = TO_END;
        this.lastTicks = 1;
        this.phase = 0;
        this.fresh = fresh;
    }
    loose() { return this.lastCode === JUMP && !this.fresh; }
    ahead(c, h) { return this.fresh ? 0 : Math.floor((this.s[c] * h + 480) / 960); }
    step(code, subs, k) {
        const jump = code === JUMP, chord = this.fresh || code >= LINE, h = Math.floor(subs / 64);
        const rise = k.map((x, c) => x + (jump ? 0 : this.ahead(c, h)));
        const s = rise.map((r, c) => jump ? 0 : chord ? rounded(960 * r, h)
                                                      : rounded(1920 * r, h) - this.s[c]);
        const v = rise.map((r, c) => this.v[c] + r);
        if (rise.some((r) => Math.abs(r) > (jump ? 2 ** 30 : 32767)) ||
            v.some((x) => Math.abs(x) > 2 ** 30) || s.some((x) => Math.abs(x) > 2 ** 23))
            throw new Nonsense("bounds");
        this.v = v;
        this.s = s;
        this.remember(code, subs, k);
        return rise;
    }
    remember(code, subs, k) {
        const jump = code === JUMP;
        k.forEach((x, c) => {
            this.lastK[c] = jump || this.fresh ? 0 : Math.max(-100, Math.min(100, x));
            if (!jump && x !== 0) this.sign[c] = x > 0 ? 1 : -1;
        });
        this.lastCode = code >= LINE ? code - LINE : code;
        this.lastTicks = jump ? 1 : subs / 64;
        this.fresh = false;
        this.phase = (this.phase + subs) % 64;
    }
    rebase(step) {
        const theta = this.v.map((v) => mul(f(v), step));
        const rate = bodyRate(theta, this.s.map(f));
        this.anchor = normalise(product(this.anchor, exp(theta)));
        this.v = [0, 0, 0];
        this.s = rate.map(nearestSlope);
    }
    /// Ends at a rotation that was told. Returns the rises of the piece there.
    land(code, subs, target, step) {
        const inverse = div(1, step);
        const end = log(product(conjugate(this.anchor), target)).map((c) => mul(c, inverse));
        const rise = end.map((e, c) => sub(e, f(this.v[c])));
        if (code !== JUMP) {
            const chord = this.fresh || code >= LINE, h = f(subs / 64);
            this.s = rise.map((r, c) => {
                const t = div(mul(960, r), h);
                return nearestSlope(chord ? t : sub(mul(2, t), f(this.s[c])));
            });
            this.remember(code, subs, [0, 0, 0]);
            this.phase = 0;
        }
        const rate = bodyRate(end.map((e) => mul(e, step)), this.s.map(f));
        this.anchor = target;
        this.v = [0, 0, 0];
        this.s = rate.map(nearestSlope);
        return rise;
    }
}

// ---- cubics: integers of 64 bits

const U = 960n ** 3n;
const big = BigInt, size = (x) => x < 0n ? -x : x;
const floored = (n, d) => n / d - (n % d < 0n ? 1n : 0n);
const away = (n, d) => (n < 0n ? n - d / 2n : n + d / 2n) / d;
const WEIGHTS = [[113n, 84n], [115n, 69n], [122n, 89n]];
const SIZES = [358n, 819n, 1536n, 2662n, 4301n, 7168n, 12288n];

/// State of an axis of cubics. value: null for a reader that joins.
class Cubic {
    constructor(value) {
        Object.assign(this, {n: 1, p: 6n * U * big(value ?? 0), v: 0n, a: 0n, c1: 0n, c2: 0n});
        Object.assign(this, {lastK: 0n, beforeK: 0n, sign: 0, phase: 0, run: 0});
        Object.assign(this, {lastCode: JUMP, lastTicks: 1, known: value !== null});
        if (!this.known) this.restart();
    }
    restart() {
        Object.assign(this, {lastK: 0n, beforeK: 0n, sign: 0, phase: 0, run: 3, lastCode: TO_END, lastTicks: 1});
    }
    loose() { return this.lastCode === JUMP && this.run === 0; }
    near() { return floored(this.p + 3n * U, 6n * U); }
    travel(h) { return floored(1024n * h * this.v, 2n * U); }
    bend(h) { return floored(1024n * h * h * this.a, U); }
    ratio(h) { return h === this.lastTicks ? 0 : h > this.lastTicks ? 1 : 2; }
    control(h) {
        if (this.run === 3) return 0n;
        if (this.run === 2) return this.c1;
        if (this.run === 1) return this.c2 + floored(9n * (this.c2 - this.c1) + 5n, 10n);
        const near = this.near(), part = floored(1024n * (this.p - 6n * U * near), 6n * U);
        const [wt, wb] = WEIGHTS[this.ratio(Number(h))];
        return near + floored(64n * part + wt * this.travel(h) + wb * this.bend(h) + 32768n, 65536n);
    }
    within() {
        if (size(this.p) > 6n * U << 30n || size(this.v) > U << 14n || size(this.a) > U << 11n)
            throw new Nonsense("bounds");
    }
    jump(subs, k) {
        const aim = (this.run > 0 ? 0n : this.near()) + big(k);
        if (size(aim) > 1n << 30n) throw new Nonsense("jump");
        Object.assign(this, {p: 6n * U * aim, v: 0n, a: 0n, lastK: 0n, beforeK: 0n, sign: 0, run: 0});
        Object.assign(this, {lastCode: JUMP, lastTicks: 1, known: true, phase: (this.phase + subs) % 64});
    }
    /// A cubic or a line. Returns [p, v, a, j] of the piece; null where they are not known.
    step(code, ticks, number) {
        const h = big(ticks), k = big(number), line = code >= LINE, {run} = this;
        if (this.loose() !== line && (!line || run > 0)) throw new Nonsense("piece");
        if (run > 0 && (line || code === TO_END || (run < 3 && ticks !== this.lastTicks)))
            throw new Nonsense("run");
        const aim = k + (line ? this.near() + floored(this.travel(h) + 512n, 1024n) : this.control(h));
        if (size(aim) > 1n << 30n || size(k) > (run === 3 ? 1n << 30n : 1n << 20n)) throw new Nonsense("aim");
        const drawn = this.known ? this.draw(line, h, aim) : null;
        if (run === 1) {
            this.p = U * (this.c1 + 4n * this.c2 + aim);
            this.v = U * (aim - this.c1) / h;
            this.a = U * (this.c1 - 2n * this.c2 + aim) / (h * h);
            this.known = true;
        }
        this.within();
        if (run === 3) this.c1 = aim;
        if (run === 2) this.c2 = aim;
        if (run === 0) this.remember(line, k);
        this.run = Math.max(0, run - 1);
        this.lastCode = line ? code - LINE : code;
        this.lastTicks = ticks;
        return drawn;
    }
    draw(line, h, aim) {
        const {p} = this;
        let {v, a} = this, j = 0n;
        if (size(aim - this.near()) > 1n << 17n) throw new Nonsense("aim");
        if (line) [v, a] = [away(6n * U * aim - p, 3n * h), 0n];
        else j = away(6n * U * aim - p - 6n * h * v - 11n * h * h * a, 6n * h ** 3n);
        if (size(v) > U << 14n) throw new Nonsense("bounds");
        this.p = p + 3n * h * v + 3n * h * h * a + h ** 3n * j;
        this.v = v + 2n * h * a + h * h * j;
        this.a = a + h * j;
        return [p, v, a, j];
    }
    remember(line, k) {
        this.beforeK = line ? 0n : this.lastK;
        this.lastK = line ? 0n : k > 100n ? 100n : k < -100n ? -100n : k;
        this.sign = line ? 0 : k > 0n ? 1 : k < 0n ? -1 : this.sign;
    }
    valueRow(line, ticks) {
        const of = ticks <= 12 ? 0 : ticks <= 30 ? 1 : 2;
        if (line) return 78 + of;
        if (this.run > 0) return of + (this.run === 2 ? 0 : 3);
        const x = 512n * size(this.lastK) + 256n * size(this.beforeK) + size(this.bend(big(ticks))) / 4n + 12n;
        return 6 + (3 * SIZES.filter((limit) => x > limit).length + this.ratio(ticks)) * 3 + of;
    }
}

// ---- the stream

class Header {
    constructor(payload) {
        if (payload[0] !== STREAM_VERSION)
            throw new Error(`the stream has version ${payload[0]} of the format; ` +
                            `this reader knows version ${STREAM_VERSION}`);
        const view = new DataView(payload.buffer, payload.byteOffset, payload.length);
        let at = 1;
        const byte = () => view.getUint8(at++);
        const varying = () => {
            let v = 0n, shift = 0n;
            for (let b = 128; b > 127; shift += 7n) {
                b = byte();
                v |= BigInt(b & 127) << shift;
            }
            return v;
        };
        const zigzag = () => {
            const z = varying();
            return z & 1n ? -((z + 1n) / 2n) : z / 2n;
        };
        this.streamId = Number(varying());
        this.run = Number(varying());
        this.baseNs = zigzag();
        this.subNs = Number(varying());
        const form = byte();
        this.timeBits = (form & 31) + 1;
        this.independent = form > 127;
        this.usual = byte();
        this.restartFrames = byte();
        this.channels = Array.from({length: (form >> 5 & 3) + 1}, () => {
            const what = byte(), count = (what & 7) + 1, rotates = what > 127;
            const tolerance = ((rotates ? 36409 : 27307) + Number(zigzag())) / 32768;
            const steps = Array.from({length: what & 8 ? count : 1}, () => {
                const m = 256 + byte();
                return f(m * 2 ** view.getInt8(at++));
            });
            const told = Array.from({length: count}, () => Number(zigzag()));
            const origin = rotates ? {largest: told[0] & 3, n: [told[0] >> 2, told[1], told[2]]} : told;
            return {origin, rotates, kind: what >> 4 & 7, axes: count, tolerance, live: false, hidden: false,
                    over: false, steps: steps.length === 1 ? Array(count).fill(steps[0]) : steps,
                    cubic: (what >> 4 & 7) === CUBICS,
                    tracks: Array.from({length: rotates ? 1 : count}, () => new Track(rotates ? 3 : 1))};
        });
        this.digest = crc32(payload.subarray(0, at));
        const place = varying(), end = place >> 1n;
        this.starts = (place & 1n) === 1n;
        this.end = Number(end & 1n ? -((end + 1n) / 2n) : end / 2n);
    }
}

class StreamDecoder {
    constructor(tables, told) {
        this.told = {run() {}, piece() {}, event() {}, ...told};
        const rows = (table) => table?.map((row) => row.map(StreamDecoder.frequency));
        this.tables = new Map(tables.map((t) => [t.kind * 8 + t.components, {
            length: rows(t.length), value: rows(t.value), way: rows(t.way), line: rows(t.line),
        }]));
        this.header = null;
        this.link = null;
        this.events = null;
        this.near = 0;
        this.losses = 0;
        this.inStep = true;
        this.data = new Uint8Array(0);
    }
    static frequency(cost) {
        const shift = cost >> 4;
        return (POWERS[cost & 15] + (1 << shift) - 1) >> shift;
    }
    /// Value of component c of a piece, t ticks after its start, in double precision: in the
    /// channel's unit, or rad in the chart of a rotation.
    static value(p, t, c = 0) {
        const h = (p.end - p.start) / 64, w = t / h, ahead = p.s[c] / 960;
        let x = p.v[c];
        if (p.cubic) {
            const [start, v, a, j] = p.cubic, unit = Number(U);
            const part = Number(start - 6n * U * BigInt(x)) / (6 * unit);
            return (x + (part + t * (Number(v) / 2 + t * (Number(a) / 2 + t * Number(j) / 6)) / unit)) * p.step;
        }
        if (p.code === JUMP || h === 0) return x * p.step;
        if (p.code >= LINE) x += p.rise[c] * w;
        else if (!p.fresh) x += ahead * t + (p.rise[c] - ahead * h) * w * w;
        else x += ahead * h * w * (1 - w) ** 2 + p.rise[c] * w * w * (2 - w);
        return x * p.step;
    }

    /// More bytes of the stream. ended: no bytes follow.
    feed(bytes, ended = false) {
        const data = new Uint8Array(this.data.length + bytes.length);
        data.set(this.data);
        data.set(bytes, this.data.length);
        let at = 0;
        while (at < data.length) {
            if (this.inStep) {
                const size = frameSize(data, at);
                if (!ended && (size < 0 || (size > 0 && at + size > data.length))) break;
                if (size > 0 && at + size <= data.length && this.frame(data.subarray(at, at + size))) {
                    at += size;
                    continue;
                }
                this.inStep = false;
                ++this.losses;
            }
            const next = this.resume(data, at);
            if (next < 0) {
                at = ended ? data.length : Math.max(at, data.length - 768);
                break;
            }
            at = next;
            this.inStep = true;
        }
        this.data = data.slice(at);
    }
    frame(frame) {
        if (frame[0] >= 0xf8) return this.longFrame(frame);
        if (this.header === null || this.link === null || !checkFits(frame, this.link)) return false;
        return this.attempt(() => this.dataFrame(frame, "in step", this.link.end));
    }
    attempt(read) {
        try {
            read();
            return true;
        } catch (why) {
            if (why instanceof Nonsense) return false;
            throw why;
        }
    }
    longFrame(frame) {
        const event = frame[0] === 0xf9;
        if ((event && this.header === null) || !crcFits(frame, event ? this.header.digest : 0)) return false;
        const payload = frame.subarray(2, frame.length - 4);
        if (event) return this.attempt(() => this.eventFrame(payload));
        const header = new Header(payload);
        if (header.starts || this.header === null || header.digest !== this.header.digest) {
            this.header = header;
            const {digest, end} = header;
            this.link = header.starts ? {digest, end, previous: 0, since: 0} : null;
            this.near = header.end;
            this.told.run(header);
        }
        return true;
    }
    /// Does a header frame tell of another run than the one that is followed?
    isNews(frame) {
        const header = new Header(frame.subarray(2, frame.length - 4));
        return header.starts || this.header === null || header.digest !== this.header.digest;
    }
    /// Out of step: the next place from which two checks in a row fit, or -1.
    resume(data, at) {
        for (let p = at; p + 3 < data.length; ++p) {
            const size = frameSize(data, p);
            if (size <= 0 || p + size > data.length) continue;
            const frame = data.subarray(p, p + size);
            if (frame[0] === 0xf8 && crcFits(frame, 0) && this.isNews(frame)) return p;
            if (frame[0] === 0xf9) this.longFrame(frame);
            if (frame[0] >= 0xf8 || this.header === null) continue;
            if (this.link !== null && checkFits(frame, this.link) &&
                this.follows(data, p + size, frame, this.link, 1)) return p;
            const time = this.joinable(data, p, frame);
            if (time === null) continue;
            const reading = this.header.independent ? "lone" : "joining";
            if (this.attempt(() => this.dataFrame(frame, reading, time))) return p + size;
        }
        return -1;
    }
    linkBehind(frame, end, restart, before) {
        return {digest: this.header.digest, end, previous: crc32(frame, restart ? this.header.digest : before.previous),
                since: restart ? 0 : before.since + 1};
    }
    follows(data, at, frame, link, count, first = false) {
        let head;
        if (!this.attempt(() => { head = this.head(StreamDecoder.io(frame), link, false); }))
            return false;
        if (first && head.restart && !this.header.independent) return false;
        return this.chain(data, at, this.linkBehind(frame, head.end, head.restart, link), count, first);
    }
    chain(data, at, link, count, first = false) {
        if (at >= data.length) return false;
        const size = frameSize(data, at);
        if (size <= 0 || at + size > data.length) return false;
        const frame = data.subarray(at, at + size);
        if (frame[0] >= 0xf8) return this.chain(data, at + size, link, count, first);
        return checkFits(frame, link) &&
               (count === 1 || this.follows(data, at + size, frame, link, count - 1, first));
    }
    joinable(data, p, frame) {
        let head;
        const link = {end: this.near, since: 0};
        if (!this.attempt(() => { head = this.head(StreamDecoder.io(frame), link, true); })) return null;
        const next = this.dataFrameFrom(data, p + frame.length);
        if (next === null) return null;
        const start = startValue(next), behind = this.linkBehind(frame, head.end, true, null);
        for (let i = 0; i < UNWRAPS; ++i) {
            const turn = i * 64 * 2 ** this.header.timeBits, then = {...behind, end: head.end + turn};
            if (linkStart(then) !== start) continue;
            if (this.chain(data, p + frame.length, then, i < UNWRAPS_NEAR ? 2 : 3, true))
                return (this.header.independent ? head.start : head.end) + turn;
        }
        return null;
    }
    /// The data frame at `at`, or behind header and event frames there.
    dataFrameFrom(data, at) {
        while (at < data.length) {
            const size = frameSize(data, at);
            if (size <= 0 || at + size > data.length) return null;
            if (data[at] < 0xf8) return data.subarray(at, at + size);
            at += size;
        }
        return null;
    }

    static io(frame) { return new RangeReader(frame.subarray(1, frame.length - 2)); }

    time(io, from) {
        const sub = io.flag(1, 4) ? io.raw(6) : 0, bits = this.header.timeBits;
        const low = io.raw(bits), turn = 2 ** bits, tick = Math.ceil((from - sub) / 64);
        return (tick + ((low - tick) % turn + turn) % turn) * 64 + sub;
    }
    ticks(io) {
        if (io.flag(7, 3)) return this.header.usual;
        const v = io.golomb(2);
        const n = v % 2 === 1 ? this.header.usual + (v + 1) / 2 : this.header.usual - v / 2;
        if (v === 0 || n < 0 || n > 255) throw new Nonsense("ticks");
        return n;
    }
    head(io, link, joining) {
        const {independent, restartFrames} = this.header, before = link.end;
        let restart = independent, jump = 0;
        if (!independent) {
            const due = restartFrames > 0 && link.since + 1 >= restartFrames;
            restart = io.flag(1, 4) !== due || joining;
        }
        if (io.flag(1, 5)) {
            const high = io.golomb(0);
            jump = high * 65536 + io.raw(16);
            if (high >= 2 ** 28 || jump === 0) throw new Nonsense("jump");
        }
        let start = before + jump;
        const length = 64 * this.ticks(io);
        if (restart) {
            const known = independent ? start : start + length;
            const told = this.time(io, joining ? before : known);
            if (!joining && told !== known) throw new Nonsense("time");
            start = independent ? told : told - length;
        }
        return {start, end: start + length, restart};
    }

    dataFrame(frame, reading, before) {
        const io = StreamDecoder.io(frame), joining = reading !== "in step";
        const link = joining ? {end: before, since: 0} : this.link;
        const head = this.head(io, link, joining), {independent, channels} = this.header;
        const restart = head.restart && !independent, ticks = (head.end - head.start) / 64;
        if (joining) {
            for (const c of channels) {
                c.tracks = c.tracks.map((t) => c.cubic ? new Cubic(null) : new Track(t.n));
                c.live = false;
            }
        }
        for (const c of channels) this.ends(io, c, restart, reading);
        const pieces = [];
        if (reading === "joining") {
            for (const c of channels) {
                c.live = c.hidden = c.goesOn;
                if (!c.live) continue;
                if (c.rotates) c.tracks[0].anchor = fromGrid(c.told, c.steps[0]);
                else if (!c.cubic) c.tracks.forEach((t, i) => { t.v = [c.told[i]]; });
            }
        } else {
            for (const c of channels) this.times(io, c, ticks);
            channels.forEach((c, number) => {
                if (c.over) c.tracks.forEach((t, i) => pieces.push(StreamDecoder.point(number, i, c, head.start)));
            });
            channels.forEach((c, number) => {  // curves of a single vertex
                if (!c.present || c.first < c.last || c.goesOn) return;
                c.tracks.forEach((t, i) => pieces.push(StreamDecoder.point(number, i, c, head.start + 64 * c.first, t)));
            });
            channels.forEach((c, number) => {
                if (!c.present) return;
                c.tracks.forEach((t, i) => {
                    if (c.cubic) this.cubics(io, pieces, number, c, i, t, head.start);
                    else this.pieces(io, pieces, number, c, i, t, head.start);
                });
            });
            if (!io.finished()) throw new Nonsense("payload");
            pieces.forEach((p) => this.told.piece(p));
            for (const c of channels) this.close(c, restart);
        }
        this.link = this.linkBehind(frame, head.end, head.restart, this.link);
        this.near = head.end;
    }
    static point(channel, axis, c, at, t = null) {
        const n = c.rotates ? 3 : 1, zero = Array(n).fill(0);
        const cubic = t instanceof Cubic;
        return {channel, axis, start: at, end: at, code: JUMP, fresh: false,
                v: cubic ? [Number(t.near())] : t ? t.v : zero, s: t && !cubic ? t.s : zero, rise: zero, rotates: c.rotates, step: c.steps[c.rotates ? 0 : axis],
                anchor: t && !cubic ? t.anchor : [1, 0, 0, 0], ends: true};
    }
    ends(io, c, restart, reading) {
        const independent = this.header.independent;
        c.over = false;
        if (independent) {
            const live = io.flag(15, 4);
            if (reading === "in step" && live && !c.live) throw new Nonsense("live");
            c.over = reading === "in step" && c.live && !live;
            c.live = live;
            if (live) this.startTold(io, c, reading);
        }
        const usual = restart || c.live;
        c.goesOn = io.flag(15, 4) ? usual : !usual;
        c.told = null;
        if (c.goesOn && !c.cubic && (restart || (independent && c.rotates)))
            c.told = c.rotates ? io.grid(c.steps[0], c.origin) : io.places(c.origin);
    }
    startTold(io, c, reading) {
        const anchor = c.rotates ? fromGrid(io.grid(c.steps[0], c.origin), c.steps[0]) : null;
        const v = c.rotates ? [0, 0, 0] : io.places(c.origin), s = io.values(c.rotates ? 3 : c.axes);
        c.tracks.forEach((t, i) => {
            const tv = c.rotates ? v : [v[i]], ts = c.rotates ? s : [s[i]];
            if (reading === "in step" && (String(t.v) !== String(tv) || String(t.s) !== String(ts) ||
                                          (c.rotates && String(t.anchor) !== String(anchor))))
                throw new Nonsense("start");
            t.v = tv;
            t.s = ts;
            if (c.rotates) t.anchor = anchor;
            if (reading !== "in step") t.forget(false);
        });
    }
    times(io, c, ticks) {
        if (!this.header.independent) c.over = c.live && io.flag(1, 5);
        c.live = c.live && !c.over;
        c.present = c.live || c.goesOn || io.flag(1, 4);
        if (!c.present) return;
        c.first = c.live ? 0 : io.uniform(ticks + 1);
        c.last = c.goesOn ? ticks : c.first + io.uniform(ticks + 1 - c.first);
        if (!c.live) {
            c.tracks = c.tracks.map((t) => new Track(t.n));
            if (c.rotates) c.tracks[0].anchor = fromGrid(io.grid(c.steps[0], c.origin), c.steps[0]);
            else if (c.cubic) c.tracks = io.places(c.origin).map((v) => new Cubic(v));
            else io.places(c.origin).forEach((v, i) => { c.tracks[i].v = [v]; });
        } else if (c.cubic && c.last > c.first && c.tracks[0].run === 3) {
            c.firstControls = io.places(c.origin);
        }
    }
    cubics(io, pieces, channel, c, axis, t, frameStart) {
        let left = 64 * (c.last - c.first);
        while (left > 0) {
            const {known} = t, before = t.near(), start = frameStart + 64 * c.last - left;
            const {code, subs, k} = this.cubic(io, c, axis, t, left);
            const cubic = code === JUMP ? t.jump(subs, k) : t.step(code, subs / 64, k);
            left -= subs;
            if (!known) continue;
            const jumped = code === JUMP, near = t.near();
            pieces.push({channel, axis, start, end: start + subs, code, fresh: false, cubic,
                         v: [Number(jumped ? near : before)], s: [jumped ? Number(near - before) : 0],
                         rise: [jumped ? 0 : Number(near - before)], rotates: false, anchor: [1, 0, 0, 0],
                         step: c.steps[axis], ends: left === 0 && !c.goesOn});
        }
    }
    cubic(io, c, axis, t, left) {
        const rows = this.tables.get(CUBICS * 8 + 1);
        const code = t.phase ? JUMP : StreamDecoder.cubicCode(io, rows, t, Math.floor(left / 64));
        if (code === JUMP) {
            const subs = StreamDecoder.duration(io, t.phase);
            if (subs > left) throw new Nonsense("duration");
            return {code, subs, k: StreamDecoder.plain(io)};
        }
        const line = code >= LINE, length = line ? code - LINE : code;
        const subs = length === TO_END ? left : 64 * LENGTHS[length];
        if (subs > left || left % 64 !== 0) throw new Nonsense("duration");
        if (t.run === 3) return {code, subs, k: c.firstControls[axis]};
        const row = rows.value[t.valueRow(line, subs / 64)];
        return {code, subs, k: StreamDecoder.k(io, row, line || t.run > 0 ? 0 : t.sign)};
    }
    static cubicCode(io, rows, t, left) {
        if (t.run > 0) {
            if (io.flag(1, 6)) return JUMP;
            return t.run === 3 ? io.symbol(rows.length[17]) : t.lastCode;
        }
        const r = Math.min(t.lastCode, 16);
        if (!t.loose()) {
            const b = [4, 7, 10, 13, 17, 25, 40].filter((x) => x * t.lastTicks <= 10 * left).length;
            const way = io.symbol(rows.way[8 * r + b]);
            if (way === 0) return io.symbol(rows.length[r]);
            if (way === 1) return TO_END;
        }
        return io.flag(1, 5) ? JUMP : LINE + io.symbol(rows.line[0]);
    }
    static k(io, row, sign) {
        const y = io.symbol(row);
        let x = y % 2 === 1 ? (y + 1) / 2 : -y / 2;
        if (y === 31) {
            const more = io.golomb(0);
            if (more > 2 ** 30) throw new Nonsense("k");
            x = io.half() ? -(more + 16) : more + 16;
        }
        return (sign < 0 ? -x : x) + 0;
    }
    pieces(io, pieces, channel, c, axis, t, frameStart) {
        let left = 64 * (c.last - c.first), rebased = false;
        const target = c.told !== null && c.rotates ? fromGrid(c.told, c.steps[0]) : null;
        const reached = () => c.rotates ? String(t.anchor) === String(target) : t.v[0] === c.told[axis];
        if (left === 0 && c.told !== null && !reached()) throw new Nonsense("end");
        while (left > 0) {
            const p = this.piece(io, c, t, left);
            if (p.code === REBASE) {
                if (rebased) throw new Nonsense("rebase");
                rebased = true;
                t.rebase(c.steps[0]);
                continue;
            }
            rebased = false;
            const start = frameStart + 64 * c.last - left, {fresh, anchor} = t;
            const hidden = c.hidden && fresh && p.code !== JUMP;
            let {v, s} = t, rise;
            if (p.ends && !c.rotates) p.k = [c.told[axis] - t.v[0] - t.ahead(0, p.subs / 64)];
            if (p.ends && c.rotates) rise = t.land(p.code, p.subs, target, c.steps[0]);
            else rise = t.step(p.code, p.subs, p.k);
            if (p.code === JUMP) {
                v = v.map((x, i) => x + p.k[i]);
                s = p.k;
                rise = Array(t.n).fill(0);
                if (target !== null && left === p.subs) t.land(p.code, p.subs, target, c.steps[0]);
            }
            left -= p.subs;
            if (left === 0 && c.told !== null && !c.rotates && !reached()) throw new Nonsense("end");
            if (!hidden)
                pieces.push({channel, axis, start, end: start + p.subs, code: p.code,
                             fresh: fresh && p.code !== JUMP, v, s, rise, rotates: c.rotates, anchor,
                             step: c.steps[c.rotates ? 0 : axis], ends: left === 0 && !c.goesOn});
        }
    }
    piece(io, c, t, left) {
        const rows = this.tables.get(c.kind * 8 + t.n);
        if (!rows) throw new Error(`pieces of kind ${c.kind} are unknown to this reader`);
        let code = t.phase ? JUMP : io.symbol(rows.length[t.fresh ? 18 : t.lastCode]);
        if (t.loose() && !t.phase) {
            if (code >= LINE) throw new Nonsense("line");
            if (code <= TO_END) code += LINE;
        }
        if (code === REBASE) {
            if (!c.rotates) throw new Nonsense("rebase");
            return {code};
        }
        if (code === JUMP) {
            const subs = StreamDecoder.duration(io, t.phase);
            if (subs > left) throw new Nonsense("duration");
            return {code, subs, k: t.v.map(() => StreamDecoder.plain(io)), ends: false};
        }
        const length = code >= LINE ? code - LINE : code;
        const subs = length === TO_END ? left : 64 * LENGTHS[length];
        if (subs > left || left % 64 !== 0) throw new Nonsense("duration");
        if (c.told !== null && subs === left) return {code, subs, k: null, ends: true};
        const k = [];
        for (let i = 0; i < t.n; ++i) {
            const row = StreamDecoder.row(c.kind, t, code, subs / 64, i, k.some((x) => x !== 0));
            k.push(StreamDecoder.k(io, rows.value[row], t.sign[i]));
        }
        return {code, subs, k, ends: false};
    }
    static row(kind, t, code, h, i, before) {
        const base = code >= LINE && kind === 2 ? (t.n === 1 ? 33 : 48) : 0;
        if (t.fresh || t.loose()) return base + (h <= 12 ? 0 : h <= 30 ? 1 : 2);
        const size = Math.abs(t.lastK[i]), a = size <= 2 ? size : size <= 4 ? 3 : 4;
        const g = 3 * a + (h < t.lastTicks ? 0 : h === t.lastTicks ? 1 : 2);
        if (t.n === 1) return base + 3 + 2 * g + (h >= 16 ? 1 : 0);
        return base + 3 + 3 * g + (i === 0 ? 0 : before ? 2 : 1);
    }
    static duration(io, phase) {
        const toTick = 64 - phase;
        if (io.flag(29, 5)) return toTick;
        if (io.half()) return toTick + 64 * (io.raw(6) + 1);
        const n = io.raw(6);
        if (n === 0 || n >= toTick) throw new Nonsense("duration");
        return n;
    }
    static plain(io) {
        const n = io.raw(5);
        if (n > 30) throw new Nonsense("jump");
        if (n === 0) return 0;
        const size = 2 ** (n - 1) + io.raw(n - 1);
        return io.half() ? -size : size;
    }
    close(c, restart) {
        if (c.present && c.last > c.first) c.hidden = false;
        c.live = c.goesOn;
        if (!c.live) return;
        for (const t of c.tracks) {
            if (c.cubic) {
                if (restart) t.restart();
            } else if (restart || this.header.independent) t.forget(restart);
            else if (c.rotates) t.rebase(c.steps[0]);
        }
    }

    eventFrame(payload) {
        const io = new RangeReader(payload), number = io.raw(16), count = io.raw(5), items = [];
        if (count < 1 || count > 14) throw new Nonsense("events");
        let back = count, t = this.header.baseNs;
        for (let i = 0; i < count; ++i, --back) {
            if (!io.flag(3, 2)) back = io.raw(16);
            const gap = io.flag(1, 4), z = io.sized(7, 64);
            t = BigInt.asIntN(64, t + (z & 1n ? -((z + 1n) / 2n) : z / 2n));
            items.push({back, gap, tNs: t, channel: Number(io.sized(5, 16)), value: Number(io.sized(5, 16))});
            if (back <= 0) throw new Nonsense("events");
        }
        if (!io.finished()) throw new Nonsense("events");
        const ahead = this.events === null ? null : (number - this.events + 65536) % 65536;
        for (const e of items)
            if (ahead === null || ahead >= 32768 || e.back <= ahead) this.told.event(e);
        this.events = number;
    }
}

if (typeof module !== "undefined") module.exports = {StreamDecoder};
