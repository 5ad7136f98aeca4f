"""The page of a run while it drives: written again and again, and for the last time when the run has ended."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from pathlib import Path

from sumo_reactive.errors import InputError, ScenarioError
from sumo_reactive.lab.recorder import FLEET, SUMMARY
from sumo_reactive.lab.under_way import LOOK_S, PROCESS, asked, is_alive, latest_in
from sumo_reactive.show.recording import read_run
from sumo_reactive.show.reports import page_of, run_page
from sumo_reactive.writing import write_whole

WAIT_S = 5.0
"""A record that is there already is the last word if no run answers within this time, s."""

_Stamp = tuple[int, int] | None


def follow(folder: Path, target: Path, tell: Callable[[str], None]) -> None:
    """Write the page of a run that records in `folder`, now or later, to `target` until it has ended.

    `tell` gets in words what is waited for. Raises ScenarioError if the run's process ends without a record: the page
    of what it had recorded stays.
    """
    if folder.is_file():
        raise ScenarioError(f"{folder}: a file, not the folder of a run")
    before, began, written = _stamp(folder), clock.monotonic(), ""
    with asked(folder) as place:
        while True:
            if _stamp(folder) not in (None, before):
                break
            latest = latest_in(place)
            if latest is None:
                if before is not None and clock.monotonic() - began > WAIT_S:
                    break
                tell(f"waiting for a run that records in {folder}")
            elif latest.name != written:
                written = latest.name if _write_so_far(latest, target, tell) else written
            elif not _goes_on(latest) and _stamp(folder) == before:
                raise ScenarioError(f"{folder}: the run ended without a record; {target} shows how far it came")
            clock.sleep(LOOK_S)
    write_whole(target, page_of(folder, target))


def _write_so_far(latest: Path, target: Path, tell: Callable[[str], None]) -> bool:
    """Write the page of what has been recorded; return whether it was still there to be read."""
    try:
        recording = read_run(latest)
        text = run_page(recording)
    except InputError:
        if latest.is_dir():
            raise
        return False
    write_whole(target, text)
    tell(f"{recording.summary['ego']}: {recording.summary['verdict']}")
    return True


def _goes_on(latest: Path) -> bool:
    try:
        return is_alive(read_run(latest).summary.get(PROCESS))
    except InputError:
        return True  # a newer one has taken its place


def _stamp(folder: Path) -> _Stamp:
    """Return what tells the record in a folder from another; None: there is none."""
    for name in (SUMMARY, FLEET):
        try:
            found = (folder / name).stat()
        except OSError:
            continue
        return found.st_mtime_ns, found.st_ino
    return None
