"""Spoilt files and odd words for every command: each has to end in one line and an exit code that says so.

Usage: python tools/fuzz.py [--number 10000] [--first 0] [--kind KIND ...] [--seconds S] [--keep FOLDER]
Prints a table of outcomes by kind, and each case that ended otherwise; its folder is kept.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time as clock
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from fuzzing.inputs import MAKERS, kind_of
from fuzzing.material import make
from fuzzing.processes import Ended, end_of, warm_up

Table = Counter[tuple[str, str]]


def fuzzed(
    numbers: Iterable[int], kinds: tuple[str, ...], folder: Path, wrong: Callable[[int, str, Ended], None], seconds: float
) -> Table:
    """Run the cases below a folder for at most so many seconds; return how often each kind ended how."""
    material, table, began = folder / "material", Table(), clock.monotonic()
    if not material.exists():
        make(material)
    warm_up(material)
    for number in numbers:
        if clock.monotonic() - began > seconds:
            break
        kind = kind_of(number, kinds)
        ended = end_of(number, kind, material, folder / f"case_{number}")
        table[kind, ended.outcome] += 1
        if ended.wrong:
            wrong(number, kind, ended)
    return table


def told(table: Table) -> str:
    """Return the table as text: a row a kind, a column an outcome."""
    outcomes = sorted({outcome for _, outcome in table})
    rows = [("kind", *outcomes, "all")]
    for kind in dict.fromkeys(kind for kind in MAKERS if any(kind == one for one, _ in table)):
        rows.append((kind, *_counted(table, kind, outcomes)))
    sums = [str(sum(n for (_, outcome), n in table.items() if outcome == one)) for one in outcomes]
    rows.append(("all", *sums, str(table.total())))
    return "\n".join("  ".join(f"{cell:>14}" for cell in row) for row in rows)


def _counted(table: Table, kind: str, outcomes: list[str]) -> list[str]:
    counts = [table[kind, outcome] for outcome in outcomes]
    return [*map(str, counts), str(sum(counts))]


def main() -> int:
    """Run as a program."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kind", action="append", choices=list(MAKERS))
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--keep", type=Path)
    asked = parser.parse_args()
    folder = asked.keep or Path(tempfile.mkdtemp(prefix="fuzz_"))
    failures = 0

    def wrong(number: int, kind: str, ended: Ended) -> None:
        nonlocal failures
        failures += 1
        last = " | ".join(ended.told.strip().splitlines()[-4:])
        command = " / ".join(ended.command.splitlines())
        print(f"case {number} ({kind}): {ended.wrong}: {command[:400]}\n    {last[:600]}", flush=True)

    numbers = range(asked.first, asked.first + asked.number)
    table = fuzzed(numbers, tuple(asked.kind or MAKERS), folder, wrong, asked.seconds)
    print(told(table))
    print(f"{failures} of {table.total()} ended wrongly; kept in {folder}")
    return int(bool(failures))


if __name__ == "__main__":
    raise SystemExit(main())
