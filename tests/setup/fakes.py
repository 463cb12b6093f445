"""A machine that lacks packages, as .ci/setup sees it: fake package tools in a folder first on PATH.

What they do is told by files in that folder: "installed" lists the packages that are there, "log" takes one line
for each begin and end of a change by apt-get, "apt-get-fails" is what it prints when it cannot install."""
import os
import pathlib
import subprocess

FAKES = {
    "dpkg-query": r"""
for p in "$@"; do
    case $p in -*) continue ;; esac
    grep -qx "$p" "$FAKES/installed" && echo "$p ii "
done
exit 0""",
    "apt-cache": r"""echo "Size: 1000000"; echo "Installed-Size: 2000" """,
    "apt-get": r"""
names= simulated=
for word in "$@"; do
    case $word in
        install | update) verb=$word ;;
        -s) simulated=1 ;;
        -o) ;;
        -* | *::*) ;;
        *) names="$names $word" ;;
    esac
done
if [ -n "$simulated" ]; then for p in $names; do echo "Inst $p (1.0 Fake:1.0 [all])"; done; exit 0; fi
[ -z "${MUST_BE_ROOT:-}" ] || [ -n "${BY_SUDO:-}" ] || { echo "E: are you root?"; exit 100; }
echo "begin $verb$names" >>"$FAKES/log"
sleep "${SECONDS_OF_WORK:-0}"
if [ -e "$FAKES/apt-get-fails" ]; then cat "$FAKES/apt-get-fails"; echo "end" >>"$FAKES/log"; exit 100; fi
[ -e "$FAKES/installs-nothing" ] || for p in $names; do echo "$p" >>"$FAKES/installed"; echo "Setting up $p (1.0) ..."; done
echo "end" >>"$FAKES/log"
""",
}
SUDO = r"""
[ -z "${SUDO_ASKS:-}" ] || exit 1
[ "$1" != -n ] || shift
BY_SUDO=1 exec "$@"
"""
# what a setup may call on any machine, beside the fakes
PLAIN = "sh make sed grep awk mawk tr id tail wc env rm dirname getconf flock find uname git cat sleep sort true date".split()


class Machine:
    """fakes: names of the fake tools that it has; "id": the user is not root."""

    def __init__(self, folder, *, without=(), user="root", sudo=False, installs=True):
        self.folder = pathlib.Path(folder)
        tools = {k: v for k, v in FAKES.items() if k not in without}
        if sudo:
            tools["sudo"] = SUDO
        if user != "root":
            tools["id"] = "echo 1000"
        else:
            tools["id"] = "echo 0"
        for name, body in tools.items():
            (self.folder / name).write_text("#!/bin/sh\n" + body + "\n", encoding="ascii")
            (self.folder / name).chmod(0o755)
        for name in PLAIN:
            real = next((p for d in ("/bin", "/usr/bin", "/sbin", "/usr/sbin") if (p := pathlib.Path(d) / name).exists()), None)
            if real and name not in tools:
                (self.folder / name).symlink_to(real)
        (self.folder / "installed").touch()
        (self.folder / "log").touch()
        if not installs:
            (self.folder / "installs-nothing").touch()

    def start(self, *command, cwd, **variables):
        env = {"PATH": str(self.folder), "FAKES": str(self.folder), "HOME": str(self.folder), "TMPDIR": str(self.folder),
               **variables}
        return subprocess.Popen(command, cwd=cwd, env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True)

    def run(self, *command, cwd, **variables):
        """Exit code and all that was printed."""
        process = self.start(*command, cwd=cwd, **variables)
        said, _ = process.communicate(timeout=60)
        return process.returncode, said

    def log(self):
        return (self.folder / "log").read_text(encoding="ascii").splitlines()

    def asked(self):
        """The sets of packages that apt-get was asked to install, one for each call."""
        return [set(line.split()[2:]) for line in self.log() if line.startswith("begin install")]
