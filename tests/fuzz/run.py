#!/usr/bin/python3
"""Runs fuzz targets: first the committed corpus, then new inputs for a given time, one process a core. What is found is
kept in build/fuzz/findings and said; the exit code is 1 where anything was found, or where a target hardly ran.

    tests/fuzz/run.py BUILD --seconds 60 [--executions 1000000] [--executions-min 1000] [--keep] [TARGET ...]

--executions ends a target after so many, --seconds after that time, whichever comes first.
--keep adds inputs that reach new code to tests/fuzz/corpus, minimised: the way to renew the committed corpus."""
import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
LENGTH = {"modbus_adu": 400, "attitude": 600, "config": 1500}  # longest input, bytes; others 1000
SEEDS = {"config": HERE.parents[1] / "examples/gateway/gateway.toml"}  # a file of the tree to begin with; NAME.dict: words


def bare(text):
    """A configuration without its comments; what a comment holds of it counts."""
    lines = [re.sub(r"^# (?=\[|\w+ = )", "", line).split(" #")[0].strip() for line in text.splitlines()]
    return "".join(f"{line}\n" for line in lines if line and not line.startswith("#"))


def targets():
    return sorted(p.stem for p in HERE.glob("*.cpp"))


def fuzz(build, target, seconds, executions, seed):
    program = build / "fuzz" / target
    found, work = build / "fuzz/findings", build / "fuzz/work" / target
    corpus = HERE / "corpus" / target
    for folder in (found, work):
        folder.mkdir(parents=True, exist_ok=True)
    if target in SEEDS:
        (work / "seed").write_text(bare(SEEDS[target].read_text(encoding="utf-8")), encoding="utf-8")
    words = HERE / f"{target}.dict"
    start = time.monotonic()
    command = [program, *([f"-dict={words}"] if words.is_file() else []), f"-max_total_time={seconds}", f"-seed={seed}",
               f"-max_len={LENGTH.get(target, 1000)}", f"-runs={executions or -1}", "-timeout=20",
               "-rss_limit_mb=2000", "-print_final_stats=1", f"-artifact_prefix={found}/{target}-", work]
    done = subprocess.run(command + ([corpus] if corpus.is_dir() else []), capture_output=True, text=True, errors="replace",
                          timeout=seconds * 4 + 120, check=False)
    said = done.stderr
    executions = re.search(r"number_of_executed_units: (\d+)", said)
    covered = re.findall(r" cov: (\d+) ", said)
    return {"target": target, "code": done.returncode, "said": said, "seconds": time.monotonic() - start,
            "executions": int(executions.group(1)) if executions else 0, "edges": int(covered[-1]) if covered else 0}


CORPUS_MAX = 100  # inputs of a target that are committed: every nth of what covers most


def keep(build, target):
    """Merges what was found into the committed corpus: an even choice of the inputs that cover the same."""
    corpus = HERE / "corpus" / target
    merged = build / "fuzz/merged" / target
    for folder in (corpus, merged):
        folder.mkdir(parents=True, exist_ok=True)
    for old in merged.iterdir():
        old.unlink()
    sources = [corpus, build / "fuzz/work" / target]
    subprocess.run([build / "fuzz" / target, "-merge=1", "-use_value_profile=0", merged, *sources], check=True,
                   capture_output=True)
    for old in corpus.iterdir():
        old.unlink()
    found = sorted(merged.iterdir())
    for new in found[::len(found) // CORPUS_MAX + 1]:
        new.rename(corpus / new.name[:16])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("targets", nargs="*", default=None)
    parser.add_argument("--seconds", type=int, default=60, help="for each target (default 60)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--executions", type=int, default=0, help="of each target; 0: no limit")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--executions-min", type=int, default=0, help="fewer executions of a target are a failure")
    parser.add_argument("--keep", action="store_true", help="renew the committed corpus")
    args = parser.parse_intermixed_args()
    chosen = args.targets or targets()
    print(f"fuzzing {len(chosen)} targets for {args.seconds} s each, seed {args.seed}", flush=True)
    failed, total = False, 0
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for r in pool.map(lambda t: fuzz(args.build, t, args.seconds, args.executions, args.seed), chosen):
            total += r["executions"]
            ok = r["code"] == 0 and r["executions"] >= args.executions_min
            print(f"{'ok' if ok else 'FAIL'} fuzz {r['target']}: {r['executions']} executions, {r['edges']} edges, "
                  f"{r['seconds']:.0f} s, {r['executions'] / r['seconds']:.0f} a second", flush=True)
            if not ok:
                failed = True
                print(r["said"][-4000:], flush=True)
    print(f"{total} executions in total")
    if args.keep:
        for target in chosen:
            keep(args.build, target)
    sys.exit(failed)


main()
