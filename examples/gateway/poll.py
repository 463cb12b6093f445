#!/usr/bin/env python3
"""Rebuilds the orientation of one unit from its polled registers and prints it as CSV.

usage: poll.py [HOST [PORT [UNIT [SECONDS]]]]        needs: python3-pymodbus (3.0 or later)
The addresses are those of docs/registers.md; the arithmetic of a span is a dozen lines.
"""
import inspect
import math
import struct
import sys
import time

from pymodbus.client import ModbusTcpClient

LIVE, STATE_REGISTERS = 32, 64          # live and stream block in one request
ORIENTATION, PAGE, PAGES = 1000, 125, 128
HEADER, SPAN, SPANS_PER_PAGE = 8, 39, 3

host = sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1"
port = int(sys.argv[2]) if len(sys.argv) > 2 else 1502
unit = int(sys.argv[3]) if len(sys.argv) > 3 else 1
seconds = float(sys.argv[4]) if len(sys.argv) > 4 else math.inf

client = ModbusTcpClient(host, port=port)
# the keyword for the unit is `slave` up to pymodbus 3.9 and `device_id` after it
parameters = inspect.signature(client.read_holding_registers).parameters
keyword = "device_id" if "device_id" in parameters else "slave"


def read(address, count):
    answer = client.read_holding_registers(address, count=count, **{keyword: unit})
    if answer.isError():
        raise IOError(answer)
    return struct.pack(f">{count}H", *answer.registers)


def orientation(span, t_ns):
    """anchor * exp(y): behind the anchor a turn by |y| rad about y."""
    t0_ns, _, (w, x, y, z), c, _ = span
    u = (t_ns - t0_ns) * 1e-9
    theta = [c[k] + u * (c[3 + k] + u * (c[6 + k] + u * c[9 + k])) for k in range(3)]
    angle = math.sqrt(sum(v * v for v in theta))
    s = math.sin(angle / 2) / angle if angle > 1e-9 else 0.5
    a, (i, j, k) = math.cos(angle / 2), (s * v for v in theta)
    return [w * a - x * i - y * j - z * k, w * i + x * a + y * k - z * j,
            w * j - x * k + y * a + z * i, w * k + x * j - y * i + z * a]


def parse_span(page, i):
    at = 2 * (HEADER + SPAN * i)
    values = struct.unpack_from(">qI16fH", page, at)
    return values[0], values[1], values[2:6], values[6:18], values[18]


epoch, wanted = None, 0
print("t_s,w,x,y,z")
end = time.monotonic() + seconds
while time.monotonic() < end:
    state = read(LIVE, STATE_REGISTERS)
    now_epoch, = struct.unpack_from(">I", state, 2 * 2)
    count, = struct.unpack_from(">I", state, 2 * 44)
    if now_epoch != epoch:              # another run: never join it to the one before
        epoch, wanted = now_epoch, max(0, count - SPANS_PER_PAGE * (PAGES - 1))
    while wanted < count:
        first = wanted - wanted % SPANS_PER_PAGE
        page = read(ORIENTATION + first // SPANS_PER_PAGE % PAGES * PAGE, PAGE)
        page_epoch, page_first, in_page, _, sub_ns = struct.unpack_from(">IIHHI", page)
        if page_epoch != epoch or page_first != first:
            print(f"lost span {wanted}", file=sys.stderr)
            break
        while wanted < count and wanted - first < in_page:
            span = parse_span(page, wanted - first)
            begins = span[4] & 1        # then it holds at its start, too
            for tick in range(0 if begins else 1, span[1] // 64 + 1):
                t_ns = span[0] + tick * 64 * sub_ns
                print(f"{t_ns * 1e-9:.6f}," + ",".join(f"{v:.6f}" for v in
                                                       orientation(span, t_ns)))
            wanted += 1
    time.sleep(1)
