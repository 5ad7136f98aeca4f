"""The page of several egos that drove at once: a row an ego, with the way to its own page."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sumo_reactive.lab.recorder import read_fleet
from sumo_reactive.show.frame.labels import number, title_of
from sumo_reactive.show.frame.page import Section, code, link, page, paragraph_of, table

METRICS = ("duration_s", "time_loss_s", "distance_m", "collisions", "violations", "hard_braking_caused", "rms_jerk_m_s3")
"""What the table shows of each ego."""


def fleet_page(folder: Path, target: Path, own_page: str) -> str:
    """Return the page as it stands in `target`; an ego's own page is `own_page` in its folder, linked if it is there."""
    fleet = read_fleet(folder)
    egos = [one.model_dump() for one in fleet.egos]
    rows = [_row(one, folder / one["folder"], target, own_page) for one in egos]
    left = [(one.vehicle, one.reason) for one in fleet.refused]
    clean = sum(one["verdict"].startswith("arrived without") for one in egos)
    sections = (
        Section("egos", "Egos", [
            paragraph_of("An ego's own page is linked where it has been written; else the command that writes it is named."),
            table(("ego", "verdict", *map(title_of, METRICS), "its page"), rows),
        ]),
        Section("refused", "Not driven", [table(("vehicle", "reason"), left)] if left else []),
    )  # fmt: skip
    return page(f"{len(egos)} egos", f"{clean} of {len(egos)} arrived without a violation.", sections, is_drawn=False)


def _row(one: Mapping[str, Any], own: Path, target: Path, own_page: str) -> tuple[str, ...]:
    written = own / own_page
    way = quote(Path(os.path.relpath(written, target.absolute().parent)).as_posix())
    shown = link(way, "page") if written.is_file() else code(shlex.join(["sumo-reactive", "report", str(own)]))
    return one["ego"], one["verdict"], *(number(one.get(name)) for name in METRICS), shown
