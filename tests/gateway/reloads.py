#!/usr/bin/python3
"""1,000 reloads of a gateway under a client: half of them good and all different, half of them
mutated bytes. No crash, no lost connection, no descriptor and no memory left behind.

usage: tests/gateway/reloads.py [BUILD [RELOADS]]      (make gateway-measure)
"""
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

build = sys.argv[1] if len(sys.argv) > 1 else "build"
reloads = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
dice = random.Random(20)


def resident_kib(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1])


def descriptors(process):
    return len(os.listdir(f"/proc/{process.pid}/fd"))


def mutated(text):
    data = bytearray(text)
    for _ in range(dice.randint(1, 8)):
        at = dice.randrange(len(data))
        match dice.randint(0, 2):
            case 0: data[at] = dice.randrange(256)
            case 1: data[at:at] = dice.randbytes(dice.randint(1, 4))
            case _: del data[at:at + dice.randint(1, 30)]
    return bytes(data)


with tempfile.TemporaryDirectory() as folder:
    with open(f"{folder}/motion.csv", "w", encoding="ascii") as out:
        out.write("#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z\n")
        out.writelines(f"{i * 10000000},{i * 0.001},0,0,1,0,0,0\n" for i in range(500))
    config = f"{folder}/gateway.toml"

    def text(n):
        return (f'[[unit]]\nid = 1\nsource = "replay"\nfile = "motion.csv"\nloop = true\n'
                f'[[unit]]\nid = {2 + n % 5}\nname = "u{n}"\nsource = "replay"\nfile = "motion.csv"\n'
                f'speed = {1 + n % 9}\n[server]\nlisten = ["127.0.0.1:0", "127.0.0.{2 + n % 3}:0"]\n'
                f'clients = {10 + n % 40}\n').encode()

    def write(data):
        with open(config + ".new", "wb") as out:
            out.write(data)
        os.replace(config + ".new", config)

    write(text(0))
    gateway = subprocess.Popen([f"{build}/fairlead-gateway", "--config", config], stderr=subprocess.PIPE)
    lines, port = {"reloaded": 0, "refused": 0}, None
    ready = threading.Event()

    def listen():
        global port
        last = None
        for line in gateway.stderr:
            if port is None and (found := re.search(rb"ready port=(\d+)", line)):
                port = int(found[1])
                ready.set()
            if b" reloaded " in line and line != last:
                lines["reloaded"] += 1
            if b"reload refused" in line or b"reload failed" in line:
                lines["refused"] += 1
            last = line

    threading.Thread(target=listen, daemon=True).start()
    ready.wait(10)
    peer = socket.create_connection(("127.0.0.1", port), 5)

    def ask():
        peer.sendall(struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 30, 2))
        return peer.recv(64)

    epoch, before, warm, slowest = ask(), descriptors(gateway), 0, 0.0
    for n in range(1, reloads + 1):
        write(text(n) if n % 2 else mutated(text(n)))
        told = sum(lines.values())
        gateway.send_signal(signal.SIGHUP)
        end = time.monotonic() + 5
        while sum(lines.values()) == told and time.monotonic() < end:
            began = time.monotonic()
            ask()
            slowest = max(slowest, time.monotonic() - began)
            time.sleep(0.002)
        if gateway.poll() is not None:
            raise SystemExit(f"FAILED the gateway ended with {gateway.returncode} at reload {n}")
        if n == reloads // 5:
            warm = resident_kib(gateway)
    write(text(0))
    gateway.send_signal(signal.SIGHUP)
    time.sleep(2)
    after, memory = descriptors(gateway), resident_kib(gateway)
    alive = len(ask()) == 13
    same = True
    peer.close()
    gateway.terminate()
    code = gateway.wait(5)
good = alive and after == before and code == 0 and memory <= warm * 1.2 + 2048
print(f"{'ok    ' if good else 'FAILED'} {reloads} reloads ({lines['refused']} refused): one connection throughout, "
      f"its slowest answer after {slowest * 1000:.0f} ms; descriptors {before} before, {after} after; "
      f"resident {warm} KiB after a fifth, {memory} KiB at the end")
sys.exit(not good)
