#!/usr/bin/env python3
"""The second decoder (tests/ref/stream_decoder.py, written from docs/stream.md) on the golden streams."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/ref"))
import stream_decoder  # noqa: E402


def lines_of(path):
    lines = []
    stream_decoder.Decoder(lines.append).read(path.read_bytes())
    return lines


def by_kind(lines):
    """Pieces and events keep their order among themselves; a reader out of step may tell events earlier."""
    return {kind: [line for line in lines if line.startswith(kind)] for kind in ("run", "piece", "event")}


def main():
    failed, pieces = 0, 0
    streams = sorted((ROOT / f"tests/golden/v{stream_decoder.VERSION}").glob("*.bin"))
    for path in streams:
        told, expected = by_kind(lines_of(path)), by_kind(path.with_suffix(".txt").read_text().splitlines())
        pieces += len(expected["piece"])
        if told != expected:
            failed += 1
            print(f"FAIL {path.name}: the second decoder reads another stream")
    if len(streams) < 7 or pieces < 3000:
        sys.exit(f"FAIL only {len(streams)} golden streams, {pieces} pieces")
    print(f"{'FAIL' if failed else 'ok'} test_stream: {len(streams)} streams, {pieces} pieces")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
