#!/usr/bin/env python3
"""How much of what is changed in a room its own tests notice: a seeded sample of mutants, made and run by mutmut.

    python tools/mutations.py [--count 200] [--seed 1] [--room ROOM]… [--jobs 1] [--root FOLDER]

Works on a copy, in which the kernels are plain Python: a mutant then needs no compilation. The sample is spread over the
rooms in proportion to their mutants. Prints the survivors, each as a difference, and the score of each room: the share of
its mutants under which a test fails or does not come to an end. What no test reaches has survived. What mutmut does not
change: decorated functions (but kernels), and what stands outside of functions. Exit codes: 0, 1 if mutmut failed, 2 for
wrong usage.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from mutmut.mutation.file_mutation import mutate_file_contents
from mutmut.utils.format_utils import get_mutant_name

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = "sumo_reactive"
ROOMS = {
    "driver/pilot": ("tests/driver/pilot",),
    "driver/field": ("tests/driver/field",),
    "sumo": ("tests/sumo", "tests/sumo_contract"),
}
"""The tests of each room."""
NEEDED = (PACKAGE, "tests", "networks", "scenarios", "tools", "pyproject.toml", "README.md", "docs")
"""What tests may read."""
IN_SHORT = {"NUMBA_DISABLE_JIT": "1", "HYPOTHESIS_PROFILE": "brief"}
"""Nothing is compiled, and what is tested by property by fewer examples."""
NOTICED = ("killed", "timeout", "segfault")
SETTINGS = """[mutmut]
source_paths = {package}
only_mutate = {package}/{room}/*
pytest_add_cli_args_test_selection =
{tests}
also_copy =
{needed}
use_git_change_detection = false
timeout_multiplier = 3
timeout_constant = 10
"""
"""`timeout_…`: a mutant may take 3 × (as long as its tests take + 10 s)."""


def copied(root: Path, folder: Path, room: str) -> None:
    """Copy a project into `folder`, its kernels as plain Python, with mutmut's settings for one room."""
    (folder / "mutants").mkdir(parents=True)  # Python would not look again for one made later
    for name in (name for name in NEEDED if (root / name).exists()):
        if (root / name).is_dir():
            shutil.copytree(root / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(root / name, folder / name)
    for source in (folder / PACKAGE).rglob("*.py"):
        text = source.read_text(encoding="utf-8")
        source.write_text(re.sub(r"^@kernel\n", "", text, flags=re.MULTILINE), encoding="utf-8")
    tests, needed = ("\n".join(f"    {name}" for name in names) for names in (ROOMS[room], NEEDED[2:]))
    settings = SETTINGS.format(package=PACKAGE, room=room, tests=tests, needed=needed)
    (folder / "setup.cfg").write_text(settings, encoding="utf-8")


def mutants_of(folder: Path, room: str) -> list[str]:
    """Return the names of all mutants of a room, in order."""
    found: list[str] = []
    with contextlib.chdir(folder):  # where mutmut looks for its settings
        for source in sorted(Path(PACKAGE, room).rglob("*.py")):
            names = mutate_file_contents(str(source), source.read_text(encoding="utf-8")).mutant_names
            found += [get_mutant_name(source, name) for name in names]
    return found


def sampled(mutants: Mapping[str, Sequence[str]], count: int, seed: int) -> dict[str, list[str]]:
    """Return `count` mutants of all rooms together, of each in proportion to what it has, at least one."""
    drawn, total = random.Random(seed), sum(map(len, mutants.values()))
    shares = {room: min(len(names), max(1, round(count * len(names) / total))) for room, names in mutants.items() if names}
    return {room: sorted(drawn.sample(mutants[room], share)) for room, share in shares.items()}


def verdicts(folder: Path, names: Sequence[str], jobs: int) -> dict[str, str]:
    """Run the tests under each of these mutants; return what mutmut says of it: killed, survived, no tests, …"""
    _mutmut(folder, "run", "--max-children", str(jobs), *names)
    said = (line.strip().rpartition(": ") for line in _mutmut(folder, "results", "--all", "true").splitlines())
    every = {name: verdict for name, _, verdict in said}
    return {name: every[name] for name in names}


def _mutmut(folder: Path, *arguments: str) -> str:
    """Run mutmut; return what it prints."""
    environment = os.environ | {"PYTHONPATH": str(folder / "mutants")} | IN_SHORT
    command = [str(Path(sys.executable).with_name("mutmut")), *arguments]
    answer = subprocess.run(command, cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False)
    if answer.returncode != 0:
        raise ChildProcessError(f"mutmut {arguments[0]} failed:\n{answer.stdout[-4000:]}{answer.stderr[-4000:]}")
    return answer.stdout


def report(folder: Path, room: str, found: Mapping[str, str]) -> str:
    """Print the survivors of a room; return the line of its score."""
    survivors = [name for name, verdict in found.items() if verdict not in NOTICED]
    for name in survivors:
        print(_mutmut(folder, "show", name), flush=True)
    noticed = len(found) - len(survivors)
    return f"{room:14}{noticed} of {len(found)}: {noticed / len(found):.0%}"


def main() -> int:
    """Draw, run, print."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--count", type=int, default=200, help="mutants of all rooms together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", action="append", choices=ROOMS, help="may be given again; all unless given")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--root", type=Path, default=ROOT, help="the project, else this one")
    asked = parser.parse_args()
    rooms = asked.room or list(ROOMS)
    with tempfile.TemporaryDirectory(prefix="mutations_") as scratch:
        folders = {room: Path(scratch).resolve() / room for room in rooms}
        for room, folder in folders.items():
            copied(asked.root, folder, room)
        drawn = sampled({room: mutants_of(folders[room], room) for room in rooms}, asked.count, asked.seed)
        try:
            found = {room: verdicts(folders[room], names, asked.jobs) for room, names in drawn.items()}
            lines = [report(folders[room], room, of_room) for room, of_room in found.items()]
        except ChildProcessError as error:
            print(error, file=sys.stderr)
            return 1
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
