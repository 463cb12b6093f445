#!/usr/bin/env python3
"""usage: tests/gateway/firmware/run.py BUILD   Two machines in one: the Cortex-M4F image of examples/firmware under
QEMU, its UART on a pseudo-terminal, fairlead-gateway at the other end, fairlead-poll as the client. What the client
rebuilds is held to what the board measured, and to what its filter made of it."""
import os, re, subprocess, sys, time, tty

build = sys.argv[1]
work = os.path.join(build, "firmware-run")
os.makedirs(work, exist_ok=True)
failed = 0


def check(good, name, figure=""):
    global failed
    failed += not good
    print("ok" if good else "FAIL", "firmware." + name, figure)


def poll(port, like, tolerance_m, tolerance_deg, seconds):
    return subprocess.Popen(
        [f"{build}/fairlead-poll", "127.0.0.1", "--port", port, "--every", "0.5", "--seconds", str(seconds), "--like",
         f"{work}/{like}.csv", "--tolerance-m", str(tolerance_m), "--tolerance-deg", str(tolerance_deg), "--out",
         f"{work}/{like}.tum"], stdout=subprocess.PIPE, text=True)


subprocess.run([f"{build}/firmware-motion", work], check=True)
board, device = os.openpty()
tty.setraw(device)
gateway = subprocess.Popen([f"{build}/fairlead-gateway", "--serial", os.ttyname(device), "--listen", "127.0.0.1:0"],
                           stderr=subprocess.PIPE, text=True)
port = re.search(r"ready port=(\d+)", gateway.stderr.readline()).group(1)
gateway.stderr.readline()  # line opened
# on the host's clock: a second there is a second here
machine = subprocess.Popen(
    ["qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=3,sleep=on", "-nographic", "-monitor", "none", "-serial",
     "stdio", "-semihosting-config", "enable=on,target=native", "-kernel", f"{build}/target/firmware/firmware.elf"],
    stdin=subprocess.DEVNULL, stdout=board, stderr=subprocess.DEVNULL)
# the reducer's own tolerance against what it was given; beside it, per axis, what the filter takes off the motion
polls = {"filtered": poll(port, "filtered", 0.002, 0.5, 30), "motion": poll(port, "motion", 0.0036, 0.6, 30)}
try:
    ended = machine.wait(timeout=60)
except subprocess.TimeoutExpired:
    machine.kill()
    ended = "no end"
check(ended == 0, "ran-to-its-end", ended)
for like, process in polls.items():
    text = process.communicate(timeout=60)[0]
    rows = int(re.search(r"rows (\d+)", text).group(1))
    lost = int(re.search(r"lost spans (\d+)", text).group(1))
    check(process.returncode == 0 and lost == 0, f"every-sample-within-tolerance.{like}", text.splitlines()[-1])
    check(rows == 1200, f"every-sample-covered.{like}", rows)
gateway.terminate()
check(gateway.wait(timeout=10) == 0, "gateway-stopped")
sys.exit(failed > 0)
