"""What came of the trips: a table by kind of road, both drivers side by side, and the trips where this one is worse."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from roads.trips import Run

SLOWER = 1.5
"""Whoever takes so many times as long as SUMO's own driver is slow."""

TOLD = 3
"""Contacts of a trip that are told one by one."""


class Row(NamedTuple):
    """A trip: number and kind of the network, how many edges it has, the ego, and what both drivers made of it."""

    index: int
    kind: str
    edges: int
    ego: str
    ours: Run
    sumo: Run

    @property
    def ratio(self) -> float | None:
        """Duration over that of SUMO's own driver where both arrived."""
        both = self.ours.arrived and self.sumo.arrived and self.sumo.duration_s > 0.0
        return self.ours.duration_s / self.sumo.duration_s if both else None

    @property
    def is_harmful(self) -> bool:
        """Whether there was a contact, a red light was run, or the trip failed."""
        return bool(self.ours.contacts or self.ours.red or self.ours.error)

    @property
    def disagrees(self) -> bool:
        """Whether the program's own judges count other contacts or red lights than the witness."""
        return not self.ours.error and self.ours.judged != (len(self.ours.contacts), len(self.ours.red))


Count = Callable[[Run], float]

_COUNTS: dict[str, tuple[Count, int]] = {
    "arrived": (lambda run: run.arrived, 0),
    "contacts": (lambda run: len(run.contacts), 0),
    "red": (lambda run: len(run.red), 0),
    "caused": (lambda run: run.hard_braking, 0),
    "ways": (lambda run: run.ways_taken, 0),
    "off s": (lambda run: run.off_road_s, 1),
    "stand s": (lambda run: run.standstill_s, 0),
}
"""Columns that are sums over the trips, with their digits."""


def table(rows: Sequence[Row]) -> str:
    """Return a line a kind and one for all, "this driver / SUMO's own"."""
    kinds = {kind: [row for row in rows if row.kind == kind] for kind in dict.fromkeys(row.kind for row in rows)}
    lines = [_HEAD, *(_line(kind, some) for kind, some in kinds.items()), _line("all", rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(_HEAD))]
    return "\n".join("  ".join((line[0].ljust(widths[0]), *map(str.rjust, line[1:], widths[1:]))) for line in lines)


_HEAD = ("kind", "networks", "trips", *_COUNTS, "ratio p50", "p95", "lateral", "exit > 1")


def _line(kind: str, rows: Sequence[Row]) -> tuple[str, ...]:
    ratios = [ratio for row in rows if (ratio := row.ratio) is not None]
    sums = [
        f"{sum(count(row.ours) for row in rows):.{digits}f} / {sum(count(row.sumo) for row in rows):.{digits}f}"
        for count, digits in _COUNTS.values()
    ]
    lateral = [max((run.lateral for run in side), default=0.0) for side in _sides(rows)]
    failed = sum(row.ours.exit_code > 1 for row in rows)
    networks = len({row.index for row in rows})
    return (
        kind, str(networks), str(len(rows)), *sums, _share(ratios, 50), _share(ratios, 95),
        " / ".join(f"{one:.1f}" for one in lateral), str(failed),
    )  # fmt: skip


def _sides(rows: Sequence[Row]) -> tuple[list[Run], list[Run]]:
    return [row.ours for row in rows], [row.sumo for row in rows]


def _share(values: Sequence[float], share: int) -> str:
    """Return a percentile as text, between its neighbours."""
    if len(values) < 2:
        return f"{values[0]:.2f}" if values else "–"
    return f"{statistics.quantiles(values, n=100, method='inclusive')[share - 1]:.2f}"


def faults(row: Row) -> list[str]:
    """Return in words what this driver did worse; a contact and a red light count whatever SUMO's own driver did."""
    ours, sumo, found = row.ours, row.sumo, []
    if ours.error:
        found.append(f"exit {ours.exit_code}: {ours.error}")
    elif not ours.arrived:
        found.append(f"not arrived: {ours.told}")
    found += [f"contact with {name} at {time:g} s" for time, name in ours.contacts[:TOLD]]
    found += [f"{len(ours.contacts) - TOLD} more contacts"] if len(ours.contacts) > TOLD else []
    found += [f"red light run at {time:g} s" for time in ours.red]
    if ours.hard_braking > sumo.hard_braking:
        found.append(f"{ours.hard_braking} hard brakings caused, SUMO's own {sumo.hard_braking}")
    if row.ratio is not None and row.ratio > SLOWER:
        found.append(f"takes {ours.duration_s:.1f} s, SUMO's own {sumo.duration_s:.1f} s")
    return found


def worse(rows: Iterable[Row]) -> list[Row]:
    """Return the trips where this driver is worse, smallest network first."""
    return sorted((row for row in rows if faults(row)), key=lambda row: (row.edges, row.index, row.ego))


def as_data(row: Row) -> dict[str, object]:
    """Return a row as plain data."""
    drivers = {"ours": row.ours._asdict(), "sumo": row.sumo._asdict()}
    return row._asdict() | drivers | {"ratio": row.ratio, "faults": faults(row)}
