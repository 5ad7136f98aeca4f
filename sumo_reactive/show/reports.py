"""Which page a path gets: that of a batch, of a run, or of several egos."""

from __future__ import annotations

from pathlib import Path

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.recorder import FLEET, PAGE
from sumo_reactive.show.batch.page import batch_page
from sumo_reactive.show.fleet_page import fleet_page
from sumo_reactive.show.recording import load
from sumo_reactive.show.run.page import run_page


def page_beside(path: Path) -> Path:
    """Return where a page goes if nobody says: into the folder it tells of, or beside the store."""
    return path / PAGE if path.is_dir() else path.with_suffix(".html")


def page_of(path: Path, target: Path) -> str:
    """Return the page of a store or a folder, as it stands in the file `target`; raise InputError for another path."""
    if not path.exists():
        raise ScenarioError(f"{path}: no such file or folder")
    if path.is_file():
        return batch_page(path)
    if (path / FLEET).is_file():
        return fleet_page(path, target, PAGE)
    return run_page(load(path))
