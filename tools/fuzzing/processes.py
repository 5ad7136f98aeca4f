"""Each case in a process forked from one that has loaded everything, and the judge of how it ended."""

from __future__ import annotations

import contextlib
import os
import resource
import shutil
import signal
import sys
import tempfile
import time as clock
import traceback
from pathlib import Path
from typing import NamedTuple

from fuzzing.inputs import make_case
from fuzzing.material import copy

LIMIT_S = 60.0
MOST_MEMORY = 6 * 2**30
_NOT_MADE, _ESCAPED = 98, 99
_LONGEST_LINE = 2000
_DIED = "SUMO died of"


class Ended(NamedTuple):
    """How a case ended: a short word, what is wrong with it (empty: nothing), its command line, what it wrote."""

    outcome: str
    wrong: str
    command: str
    told: str


def warm_up(material: Path) -> None:
    """Load all that commands load, and the kernels, so that a forked process has them."""
    import sumo_reactive.cli.batch
    import sumo_reactive.lab.batch.engine
    import sumo_reactive.lab.batch.stored_results
    import sumo_reactive.lab.comparison.comparison
    import sumo_reactive.lab.recorder
    import sumo_reactive.show.reports
    import sumo_reactive.sumo.crash  # noqa: F401
    from sumo_reactive.lab.scenario import load_scenario
    from sumo_reactive.lab.simulation import run_trial

    run_trial(load_scenario(material / "a.toml"))


def end_of(number: int, kind: str, material: Path, folder: Path) -> Ended:
    """Run a case in `folder`, which is removed unless something is wrong."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        _be_the_case(number, kind, material, folder)
    status = _waited(child)
    ended = _judged(status, folder)
    if not ended.wrong:
        shutil.rmtree(folder, ignore_errors=True)
    return ended


def _be_the_case(number: int, kind: str, material: Path, folder: Path) -> None:
    """Never return."""
    code = _NOT_MADE
    try:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        copy(material, folder / "here")
        (folder / "tmp").mkdir()
        os.chdir(folder / "here")
        tempfile.tempdir, os.environ["TMPDIR"] = None, str(folder / "tmp")
        for name, number_of in (("stdout", 1), ("stderr", 2)):
            handle = os.open(folder / name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(handle, number_of)
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        arguments, told = make_case(number, kind, Path(), material)
        (folder / "command").write_text(f"{arguments!r}\n{told}\n", encoding="utf-8")
        code = _run(arguments)
    except BaseException:
        traceback.print_exc()
    with contextlib.suppress(Exception):
        sys.stdout.flush()
    with contextlib.suppress(Exception):
        sys.stderr.flush()
    os._exit(code)


def _run(arguments: list[str]) -> int:
    from sumo_reactive.__main__ import main

    sys.argv = ["sumo-reactive", *arguments]
    try:
        main()
    except SystemExit as ended:
        return ended.code if isinstance(ended.code, int) else 0
    return _ESCAPED


def _waited(child: int) -> int | None:
    """Return the exit code of a process, negative: a signal; None if it had to be killed. Nobody of it stays."""
    until = clock.monotonic() + LIMIT_S
    code = None
    while clock.monotonic() < until:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            code = os.waitstatus_to_exitcode(status)
            break
        clock.sleep(0.002)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    if code is None:
        os.waitpid(child, 0)
    return code


def _judged(code: int | None, folder: Path) -> Ended:
    stderr, command = _text(folder / "stderr"), _text(folder / "command")
    lines = [line for line in stderr.splitlines() if line.startswith("sumo-reactive: ")]
    outcome = "hang" if code is None else f"signal {-code}" if code < 0 else str(code)
    if code == 3 and lines and _DIED in lines[0]:
        outcome = "3, SUMO died"
    return Ended(outcome, "; ".join(_complaints(code, stderr, lines, folder)), command, stderr[-3000:])


def _complaints(code: int | None, stderr: str, lines: list[str], folder: Path) -> list[str]:
    found = []
    if code not in (0, 1, 2, 3):
        found.append(f"ended with {code}")
    if "Traceback" in stderr:
        found.append("traceback")
    if any("interrupted" in line for line in lines):
        found.append("interrupted")
    if code in (2, 3) and len(lines) != 1:
        found.append(f"{len(lines)} lines")
    if any(len(line) > _LONGEST_LINE for line in lines):
        found.append("a long line")
    left = [path.name for path in (folder / "tmp").glob("*")]
    left += [path.name for path in (folder / "here").rglob("*") if path.name.endswith((".partial", ".tmp"))]
    if left and _DIED not in stderr:
        found.append(f"left {left[:3]}")
    out = folder / "here" / "out"
    if out.is_dir() and not any((out / name).is_file() for name in ("summary.json", "fleet.json", "comparison.json")):
        found.append("half a record")
    return found


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
