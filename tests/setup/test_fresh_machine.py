#!/usr/bin/env python3
"""The check on a bare machine leaves nothing behind, whatever ends it, and fails loudly where it cannot run.

debootstrap is a fake that takes its time, so that the script can be ended in the middle of its work."""
import os
import pathlib
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/sim"))
from simulator import main  # noqa: E402

SCRIPT = ROOT / ".ci/fresh-machine"


def with_fakes(folder, **fakes):
    """An environment in which these programs are replaced by shell scripts."""
    (folder / "bin").mkdir(exist_ok=True)
    (folder / "work").mkdir(exist_ok=True)
    for name, body in fakes.items():
        (folder / "bin" / name).write_text("#!/bin/sh\n" + body + "\n", encoding="ascii")
        (folder / "bin" / name).chmod(0o755)
    return {"PATH": f"{folder}/bin:/usr/sbin:/usr/bin:/sbin:/bin", "TMPDIR": str(folder / "work"), "HOME": str(folder)}


def processes_with(text):
    """Other processes whose command line holds a text: id and command line."""
    found = {}
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            line = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if text in line and int(entry.name) != os.getpid():
            found[int(entry.name)] = line
    return found


def wait_for(condition, seconds=20):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


def refused(folder, message, **fakes):
    env = with_fakes(folder, **{"debootstrap": "exit 1", **fakes})
    done = subprocess.run([SCRIPT, "help"], env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=60, check=False)
    assert done.returncode == 2 and message in done.stderr, (done.returncode, done.stderr)
    assert not list((folder / "work").iterdir()), "files are left"


def test_a_user_who_is_not_root_is_told(folder):
    refused(folder, "sudo make fresh-machine", id="echo 1000")


def test_forbidden_namespaces_fail_loudly(folder):
    refused(folder, "forbids mount or PID namespaces", id="echo 0",
            unshare="echo 'unshare: Operation not permitted' >&2; exit 1")


def namespaces_are_allowed():
    return os.geteuid() == 0 and subprocess.run(
        ["unshare", "--mount", "--pid", "--fork", "true"], capture_output=True, check=False).returncode == 0


def ended_by(folder, end):
    """Starts the script, ends it while debootstrap works with a mount of its own; `end` takes the caller's process."""
    if not namespaces_are_allowed():
        return "only root can make namespaces here"
    mark = f"1000.{os.getpid()}"
    env = with_fakes(folder, debootstrap=f'mkdir -p "$4"; mount -t tmpfs left "$4"; touch "$4/begun"; : >"{folder}/begun"\n'
                                         f"sleep {mark}\nexit 1")
    caller = subprocess.Popen(["sh", "-c", f"'{SCRIPT}' --as root help; true"], env=env, stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    begun_by_us = lambda: {**processes_with(f"sleep {mark}"), **processes_with(str(folder / "work"))}
    try:
        assert wait_for((folder / "begun").exists), "debootstrap was not started"
        assert len(begun_by_us()) >= 3, begun_by_us()
        end(caller)
        caller.wait(timeout=30)
        assert wait_for(lambda: not begun_by_us()), begun_by_us()
        mounts = pathlib.Path("/proc/self/mounts").read_text(encoding="utf-8")
        assert str(folder) not in mounts, mounts
    finally:
        for pid in begun_by_us():
            os.kill(pid, signal.SIGKILL)
    return None


def script_of(caller):
    children = pathlib.Path(f"/proc/{caller.pid}/task/{caller.pid}/children").read_text(encoding="ascii").split()
    assert len(children) == 1, children
    return int(children[0])


def test_ended_by_term(folder):
    why = ended_by(folder, lambda caller: os.kill(script_of(caller), signal.SIGTERM))
    assert why or not list((folder / "work").iterdir()), "files are left"
    return why


def test_ended_with_its_caller(folder):
    why = ended_by(folder, lambda caller: caller.kill())
    assert why or wait_for(lambda: not list((folder / "work").iterdir())), "files are left"
    return why


def test_killed(folder):
    """Nobody can remove files after that; the next run does."""
    why = ended_by(folder, lambda caller: os.kill(script_of(caller), signal.SIGKILL))
    if why:
        return why
    assert len(list((folder / "work").iterdir())) == 1
    env = with_fakes(folder, debootstrap="exit 1")
    done = subprocess.run([SCRIPT, "help"], env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=60, check=False)
    assert done.returncode == 2 and "debootstrap could not make a root" in done.stderr, done.stderr
    assert not list((folder / "work").iterdir()), "files are left"
    return None


if __name__ == "__main__":
    main()
