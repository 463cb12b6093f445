#!/usr/bin/python3
"""The live view in a real browser: a replay, a unit of a gateway, and the firmware image under QEMU on a serial line."""
import http.client
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


def test_a_unit_of_a_gateway(folder):
    gateway = subprocess.Popen([BUILD / "fairlead-gateway", "--replay", replayed(folder), "--loop", "--listen", "127.0.0.1:0"],
                               stderr=subprocess.PIPE, text=True)
    try:
        port = re.search(r"ready port=(\d+)", gateway.stderr.readline()).group(1)
        with Live("--gateway", f"127.0.0.1:{port}") as live, Browser(folder) as page:
            watch(page, live.url, "live_gateway")
    finally:
        gateway.terminate()
        gateway.wait(timeout=10)


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
