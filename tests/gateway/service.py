#!/usr/bin/python3
"""The gateway as a service: exit codes, refusals, signals, reload, systemd's notifications.

usage: tests/gateway/service.py [BUILD]      (make gateway-peers)
Needs nothing but Python and the built programs; reads registers over a plain socket.
"""
import fcntl
import os
import pty
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import tty

build = sys.argv[1] if len(sys.argv) > 1 else "build"
program = f"{build}/fairlead-gateway"
passed = failed = 0


def check(name, good, detail=""):
    global passed, failed
    passed += bool(good)
    failed += not good
    print(f"{'ok    ' if good else 'FAILED'} {name} {'' if good else detail}", flush=True)


def ends(name, arguments, code, text):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, timeout=10)
    check(name, done.returncode == code and text in done.stdout + done.stderr,
          f"{done.returncode} {done.stdout}{done.stderr}")


def read_u32(port, unit, address):
    with socket.create_connection(("127.0.0.1", port), 2) as peer:
        peer.sendall(struct.pack(">HHHBBHH", 1, 0, 6, unit, 3, address, 2))
        answer = peer.recv(64)
    return struct.unpack(">I", answer[9:13])[0] if answer[7] == 3 else -answer[8]


class Running:
    def __init__(self, *arguments, **environment):
        self.process = subprocess.Popen([program, *arguments], stderr=subprocess.PIPE, text=True,
                                        env={**os.environ, **environment})
        self.port = int(re.search(r"port=(\d+)", self.line("ready"))[1])

    def line(self, word):
        for line in self.process.stderr:
            if word in line:
                return line
        raise SystemExit(f"no line with {word}")

    def end(self, number):
        self.process.send_signal(number)
        return self.process.wait(5)


with tempfile.TemporaryDirectory() as folder:
    motion, config = f"{folder}/motion.csv", f"{folder}/gateway.toml"
    with open(motion, "w", encoding="ascii") as out:
        out.write("#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z\n")
        out.writelines(f"{i * 10000000},{i * 0.001},0,0,1,0,0,0\n" for i in range(500))

    def write(*lines):
        with open(config, "w", encoding="ascii") as out:
            out.write("\n".join(lines) + "\n")

    unit = ["[[unit]]", "id = 1", 'source = "replay"', 'file = "motion.csv"']
    ends("wrong flag: 64", ["--nonsense"], 64, "nonsense")
    ends("nothing to serve: 64", [], 64, "nothing to serve")
    ends("no such recording: 66", ["--replay", f"{folder}/none.trk"], 66, "none.trk")
    ends("no such configuration: 78", ["--config", f"{folder}/none.toml"], 78, "cannot be read")
    write(*unit)
    ends("--check of a good one: 0", ["--check", "--config", config], 0, "ok, 1 units")
    write(*unit, "spede = 2")
    ends("--check names the line: 78", ["--check", "--config", config], 78, "gateway.toml:5: unit.spede")
    write(*unit, "[server]", 'listen = ["0.0.0.0:0"]')
    ends("does not leave the machine unasked: 78", ["--config", config], 78, "expose")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        ends("address in use: 69", ["--replay", motion, "--listen",
                                    f"127.0.0.1:{taken.getsockname()[1]}"], 69, "cannot listen")

    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as notify:
        notify.bind(f"{folder}/notify")
        notify.settimeout(3)
        write(*unit, "[server]", 'listen = ["127.0.0.1:0"]')
        gateway = Running("--config", config, NOTIFY_SOCKET=f"{folder}/notify", WATCHDOG_USEC="600000")
        heard = [notify.recv(64).decode() for _ in range(4)]
        check("systemd hears READY=1", heard[0] == "READY=1", heard)
        check("systemd hears WATCHDOG=1", heard.count("WATCHDOG=1") == 3, heard)

        epoch = read_u32(gateway.port, 1, 30)
        check("unit 1 answers, unit 2 is unknown", epoch > 0 and read_u32(gateway.port, 2, 0) == -11)
        second = [line.replace("id = 1", "id = 2") for line in unit]
        write(*unit, *second, "[server]", 'listen = ["127.0.0.1:0"]')
        gateway.process.send_signal(signal.SIGHUP)
        gateway.line("reloaded")
        check("reload: a new unit is served", read_u32(gateway.port, 2, 30) > 0)
        check("reload: what did not change went on", read_u32(gateway.port, 1, 30) == epoch)
        write(*unit, "nonsense = 1")
        gateway.process.send_signal(signal.SIGHUP)
        gateway.line("reload refused")
        check("reload: a wrong file changes nothing", read_u32(gateway.port, 2, 30) > 0)
        check("SIGTERM: 0", gateway.end(signal.SIGTERM) == 0)

    gateway = Running("--replay", motion, "--loop", "--speed", "100", "--listen", "127.0.0.1:0")
    epochs = set()
    for _ in range(8):
        epochs.add(read_u32(gateway.port, 1, 30))
        time.sleep(0.05)
    check("every round of a loop is a run of its own", len(epochs) > 2, epochs)
    check("SIGINT: 0", gateway.end(signal.SIGINT) == 0)

