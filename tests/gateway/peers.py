#!/usr/bin/python3
"""Other people's clients against the gateway: every field of the map, over TCP and RTU.

usage: tests/gateway/peers.py [BUILD]      (make gateway-peers)
Peers: mbpoll, python3-pymodbus, the npm package modbus-serial, libmodbus's own client
(fairlead-poll). A peer that is not installed is told as skipped.
"""
import json
import math
import os
import pty
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import tty

build = sys.argv[1] if len(sys.argv) > 1 else "build"
passed = failed = skipped = 0


def check(name, good, detail=""):
    global passed, failed
    passed += bool(good)
    failed += not good
    print(f"{'ok    ' if good else 'FAILED'} {name} {'' if good else detail}", flush=True)


def skip(name, why):
    global skipped
    skipped += 1
    print(f"skipped {name}: {why}", flush=True)


def fields():
    """Address, type and name of every field, from the generated manual."""
    rows = []
    for line in open("docs/registers.md", encoding="utf-8"):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("## Bits"):
            break
        if len(cells) == 6 and cells[0].isdigit():
            rows.append((int(cells[0]), int(cells[1]), cells[2], cells[3].strip("`")))
    return rows


SHAPES = {"uint16": ">H", "uint32": ">I", "uint64": ">Q", "int64": ">q", "float32": ">f"}


def decode(kind, registers):
    data = struct.pack(f">{len(registers)}H", *registers)
    return data.rstrip(b"\0").decode() if kind == "text16" else struct.unpack(SHAPES[kind], data)[0]


def make_recording(path):
    """A tracker's recording of eight seconds at 100 Hz, in the simulator's pose CSV (EuRoC)."""
    poses = []
    with open(path, "w", encoding="ascii") as out:
        out.write("#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z\n")
        for i in range(800):
            a = 0.8 * math.sin(i * 0.02)
            pose = (math.sin(i * 0.013), 0.5 * math.cos(i * 0.021), 1.0, math.cos(a), 0.0,
                    math.sin(a), 0.0)
            poses.append(pose)
            out.write(f"{1000000000 + i * 10000000}," + ",".join(f"{v:.9f}" for v in pose) + "\n")
    return poses


class Gateway:
    def __init__(self, *arguments):
        self.process = subprocess.Popen([f"{build}/fairlead-gateway", *arguments],
                                        stderr=subprocess.PIPE, text=True)
        for line in self.process.stderr:
            found = re.search(r"ready port=(\d+)", line)
            if found:
                self.port = int(found[1])
                return
        raise SystemExit("the gateway did not start")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        check("the gateway ends with 0", self.process.wait(5) == 0)


def check_values(peer, values, poses):
    """What any client must have read of a finished replay."""
    last = poses[-1]
    expected = {"magic": 0x464C4431, "probe.f32": 1.0, "probe.u32": 0x01020304,
                "probe.u64": 0x0102030405060708, "unit.id": 1, "unit.name": "replay",
                "health.samples": len(poses)}
    for name, value in expected.items():
        if name in values:
            check(f"{peer}: {name}", values[name] == value, f"{values[name]} != {value}")
    for name, value in zip(("p_x", "p_y", "p_z", "q_w", "q_x", "q_y", "q_z"), last):
        got = values["live." + name]
        check(f"{peer}: live.{name}", abs(got - value) < 1e-6, f"{got} != {value}")
    stale = 1 << 2
    check(f"{peer}: live.status", int(values["live.status"]) & ~stale == 3 | 1 << 11,
          str(values["live.status"]))
    check(f"{peer}: sequence", values["live.seq_begin"] == values["live.seq_end"] == len(poses))


def peer_mbpoll(port, poses):
    if not shutil.which("mbpoll"):
        return skip("mbpoll", "not installed")
    out = subprocess.run(["sh", "examples/gateway/clients/mbpoll.sh", "127.0.0.1", str(port)],
                         capture_output=True, text=True, check=True).stdout
    values, name = {}, ""
    for line in out.splitlines():
        found = re.match(r"\[\d+\]:\s+(\S+)", line)
        if not found:
            name = line.strip()
        elif found[1].startswith("0x"):
            values[name] = values.get(name, 0) << 16 | int(found[1], 16)
        else:
            values[name] = float(found[1])
    values["unit.name"] = struct.pack(">QQ", values["unit.name"] >> 64,
                                      values["unit.name"] & (1 << 64) - 1).rstrip(b"\0").decode()
    check("mbpoll: every field answered", len(values) == len(fields()),
          f"{len(values)} of {len(fields())}")
    return check_values("mbpoll", values, poses)


def read_all(read):
    return {name: decode(kind, read(address, count)) for address, count, kind, name in fields()}


def peer_pymodbus(port, poses):
    try:
        from pymodbus.client import ModbusTcpClient
    except ImportError:
        return skip("pymodbus", "not installed")
    client = ModbusTcpClient("127.0.0.1", port=port)
    for function in ("read_holding_registers", "read_input_registers"):
        def read(address, count):
            return getattr(client, function)(address, count, slave=1).registers
        check_values(f"pymodbus {function}", read_all(read), poses)
    for name, answer, code in (
            ("write", client.write_register(32, 1, slave=1), 1),
            ("write many", client.write_registers(32, [1, 2], slave=1), 1),
            ("coils", client.read_coils(0, 1, slave=1), 1),
            ("beyond the map", client.read_holding_registers(33000, 1, slave=1), 2),
            ("unknown unit", client.read_holding_registers(0, 1, slave=9), 11)):
        check(f"pymodbus: {name} gives exception {code}",
              answer.isError() and answer.exception_code == code, str(answer))
    return client.close()


