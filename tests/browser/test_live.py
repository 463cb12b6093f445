#!/usr/bin/python3
"""The live view in a real browser: a replay, a unit of a gateway, and the firmware image under QEMU on a serial line."""
import contextlib
import http.client
import json
import math
import os
import re
import shutil
import socket
import subprocess
import time
import tty

from browser import BUILD, Browser, main, sim

MOTION = "model:optical+rest:1+" + "+".join(["oscillate:20:0.7:0.2:0.6"] * 3)


class Live:
    """fairlead-live with its page's address; ended with the test."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen([BUILD / "fairlead-live", "--port", "0", *map(str, arguments)],
                                        stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        assert self.url.startswith("http://127.0.0.1:"), self.url
        self.port = int(re.search(r":(\d+)/", self.url).group(1))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        assert self.process.wait(timeout=10) == 0


def replayed(folder):
    sim("generate", MOTION, "--seed", 2, "--out", folder / "in.trk")
    return folder / "in.trk"


def watch(page, url, shot):
    """The page opens without errors, its body moves, its charts run, its figures count."""
    page.driver.get(url)
    page.until("document.documentElement.dataset.ready && live.newest && live.newest.sequence > 0", "values come in")
    page.until("live.rows.rate.some((r) => Math.hypot(r[1], r[2], r[3]) > 5)", "the body moves", 60)
    first = page.run("return [live.view.solid.quaternion.toArray(), live.graphs.rotation.xAxisRange()[1],"
                     " live.graphs.rotation.numRows()]")
    time.sleep(2.5)
    then = page.run("return [live.view.solid.quaternion.toArray(), live.graphs.rotation.xAxisRange()[1],"
                    " live.graphs.rotation.numRows()]")
    assert then[0] != first[0], "the body stands still"
    assert then[1] > first[1] + 1 and then[2] > first[2] + 20, (first, then)
    rate = page.run("return document.getElementById('rate').textContent")
    assert int(rate) > 3, rate
    assert page.run("return document.getElementById('state').textContent") in ("moving", "at rest", "settling")
    assert page.errors() == [], page.errors()
    page.shot(shot)


def test_a_replay(folder):
    with Live("--replay", replayed(folder), "--loop") as live, Browser(folder) as page:
        watch(page, live.url, "live_replay")


@contextlib.contextmanager
def running_gateway(*arguments):
    """The port of a gateway that ends with the test."""
    gateway = subprocess.Popen([BUILD / "fairlead-gateway", "--listen", "127.0.0.1:0", *map(str, arguments)],
                               stderr=subprocess.PIPE, text=True)
    try:
        yield re.search(r"ready port=(\d+)", gateway.stderr.readline()).group(1)
    finally:
        gateway.terminate()
        assert gateway.wait(timeout=10) == 0


def test_a_unit_of_a_gateway(folder):
    """It runs beside the gateway: other clients are served all the while."""
    with running_gateway("--replay", replayed(folder), "--loop") as port:
        with Live("--gateway", f"127.0.0.1:{port}") as live, Browser(folder) as page:
            watch(page, live.url, "live_gateway")
            polled = subprocess.run([BUILD / "fairlead-poll", "127.0.0.1", "--port", port, "--seconds", "2", "--every", "0.2"],
                                    capture_output=True, text=True, timeout=20, check=False)
            assert polled.returncode == 0 and "lost spans 0," in polled.stdout, polled
            assert page.run("return live.newest.status >> 9 & 1") == 0, "the live view lost the gateway"


def calibration_motion(path):
    """A board that lies on its six faces and is then turned through all directions, as text of an IMU."""
    step, g = 0.01, 9.80665
    faces = [(0, 0, 1), (0, 1, 0), (0, 0, -1), (0, -1, 0), (1, 0, 0), (-1, 0, 0)]
    rows, t = ["t [s],gx [rad/s],gy,gz,ax [m/s2],ay,az,mx [uT],my,mz"], 0.0
    def row(rate, up):
        nonlocal t
        wave = 1e-3 * math.sin(50 * t)
        field = [44 * u + h for u, h in zip(up, (30, -20, 12))]
        rows.append(",".join(f"{v:.9g}" for v in (
            t, *(r + o + wave for r, o in zip(rate, (0.02, -0.01, 0.03))), *(g * u + wave for u in up), *field)))
        t += step
    for face in faces:
        for _ in range(250):
            row((0, 0, 0), face)
        for _ in range(20):
            row((1, 1, 1), face)
    for i in range(3000):  # a spiral over the sphere
        z, a = math.cos(math.pi * i / 3000), 0.05 * i
        r = math.sqrt(max(0.0, 1 - z * z))
        row((1, 2, 1), (r * math.cos(a), r * math.sin(a), z))
    path.write_text("\n".join(rows) + "\n", encoding="ascii")
    return path


def expect_progress(port):
    """From the first values to the last, all three rise, and are done at 100 percent."""
    connection, response = ask(port, "GET", "/values")
    seen = []
    while not seen or seen[-1]["done"] < 7:
        line = response.readline()
        assert line, "the stream ended"
        if line.startswith(b"data: "):
            seen.append(json.loads(line[6:]))
    connection.close()
    faces = [bin(v["accel_faces"]).count("1") for v in seen]
    for course in (faces, [v["gyro_percent"] for v in seen], [v["mag_percent"] for v in seen]):
        assert course == sorted(course) and len(set(course)) > 3, course
    assert all((v["done"] & 4 > 0) == (v["mag_percent"] == 100) for v in seen)


def watch_calibration(page, live, folder):
    """All is done in the end, and the gateway takes what was found."""
    page.driver.get(live.url)
    page.until("document.documentElement.dataset.ready && live.newest && live.newest.sequence > 0", "values come in")
    assert page.run("return document.getElementById('calibration-section').hidden") is False
    page.until("live.newest.done === 7 && document.getElementById('calibration-mag').value === 100", "all is done", 60)
    page.until("document.getElementById('found').textContent.includes('mag_matrix')", "what was found is shown")
    page.shot("live_calibration")
    found = page.run("return document.getElementById('found').textContent")
    offset = [float(x) for x in re.search(r"mag_offset_uT = \[(.*)\]", found).group(1).split(",")]
    assert all(abs(a - b) < 1 for a, b in zip(offset, (30, -20, 12))), offset
    (folder / "found.toml").write_text(found, encoding="utf-8")
    (folder / "gateway.toml").write_text(
        '[server]\nlisten = ["127.0.0.1:0"]\n[[unit]]\nid = 1\nname = "board"\nsource = "sensor"\nsensor = "lsm6dso"\nbus = 1\n'
        'chip = "/dev/gpiochip0"\nline = 17\ncalibration = "found.toml"\n', encoding="utf-8")
    checked = subprocess.run([BUILD / "fairlead-gateway", "--check", "--config", folder / "gateway.toml"],
                             capture_output=True, text=True, timeout=10, check=False)
    assert checked.returncode == 0, checked.stderr
    assert page.errors() == [], page.errors()


def test_the_progress_of_a_calibration(folder):
    motion = calibration_motion(folder / "calibration.csv")
    with Live("--replay", motion, "--speed", 4) as live:
        expect_progress(live.port)
        with Browser(folder) as page:
            watch_calibration(page, live, folder)


def test_the_progress_of_a_calibration_through_a_gateway(folder):
    motion = calibration_motion(folder / "calibration.csv")
    with running_gateway("--replay", motion, "--speed", 4) as port:
        with Live("--gateway", f"127.0.0.1:{port}") as live:
            expect_progress(live.port)
            with Browser(folder) as page:
                watch_calibration(page, live, folder)


def test_the_firmware_on_a_serial_line(folder):
    image = BUILD / "target/firmware/firmware.elf"
    assert image.exists() and shutil.which("qemu-system-arm"), "the firmware image, or QEMU, is not there"
    board, device = os.openpty()
    tty.setraw(device)
    with Live("--serial", os.ttyname(device)) as live:
        machine = subprocess.Popen(
            ["qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=3,sleep=on", "-nographic", "-monitor", "none",
             "-serial", "stdio", "-semihosting-config", "enable=on,target=native", "-kernel", image],
            stdin=subprocess.DEVNULL, stdout=board, stderr=subprocess.DEVNULL)
        try:
            with Browser(folder) as page:
                watch(page, live.url, "live_firmware")
        finally:
            machine.kill()
            machine.wait()


def ask(port, method, path, headers=None):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    connection.request(method, path, headers=headers or {})
    return connection, connection.getresponse()


def test_it_is_read_only_and_for_this_machine(folder):
    with Live("--replay", replayed(folder), "--loop") as live:
        for method in ("POST", "PUT", "DELETE"):
            for path in ("/", "/values", "/anything"):
                connection, response = ask(live.port, method, path)
                assert response.status in (400, 404, 405), (method, path, response.status)
                connection.close()
        connection, response = ask(live.port, "GET", "/", {"Host": "evil.example"})
        assert response.status == 403, response.status
        connection.close()
    refused = subprocess.run([BUILD / "fairlead-live", "--replay", replayed(folder), "--bind", "0.0.0.0"],
                             capture_output=True, text=True, timeout=10, check=False)
    assert refused.returncode == 64 and "--expose" in refused.stderr, refused


def test_sixteen_viewers_and_no_more(folder):
    with Live("--replay", replayed(folder), "--loop") as live:
        open_ones = [ask(live.port, "GET", "/values") for _ in range(16)]
        for _, response in open_ones:
            assert response.status == 200 and response.readline().startswith(b"data: {")
        connection, response = ask(live.port, "GET", "/values")
        assert response.status == 503, response.status
        connection.close()
        open_ones.pop()[0].close()
        end = time.monotonic() + 10
        while time.monotonic() < end:  # the place is free again
            connection, response = ask(live.port, "GET", "/values")
            connection.close()
            if response.status == 200:
                break
            time.sleep(0.2)
        assert response.status == 200
        # fourteen that do not read hold up nobody
        start, seen = time.monotonic(), 0
        while time.monotonic() < start + 2:
            seen += open_ones[0][1].readline().startswith(b"data: {")
        assert seen > 20, seen


def test_a_viewer_that_sleeps_is_dropped(folder):
    """It takes no byte: its place is free as soon as the kernel's buffers are full for five seconds."""
    with Live("--replay", replayed(folder), "--loop") as live:
        sleepers = []
        for _ in range(16):
            sleeper = socket.socket()
            sleeper.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
            sleeper.connect(("127.0.0.1", live.port))
            sleeper.sendall(b"GET /values HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            assert sleeper.recv(12) == b"HTTP/1.1 200", "a place"
            sleepers.append(sleeper)
        connection, response = ask(live.port, "GET", "/values")
        assert response.status == 503, response.status
        connection.close()
        start, status = time.monotonic(), 503
        while status != 200 and time.monotonic() < start + 60:
            time.sleep(0.5)
            connection, response = ask(live.port, "GET", "/values")
            status = response.status
            if status == 200:
                assert response.readline().startswith(b"data: {"), "a new viewer is served"
            connection.close()
        waited = time.monotonic() - start
        assert status == 200, "nobody was dropped"
        assert waited > 3, f"dropped after {waited:.1f} s: that is no patience"
        print(f"dropped after {waited:.0f} s")
        for sleeper in sleepers:
            sleeper.close()


if __name__ == "__main__":
    main()
