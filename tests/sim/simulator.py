"""What the tests of the host simulator share: running it, reading its files, reporting results."""
import csv
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("BUILD", "build")) / "fairlead-sim"
RECORDINGS = ROOT / ".." / "shared" / "recordings"


def run(*arguments):
    """Exit code, stdout, stderr of fairlead-sim."""
    done = subprocess.run([ROOT / PROGRAM, *map(str, arguments)], capture_output=True, text=True,
                          timeout=300, check=False)
    return done.returncode, done.stdout, done.stderr


def must(*arguments):
    code, out, err = run(*arguments)
    if code != 0:
        raise AssertionError(f"{' '.join(map(str, arguments))}: exit {code}: {err}")
    return out


def read_trk(path):
    """Records (t_ns, position or None, quaternion or None), by the layout in docs/formats.md."""
    data = pathlib.Path(path).read_bytes()
    magic, version, n, size = struct.unpack_from("<4sIII", data)
    assert magic == b"TRK1" and version == 1 and size == 36 and len(data) == 64 + 36 * n
    records = []
    for i in range(n):
        t_us, valid, *v = struct.unpack_from("<II7f", data, 64 + 36 * i)
        records.append((t_us * 1000, v[:3] if valid & 2 else None, v[3:] if valid & 1 else None))
    return records


def read_csv(path):
    """Rows of a pose CSV: (t_ns, position or None, quaternion or None) and the fields as text."""
    with open(path, newline="", encoding="ascii") as file:
        rows = list(csv.reader(file))
    assert rows[0] == "t_ns,px,py,pz,qw,qx,qy,qz".split(","), rows[0]
    records = []
    for row in rows[1:]:
        assert len(row) == 8, row
        p = [float(x) for x in row[1:4]] if row[1] else None
        q = [float(x) for x in row[4:8]] if row[4] else None
        records.append((int(row[0]), p, q, row))
    return records


def axis_distance(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


def rotation_angle(a, b):
    """Full angle of conj(a) b, well conditioned near zero."""
    w = sum(x * y for x, y in zip(a, b))
    x = a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2]
    y = a[0] * b[2] - a[2] * b[0] - a[3] * b[1] + a[1] * b[3]
    z = a[0] * b[3] - a[3] * b[0] - a[1] * b[2] + a[2] * b[1]
    return 2 * math.atan2(math.sqrt(x * x + y * y + z * z), abs(w))


class Suite:
    """Runs functions named test_*; prints a line each, as tests/run wants them."""

    def __init__(self, module):
        self.tests = [(k, v) for k, v in vars(module).items() if k.startswith("test_")]

    def run(self):
        failed = 0
        for name, test in self.tests:
            with tempfile.TemporaryDirectory(prefix="fairlead-") as folder:
                try:
                    why = test(pathlib.Path(folder))
                    print(f"skipped {name}: {why}" if why else f"ok {name}", flush=True)
                except Exception as error:  # noqa: BLE001: any error of a test is its failure
                    failed += 1
                    print(f"FAIL {name}: {type(error).__name__}: {error}", flush=True)
        return failed


def main():
    sys.exit(1 if Suite(sys.modules["__main__"]).run() else 0)