def ask(peer, unit=1, address=30):
    """One register pair on an open connection; the seconds that the answer took."""
    began = time.monotonic()
    peer.sendall(struct.pack(">HHHBBHH", 1, 0, 6, unit, 3, address, 2))
    answer = peer.recv(64)
    return len(answer) == 13, time.monotonic() - began


def descriptors(process):
    return len(os.listdir(f"/proc/{process.pid}/fd"))


def settles(value, wanted, seconds=5):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if value() == wanted:
            return True
        time.sleep(0.02)
    return False


with tempfile.TemporaryDirectory() as folder:
    motion, config = f"{folder}/motion.csv", f"{folder}/gateway.toml"
    with open(motion, "w", encoding="ascii") as out:
        out.write("#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z\n")
        out.writelines(f"{i * 10000000},{i * 0.001},0,0,1,0,0,0\n" for i in range(500))
    unit = ["[[unit]]", "id = 1", 'source = "replay"', 'file = "motion.csv"', "loop = true"]

    def write(*lines):
        with open(config + ".new", "w", encoding="ascii") as out:
            out.write("\n".join(lines) + "\n")
        os.replace(config + ".new", config)

    os.mkfifo(f"{folder}/pipe")
    ends("a pipe as configuration: 78, without waiting", ["--config", f"{folder}/pipe"], 78, "not a regular file")
    ends("a pipe as recording: 66, without waiting", ["--replay", f"{folder}/pipe"], 66, "no such recording")
    write(*unit, "[server]", 'listen = ["0.0.0.0:0"]', "expose = true")
    with subprocess.Popen([program, "--config", config], stderr=subprocess.PIPE, text=True) as done:
        told = done.stderr.readline()
        done.terminate()
    check("listening beyond this machine is warned of", "warning" in told and "0.0.0.0:0" in told, told)

    # -- a log that nobody reads, and one whose reader is gone
    write(*unit, "[server]", 'listen = ["127.0.0.1:0"]')
    gateway = Running("--config", config)
    fcntl.fcntl(gateway.process.stderr, fcntl.F_SETPIPE_SZ, 4096)
    with socket.create_connection(("127.0.0.1", gateway.port), 5) as peer:
        slowest, good = 0, True
        for _ in range(1500):  # a line each; the pipe holds a hundred, the queue 256
            gateway.process.send_signal(signal.SIGHUP)
            answered, seconds = ask(peer)
            good, slowest = good and answered, max(slowest, seconds)
            time.sleep(0.001)
        check("a log that nobody reads delays no client", good and slowest < 0.5, slowest)
        gateway.line("log lines dropped")
        check("and what was dropped is counted once there is room", True)
        gateway.process.stderr.close()
        for _ in range(20):
            gateway.process.send_signal(signal.SIGHUP)
            answered, _ = ask(peer)
            time.sleep(0.01)
        check("a log whose reader is gone ends nothing", answered and gateway.process.poll() is None)
    check("SIGTERM with a broken log: 0", gateway.end(signal.SIGTERM) == 0)

    # -- reloads under a client
    line, device = pty.openpty()
    tty.setraw(line)
    rtu = ["[rtu]", f'device = "{os.ttyname(device)}"']
    write(*unit, *rtu, "[server]", 'listen = ["127.0.0.1:0"]')
    gateway = Running("--config", config)

    def reload(word="reloaded"):
        gateway.process.send_signal(signal.SIGHUP)
        return gateway.line(word)

    with socket.create_connection(("127.0.0.1", gateway.port), 5) as peer, \
            socket.create_server(("127.0.0.1", 0)) as taken:
        epoch = read_u32(gateway.port, 1, 30)
        port = taken.getsockname()[1]
        write(*unit, *rtu, "[server]", f'listen = ["127.0.0.1:0", "127.0.0.1:{port}"]')
        told = reload("reload failed")
        check("reload to a taken port: told, and the client stays", "already in use" in told and ask(peer)[0], told)
        check("... and new clients are served as before", read_u32(gateway.port, 1, 30) == epoch)
        for name, text in {"two bytes": b"[\0", "no UTF-8": b"\xff\xfe[\0", "half a file": b'[[unit]]\nid = "',
                           "a letter where none may be": b"n\xc3\x90"}.items():
            with open(config, "wb") as out:
                out.write(text)
            reload("reload refused")
            check(f"reload of {name}: refused, and the client stays", ask(peer)[0])
        os.remove(config)
        os.mkfifo(config)
        reload("reload refused")
        check("reload of a pipe: refused, and the client stays", ask(peer)[0])
        os.remove(config)
        before = descriptors(gateway.process)
        for i in range(100):
            moved = [f'listen = ["127.0.0.1:0", "127.0.0.{2 + i % 2}:0"]', f"clients = {20 + i % 7}"]
            parity = 'parity = "even"' if i % 2 else 'parity = "none"'
            other = [line_.replace("id = 1", "id = 2") for line_ in unit] + [f"speed = {1 + i % 3}"]
            write(*unit, *other, *rtu, parity, "[server]", *moved)
            reload()
        write(*unit, *rtu, "[server]", 'listen = ["127.0.0.1:0"]')
        reload()
        check("after 100 reloads of everything the client is still connected", ask(peer)[0])
        check("... and what did not change went on in the same run", read_u32(gateway.port, 1, 30) == epoch)
        check("... and no descriptor is left open",
              settles(lambda: descriptors(gateway.process), before),
              f"{before} before, {descriptors(gateway.process)} after")
        write(*unit, *rtu, "[server]", 'listen = ["127.0.0.1:0"]', 'allow = ["10.0.0.0/8"]')
        reload()
        try:
            gone = peer.recv(1) == b""
        except ConnectionResetError:
            gone = True
        check("a client whose network is no longer allowed is let go", gone)
    check("SIGTERM: 0", gateway.end(signal.SIGTERM) == 0)

    # -- systemd's socket, and nobody reads it
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as notify:
        notify.bind(f"{folder}/notify")
        write(*unit, "[server]", 'listen = ["127.0.0.1:0"]')
        gateway = Running("--config", config, NOTIFY_SOCKET=f"{folder}/notify", WATCHDOG_USEC="30000")
        time.sleep(0.6)  # sixty beats; the socket's queue holds ten
        check("a notify socket that nobody reads stops nothing", read_u32(gateway.port, 1, 30) > 0)
        notify.settimeout(0.1)
        check("systemd hears READY=1 first", notify.recv(64) == b"READY=1")
        gateway.end(signal.SIGTERM)

print(f"{passed} passed, {failed} failed, 0 skipped")
sys.exit(failed > 0)
