#!/usr/bin/env python3
"""The decoders in Python (tests/ref/stream_decoder.py, written from docs/stream.md) and in JavaScript
(host_sim/report/stream_decoder.js) on the golden streams."""
import pathlib
import shutil
import subprocess
import sys
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/ref"))
import stream_decoder  # noqa: E402


def lines_of(path):
    lines = []
    stream_decoder.Decoder(lines.append).read(path.read_bytes())
    return lines


def lines_of_javascript(path):
    done = subprocess.run(["node", ROOT / "tests/sim/list_stream.js", path], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def by_kind(lines):
    """Pieces and events keep their order among themselves; a reader out of step may tell events earlier."""
    return {kind: [line for line in lines if line.startswith(kind)] for kind in ("run", "piece", "cubic", "event")}


def check(name, read):
    streams = sorted((ROOT / f"tests/golden/v{stream_decoder.VERSION}").glob("*.bin"))
    pieces, failed = 0, False
    for path in streams:
        told, expected = by_kind(read(path)), by_kind(path.with_suffix(".txt").read_text().splitlines())
        pieces += len(expected["piece"])
        if told != expected:
            failed = True
            wrong = next((a, b) for kind in told for a, b in zip(told[kind] + [None], expected[kind] + [None]) if a != b)
            print(f"  {path.name}: {wrong[0]}\n  instead of  {wrong[1]}")
    if len(streams) < 7 or pieces < 3000:
        failed = True
        print(f"  only {len(streams)} golden streams, {pieces} pieces")
    print(f"{'FAIL' if failed else 'ok'} test_stream {name}: {len(streams)} streams, {pieces} pieces")
    return failed


def check_joins():
    """A reader whose header tells where a run goes on, and not that it begins, waits for a restart frame."""
    failed, pieces = False, 0
    for path in sorted((ROOT / f"tests/golden/v{stream_decoder.VERSION}").glob("*.bin")):
        data, told = path.read_bytes(), set(lines_of(path))
        size = data[1] + 6
        head = data[:size - 5] + bytes([data[size - 5] & ~1])
        lines = []
        stream_decoder.Decoder(lines.append).read(head + zlib.crc32(head).to_bytes(4, "little") + data[size:])
        failed |= not set(lines) <= told
        pieces += len(lines)
    failed |= pieces < 1000
    print(f"{'FAIL' if failed else 'ok'} test_stream joins: {pieces} lines")
    return failed


def main():
    failed = check("python", lines_of)
    failed |= check_joins()
    if shutil.which("node"):
        failed |= check("javascript", lines_of_javascript)
    else:
        print("skipped test_stream javascript: node is not installed")
    sys.exit(failed)


if __name__ == "__main__":
    main()
