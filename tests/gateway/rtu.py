#!/usr/bin/python3
"""Modbus RTU as adapters deliver it: requests byte by byte, in pieces, with echo, behind noise, and
between other units' traffic; every request must be answered with the right bytes.

usage: tests/gateway/rtu.py [BUILD [REQUESTS]]      (make gateway-measure: 1000 requests a pattern)
Each pattern has a gateway and a pseudo-terminal of its own; all run at once.
"""
import os
import pty
import random
import select
import subprocess
import sys
import tempfile
import threading
import time
import tty

build = sys.argv[1] if len(sys.argv) > 1 else "build"
requests = int(sys.argv[2]) if len(sys.argv) > 2 else 1000


def crc(data):
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ 0xA001 if value & 1 else value >> 1
    return bytes([value & 0xFF, value >> 8])


def frame(*data):
    return bytes(data) + crc(bytes(data))


ASK = frame(1, 3, 0, 22, 0, 2)                       # probe.u32
ANSWER = frame(1, 3, 4, 1, 2, 3, 4)
INSIDE = frame(9, 3, 12, *ASK, 1, 2, 3, 4)           # another unit's answer that holds our request


class Line:
    def __init__(self, folder, name, gap_s):
        self.fd, self.device = pty.openpty()
        tty.setraw(self.fd)
        tty.setraw(self.device)
        motion, config = f"{folder}/motion.csv", f"{folder}/{name}.toml"
        with open(config, "w", encoding="ascii") as out:
            out.write(f'[[unit]]\nid = 1\nsource = "replay"\nfile = "{motion}"\n[server]\nlisten = []\n'
                      f'[rtu]\ndevice = "{os.ttyname(self.device)}"\n')
            if gap_s:
                out.write(f"gap_s = {gap_s}\n")
        self.gateway = subprocess.Popen([f"{build}/fairlead-gateway", "--config", config],
                                        stderr=subprocess.DEVNULL)
        end = time.monotonic() + 10
        while time.monotonic() < end:
            os.write(self.fd, ASK)
            if self.read(0.3) == ANSWER:
                return
        raise SystemExit(f"{name}: the gateway does not answer at all")

    def read(self, seconds, wanted=len(ANSWER)):
        got, end = b"", time.monotonic() + seconds
        while len(got) < wanted and (left := end - time.monotonic()) > 0:
            if select.select([self.fd], [], [], left)[0]:
                got += os.read(self.fd, 512)
        return got

    def close(self):
        self.gateway.terminate()
        self.gateway.wait(5)


def by_bytes(pause_s):
    def send(line, _):
        for i in range(len(ASK)):
            os.write(line.fd, ASK[i:i + 1])
            if i + 1 < len(ASK):
                time.sleep(pause_s)
    return send


def in_pieces(line, dice):
    at = 0
    while at < len(ASK):
        n = dice.randint(1, 4)
        os.write(line.fd, ASK[at:at + n])
        at += n
        if at < len(ASK):
            time.sleep(dice.uniform(0.001, 0.015))


def after_noise(line, dice):
    os.write(line.fd, dice.randbytes(dice.randint(1, 5)) + ASK)


def between_others(line, dice):
    cut = dice.randint(1, len(INSIDE) - 1)
    os.write(line.fd, frame(9, 3, 0, 0, 0, 6))
    os.write(line.fd, INSIDE[:cut])
    time.sleep(dice.uniform(0.001, 0.012))
    os.write(line.fd, INSIDE[cut:])
    os.write(line.fd, ASK)


def with_echo(line, _):
    os.write(line.fd, ANSWER)  # what the adapter heard of the answer before, then the next request
    os.write(line.fd, ASK)


PATTERNS = {
    "whole": (by_bytes(0), 0), "1 ms a byte": (by_bytes(0.001), 0), "5 ms a byte": (by_bytes(0.005), 0),
    "10 ms a byte": (by_bytes(0.010), 0), "15 ms a byte": (by_bytes(0.015), 0),
    "20 ms a byte, gap 25 ms": (by_bytes(0.020), 0.025), "pieces, 1 to 15 ms apart": (in_pieces, 0),
    "echoes": (with_echo, 0), "behind noise": (after_noise, 0), "between other units": (between_others, 0)}
results = {}


def run(folder, index, name):
    send, gap_s = PATTERNS[name]
    dice = random.Random(index)
    line = Line(folder, f"line{index}", gap_s)
    good, slowest = 0, 0.0
    for _ in range(requests):
        send(line, dice)
        sent = time.monotonic()
        good += line.read(1.0) == ANSWER
        slowest = max(slowest, time.monotonic() - sent)
        extra = line.read(0, 1)
        good -= bool(extra)  # answered twice
    line.close()
    results[name] = good, slowest


with tempfile.TemporaryDirectory() as folder:
    with open(f"{folder}/motion.csv", "w", encoding="ascii") as out:
        out.write("#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z\n")
        out.writelines(f"{i * 10000000},{i * 0.001},0,0,1,0,0,0\n" for i in range(500))
    threads = [threading.Thread(target=run, args=(folder, i, name)) for i, name in enumerate(PATTERNS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

failed = 0
for name in PATTERNS:
    good, slowest = results.get(name, (0, 0))
    failed += good != requests
    print(f"{'ok    ' if good == requests else 'FAILED'} {name}: {good} of {requests} answered, "
          f"the slowest after {slowest * 1000:.0f} ms")
sys.exit(failed > 0)