NODE = """
const Modbus = require('modbus-serial'), client = new Modbus();
const fields = JSON.parse(process.argv[2]), out = {};
(async () => {
  await client.connectTCP('127.0.0.1', { port: Number(process.argv[1]) });
  client.setID(1);
  for (const [address, count, kind, name] of fields)
    out[name] = (await client.readHoldingRegisters(address, count)).data;
  try { await client.writeRegister(32, 1); out.written = true; }
  catch (e) { out.code = e.modbusCode; }
  console.log(JSON.stringify(out));
  client.close(() => process.exit(0));
})();
"""


def peer_node(port, poses):
    folder = os.path.abspath(f"{build}/npm")
    if not shutil.which("npm"):
        return skip("modbus-serial", "no npm")
    if not os.path.isdir(f"{folder}/node_modules/modbus-serial"):
        os.makedirs(folder, exist_ok=True)
        got = subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--ignore-scripts",
                              "--prefix", folder, "modbus-serial@8"], capture_output=True, text=True)
        if got.returncode != 0:
            return skip("modbus-serial", "npm could not install it")
    out = subprocess.run(["node", "-e", NODE, str(port), json.dumps(fields())], cwd=folder,
                         capture_output=True, text=True, timeout=60)
    if out.returncode != 0:
        return check("modbus-serial", False, out.stderr)
    raw = json.loads(out.stdout)
    check("modbus-serial: write gives exception 1", raw.pop("code", 0) == 1 and "written" not in raw)
    values = {name: decode(kind, raw[name]) for _, _, kind, name in fields()}
    return check_values("modbus-serial", values, poses)


def peer_libmodbus(port, recording):
    done = subprocess.run([f"{build}/fairlead-poll", "-p", str(port), "--like", recording,
                           "--tolerance-m", "0.001", "--tolerance-deg", "0.25"],
                          capture_output=True, text=True, timeout=60)
    check("libmodbus (fairlead-poll): every sample within tolerance", done.returncode == 0,
          done.stdout + done.stderr)
    check("libmodbus (fairlead-poll): every sample covered", "rows 800," in done.stdout, done.stdout)


def example_python(port, poses):
    done = subprocess.run([sys.executable, "examples/gateway/poll.py", "127.0.0.1", str(port), "1",
                           "1.5"], capture_output=True, text=True, timeout=60)
    rows = [line.split(",") for line in done.stdout.splitlines()[1:]]
    worst = 0.0
    for t, *q in rows:
        i = round((float(t) - 1) * 100)
        if abs(float(t) - 1 - i / 100) < 1e-6 and i < len(poses):
            sides = [[float(a) - s * b for a, b in zip(q, poses[i][3:])] for s in (1, -1)]
            chord = min(math.hypot(*side) for side in sides)  # acos would lose the digits
            worst = max(worst, math.degrees(4 * math.asin(chord / 2)))
    check("poll.py: the curve within tolerance", len(rows) > 500 and worst < 0.26,
          f"{len(rows)} rows, {worst} deg {done.stderr}")


def peers_rtu(recording, poses):
    """Two pseudo-terminals joined by hand, as a null modem: one for the gateway, one for a client.

    Without parity: a pseudo-terminal has none, and pyserial insists."""
    (a, a_name), (b, b_name) = ((m, os.ttyname(s)) for m, s in (pty.openpty(), pty.openpty()))
    for end in (a, b):
        tty.setraw(end)
    joint = os.fork()
    if joint == 0:
        import select
        while True:
            for fd in select.select([a, b], [], [])[0]:
                os.write(b if fd == a else a, os.read(fd, 1024))
    try:
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as config:
            config.write(f'[server]\nlisten = ["127.0.0.1:0"]\n[rtu]\ndevice = "{a_name}"\n'
                         f'parity = "none"\n'
                         f'[[unit]]\nid = 1\nname = "replay"\nsource = "replay"\n'
                         f'file = "{recording}"\nspeed = 100\n')
            config.flush()
            with Gateway("--config", config.name):
                time.sleep(1)
                if shutil.which("mbpoll"):
                    out = subprocess.run(["mbpoll", "-m", "rtu", "-a", "1", "-b", "19200", "-P",
                                          "none", "-0", "-B", "-1", "-r", "20", "-c", "1", "-t",
                                          "4:float", b_name], capture_output=True, text=True).stdout
                    check("mbpoll RTU: probe.f32", re.search(r"\[20\]:\s+1\b", out), out)
                else:
                    skip("mbpoll RTU", "not installed")
                try:
                    from pymodbus.client import ModbusSerialClient
                    client = ModbusSerialClient(b_name, baudrate=19200, timeout=2)
                    values = read_all(lambda address, count: client.read_holding_registers(
                        address, count, slave=1).registers)
                    check_values("pymodbus RTU", values, poses)
                    client.close()
                except (ImportError, RuntimeError) as error:
                    skip("pymodbus RTU", str(error))
    finally:
        os.kill(joint, 15)
        os.waitpid(joint, 0)


with tempfile.TemporaryDirectory() as folder:
    motion = f"{folder}/motion.csv"
    truth = make_recording(motion)
    with Gateway("--replay", motion, "--speed", "100", "--listen", "127.0.0.1:0") as gateway:
        time.sleep(1)
        peer_mbpoll(gateway.port, truth)
        peer_pymodbus(gateway.port, truth)
        peer_node(gateway.port, truth)
        peer_libmodbus(gateway.port, motion)
        example_python(gateway.port, truth)
    peers_rtu(motion, truth)

print(f"{passed} passed, {failed} failed, {skipped} skipped")
sys.exit(failed > 0)
