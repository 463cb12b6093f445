#!/usr/bin/env python3
"""Every documented target asks for the packages that it needs, before anything is built, once, and says so.

The package tools are fakes (fakes.py), so nothing is installed and nothing is built. What a target needs is
found from its commands, not from what it asks for (needs.py)."""
import pathlib
import re
import shutil
import subprocess
import sys

import fakes
import needs

sys.path.insert(0, str(needs.ROOT / "tests/sim"))
from simulator import main  # noqa: E402

ROOT = needs.ROOT
DOCUMENTED = re.compile(r"^([a-z][a-z-]*):(.*)## \[([a-z -]*)\] ", re.MULTILINE)


def documented():
    """The targets that make help lists."""
    said = subprocess.run(["make", "-s", "help"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return re.findall(r"^  make ([a-z-]+) ", said, re.MULTILINE)


def packages_of_the_list():
    lines = (ROOT / ".ci/packages").read_text(encoding="ascii").splitlines()
    return {line.split()[0]: set(line.split()[1:]) for line in lines if line and not line.startswith("#")}


def asked_for(folder, *goals, tree=ROOT):
    """What a bare machine is asked to install for these goals, by make itself."""
    machine = fakes.Machine(folder, installs=False)
    code, said = machine.run("make", "BUILD=/nowhere", *goals, cwd=tree)
    calls = machine.asked()
    assert len(calls) <= 1, f"{goals}: {len(calls)} calls of apt-get"
    if calls:  # nothing came: then nothing may have been built
        assert code != 0 and "still missing" in said, said
        assert "/nowhere" not in said, f"{goals}: built before its setup was done:\n{said}"
    return calls[0] if calls else set()


def with_those_that_come(packages):
    brought = {p for p, by in needs.COMES_WITH.items() if packages & set(by)}
    return packages | brought


_needed = {}


def needed(target):
    if target not in _needed:
        _needed[target] = needs.needed(target)
    return _needed[target]


def sandbox(folder, name):
    folder = folder / name
    folder.mkdir()
    return folder


def test_every_documented_target_asks_for_what_it_needs(folder):
    targets = documented()
    assert len(targets) > 30 and "test" in targets, targets
    for target in targets:
        if not needed(target):  # clean, uninstall: nothing to ask for, so make would run it
            continue
        missing = needed(target) - with_those_that_come(asked_for(sandbox(folder, target), target))
        assert not missing, f"make {target} does not ask for {sorted(missing)}"


def tree_of_setup(folder):
    """The files that the setup reads, to be changed."""
    shutil.copytree(ROOT / ".ci", folder / ".ci")
    shutil.copy(ROOT / "Makefile", folder / "Makefile")
    return folder


def test_no_task_of_a_target_can_be_removed_unnoticed(folder):
    tree = tree_of_setup(sandbox(folder, "tree"))
    text = (tree / "Makefile").read_text(encoding="ascii")
    removed = 0
    for target, _, tasks in DOCUMENTED.findall(text):
        for task in tasks.split():
            rest = " ".join(t for t in tasks.split() if t != task)
            changed = re.sub(rf"^({target}:.*## )\[{re.escape(tasks)}\]", rf"\g<1>[{rest}]", text, flags=re.MULTILINE)
            assert changed != text
            (tree / "Makefile").write_text(changed, encoding="ascii")
            machine = fakes.Machine(sandbox(folder, f"{target}.{task}"), installs=False)
            machine.run(".ci/setup", target, cwd=tree)
            asked = with_those_that_come(set().union(*machine.asked()))
            assert needed(target) - asked, f"make {target} needs nothing of the task '{task}' that it names"
            removed += 1
    assert removed > 50, removed


def test_no_package_of_a_task_can_be_removed_unnoticed(_):
    used = set().union(*(needed(t) for t in documented()))
    listed = set().union(*packages_of_the_list().values())
    assert listed <= set(needs.MARKS), f"no mark in needs.py: {sorted(listed - set(needs.MARKS))}"
    assert listed <= used, f"no target needs {sorted(listed - used)}"


def test_a_documented_target_without_tasks_is_refused(folder):
    tree = tree_of_setup(sandbox(folder, "tree"))
    (tree / "Makefile").write_text("sim: x ## build it\nhelp: ## [] list\n", encoding="ascii")
    code, said = fakes.Machine(sandbox(folder, "machine")).run(".ci/setup", "help", cwd=tree)
    assert code != 0 and "without [tasks]" in said and "sim" in said, said


def test_an_unknown_task_is_refused(folder):
    tree = tree_of_setup(sandbox(folder, "tree"))
    (tree / "Makefile").write_text("sim: x ## [no-such] build it\n", encoding="ascii")
    code, said = fakes.Machine(sandbox(folder, "machine")).run(".ci/setup", "sim", cwd=tree)
    assert code != 0 and "no-such" in said, said


def packages_of(task):
    lines = (ROOT / ".ci/packages").read_text(encoding="ascii").splitlines()
    return next(line.split()[1:] for line in lines if line.split()[:1] == [task])


def test_all_goals_are_served_by_one_installation(folder):
    asked = asked_for(sandbox(folder, "both"), "-j8", "sim", "gateway", "format-check")
    for target in ("sim", "gateway", "format-check"):
        assert needed(target) <= asked, (target, asked)


def test_a_core_of_the_c_library_brings_its_compiler(folder):
    for name in ("host", "m4f", "rv32"):
        (folder / name).mkdir()
    host = asked_for(folder / "host", "c-library")
    assert host and not host & {"gcc-arm-none-eabi", "gcc-riscv64-unknown-elf"}, host
    assert asked_for(folder / "m4f", "c-library", "CORE=m4f") == host | set(packages_of("cortex-m"))
    assert asked_for(folder / "rv32", "c-library", "CORE=rv32imac") == host | set(packages_of("risc-v"))


def test_it_says_what_will_come_and_how_much(folder):
    machine = fakes.Machine(folder)
    code, said = machine.run(".ci/setup", "sim", cwd=ROOT)
    assert code == 0, said
    packages = packages_of("build")
    assert f"make sim needs packages that this machine lacks: {' '.join(packages)}" in said, said
    n = len(packages)
    announced, installed = said.index("1 MB to download, 2 MB on the disk"), said.index(f"{n} of {n} packages installed")
    assert announced < installed, said
    code, said = machine.run(".ci/setup", "sim", cwd=ROOT)
    assert code == 0 and not said, f"a second setup has something to say: {said}"


def test_two_calls_of_make_do_not_run_two_package_managers(folder):
    machine = fakes.Machine(folder)
    both = [machine.start(".ci/setup", t, cwd=ROOT, SECONDS_OF_WORK="0.3") for t in ("gateway", "format-check", "sim", "gateway")]
    for process in both:
        said, _ = process.communicate(timeout=60)
        assert process.returncode == 0, said
    log = [line.split()[0] for line in machine.log()]
    assert log == ["begin", "end"] * (len(log) // 2) and len(log) >= 4, machine.log()
    asked = [p for call in machine.asked() for p in call]
    assert len(asked) == len(set(asked)), f"asked for twice: {machine.log()}"


def stops(folder, reason, prepare=None, **machine):
    folder = sandbox(folder, reason.replace(" ", "-")[:20])
    bare = fakes.Machine(folder, **machine)
    variables = prepare(folder) if prepare else {}
    code, said = bare.run("make", "BUILD=/nowhere", "sim", cwd=ROOT, **(variables or {}))
    assert code != 0, said
    assert reason in said and "setup: stopped:" in said, said
    assert "/nowhere" not in said, f"built without its setup: {said}"


def test_a_stop_says_why(folder):
    stops(folder, "there is no apt-get", without=["apt-get"])
    stops(folder, "this is no Debian machine", without=["dpkg-query"])
    stops(folder, "you are not root and there is no sudo", user="newcomer")
    stops(folder, "sudo asks for a password", lambda _: {"SUDO_ASKS": "1"}, user="newcomer", sudo=True)
    stops(folder, "is there a network?", lambda f: (f / "apt-get-fails").write_text(
        "Err:1 http://deb.example bookworm InRelease\n  Temporary failure resolving 'deb.example'\nE: no\n") and {})
    stops(folder, "apt-get failed", lambda f: (f / "apt-get-fails").write_text("E: disk full\n") and {})
    stops(folder, "still missing", installs=False)


def test_an_ordinary_user_installs_by_sudo(folder):
    machine = fakes.Machine(folder, user="newcomer", sudo=True)
    code, said = machine.run(".ci/setup", "sim", cwd=ROOT, MUST_BE_ROOT="1")
    assert code == 0, said
    assert machine.asked() == [set(packages_of("build"))], machine.log()


def test_setup_can_be_skipped(folder):
    machine = fakes.Machine(folder, installs=False)
    code, said = machine.run("make", "-n", "SETUP=no", "sim", cwd=ROOT)
    assert code == 0 and not machine.log(), said


def test_a_dry_run_installs_nothing(folder):
    machine = fakes.Machine(folder)
    code, said = machine.run("make", "-n", "BUILD=/nowhere", "sim", cwd=ROOT)
    assert code == 0 and not machine.log(), (code, said[-500:], machine.log())


def test_help_needs_only_make_and_a_shell(folder):
    for name in ("make", "sh"):
        (folder / name).symlink_to(pathlib.Path("/usr/bin") / name)
    done = subprocess.run([str(folder / "make"), "help"], cwd=ROOT, env={"PATH": str(folder)}, capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0 and not done.stderr, done.stderr
    for target in documented():
        assert f"  make {target} " in done.stdout, target


if __name__ == "__main__":
    main()
