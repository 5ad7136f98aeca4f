"""Kills and interrupts at random moments: nothing half, nothing left in the temporary folder, nobody left running.

Usage: python tools/kill.py [--number 100] [--first 0] [--command NAME ...] [--keep FOLDER]
Each command runs once undisturbed, for the time it takes; then again and again, struck at a random moment of that time by
SIGINT or SIGTERM (to it alone or to its whole group, as a terminal does) or by SIGKILL (to it alone).
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time as clock
from collections import Counter
from pathlib import Path
from random import Random
from typing import NamedTuple
from xml.etree import ElementTree

import psutil

ROOT = Path(__file__).resolve().parents[1]
SCENARIO = ROOT / "scenarios" / "four_way_priority.toml"
EXPERIMENT = f"""[experiment]
scenarios = ["{SCENARIO}"]
seeds = [1, 2, 3]
store = "store.duckdb"
"""
COMMANDS = {
    "run": ("run", str(SCENARIO), "--until-end", "--out", "out"),
    "fleet": ("run", str(SCENARIO), "--ego-probability", "0.5", "--until", "60", "--out", "out"),
    "compare": ("compare", str(SCENARIO), "--jobs", "2", "--out", "out"),
    "check": ("check", str(SCENARIO), "--jobs", "2", "--junit", "verdicts.xml"),
    "batch": ("batch", "experiment.toml", "--workers", "2"),
}
LAST_FILES = ("summary.json", "comparison.json", "fleet.json")
"""A record that has one of these is complete."""

EARLIEST_S = 0.05
"""Before that the interpreter itself is being started."""

PATIENCE_S = 60.0
MARK = "SUMO_REACTIVE_STRUCK"


class Struck(NamedTuple):
    """How a command ended: its exit code, what is wrong (empty: nothing), how long it took (s)."""

    code: int | None
    wrong: list[str]
    took_s: float


def struck(command: str, folder: Path, number: int, after_s: float | None, to_group: bool) -> Struck:
    """Run a command in a folder, and send it a signal after a time; None: never."""
    here, temporary = folder / "here", folder / "tmp"
    here.mkdir(parents=True)
    temporary.mkdir()
    (here / "experiment.toml").write_text(EXPERIMENT, encoding="utf-8")
    environment = os.environ | {"TMPDIR": str(temporary), MARK: str(folder)}
    began = clock.monotonic()
    with (folder / "stderr").open("wb") as heard, (folder / "stdout").open("wb") as said:
        process = subprocess.Popen(
            [sys.executable, "-m", "sumo_reactive", *COMMANDS[command]], cwd=here, env=environment,
            stdin=subprocess.DEVNULL, stdout=said, stderr=heard, start_new_session=True,
        )  # fmt: skip
        if after_s is not None:
            with contextlib.suppress(subprocess.TimeoutExpired, ProcessLookupError):
                process.wait(after_s)
            if process.poll() is None:
                (os.killpg if to_group else os.kill)(process.pid, number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(PATIENCE_S if after_s is not None else 600.0)
    took, code = clock.monotonic() - began, process.poll()
    wrong = _wrong(code, number, folder) if after_s is not None else []
    if code is None:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    return Struck(code, wrong, took)


def _wrong(code: int | None, number: int, folder: Path) -> list[str]:
    """Return what is not as it should be after a command was struck."""
    stderr = (folder / "stderr").read_text(encoding="utf-8", errors="replace")
    expected = {0, 1, -number} if number == signal.SIGKILL else {0, 1, 130, -number}  # the last: Python starts or ends
    found = [] if code in expected else [f"ended with {code}"]
    if "Traceback" in stderr:
        found.append("traceback")
    if code == 130 and not stderr.endswith("sumo-reactive: interrupted\n"):
        found.append("not told")
    if orphans := _orphans(folder):
        found.append(f"left running {orphans}")
    if left := [path.name for path in (folder / "tmp").iterdir()]:
        found.append(f"left {left[:3]} in the temporary folder")
    return found + list(_half(folder / "here"))


def _orphans(folder: Path) -> list[str]:
    """Return the processes of a command that still run; those that are about to end are given some seconds."""
    until = clock.monotonic() + 10.0
    while True:
        found = [" ".join(one.cmdline())[-80:] for one in psutil.process_iter() if _is_of(one, folder)]
        if not found or clock.monotonic() > until:
            return found
        clock.sleep(0.1)


def _is_of(process: psutil.Process, folder: Path) -> bool:
    try:
        return process.status() != psutil.STATUS_ZOMBIE and process.environ().get(MARK) == str(folder)
    except psutil.Error:
        return False


def _half(here: Path) -> list[str]:
    """Return what is there only in part."""
    found = [f"partial {path.name}" for path in here.rglob("*") if path.name.endswith((".partial", ".tmp"))]
    out, verdicts, store = here / "out", here / "verdicts.xml", here / "store.duckdb"
    if out.exists():
        last = next((out / name for name in LAST_FILES if (out / name).exists()), None)
        if last is None:
            found.append(f"half a record: {sorted(path.name for path in out.iterdir())}")
        else:
            json.loads(last.read_text(encoding="utf-8"))
    if verdicts.exists():
        ElementTree.parse(verdicts)
    if store.exists():
        again = [sys.executable, "-m", "sumo_reactive", "results", str(store)]
        answer = subprocess.run(again, capture_output=True, text=True, timeout=120, check=False)
        if answer.returncode not in (0, 2) or "Traceback" in answer.stderr:
            found.append(f"a store that cannot be read: {answer.stderr[-300:]}")
    return found


def main() -> int:
    """Run as a program."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--command", action="append", choices=list(COMMANDS))
    parser.add_argument("--keep", type=Path)
    asked = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # what starts this may ignore it, and a process inherits that
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    folder = asked.keep or Path(tempfile.mkdtemp(prefix="kill_"))
    commands = asked.command or list(COMMANDS)
    takes = {name: struck(name, folder / f"undisturbed_{name}", 0, None, False).took_s for name in commands}
    table, failures = Counter[tuple[str, str, int | None]](), 0
    for number in range(asked.first, asked.first + asked.number):
        random = Random(f"strike {number}")
        name, sent = random.choice(commands), random.choice((signal.SIGINT, signal.SIGTERM, signal.SIGKILL))
        after, to_group = random.uniform(EARLIEST_S, takes[name]), sent != signal.SIGKILL and random.random() < 0.5
        ended = struck(name, folder / f"case_{number}", sent, after, to_group)
        table[name, sent.name, ended.code] += 1
        if ended.wrong:
            failures += 1
            print(f"case {number}: {name}, {sent.name} after {after:.2f} s: {'; '.join(ended.wrong)}", flush=True)
    for (name, sent_name, code), count in sorted(table.items(), key=str):
        print(f"{name:>8}  {sent_name:<8}  ended with {code}: {count}")
    print(f"{failures} of {asked.number} ended wrongly; {folder}")
    return int(bool(failures))


if __name__ == "__main__":
    raise SystemExit(main())
