"""Which vehicles of a scenario are egos, as people ask for it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sumo_reactive.errors import ScenarioError

Region = tuple[float, float, float, float]
"""x and y of one corner of a rectangle, and of the opposite one, m."""


@dataclass(frozen=True, kw_only=True)
class EgoRule:
    """Every vehicle of these `ids`, and a `share` of all road cars, is an ego: of those of these `types` and vehicle
    `classes` that depart within `region`, as far as these are named; a rule that names some and no share means all of them.

    What a vehicle or its type says of itself (`has.reactive.device`, `device.reactive.probability`) comes before the share.
    The same vehicle of the same seed is always drawn alike. A rule without anything leaves it to the vehicles.
    """

    ids: tuple[str, ...] = ()
    types: tuple[str, ...] = ()
    classes: tuple[str, ...] = ()
    region: Region | None = None
    share: float | None = None

    def __post_init__(self) -> None:
        if self.share is not None and not 0.0 <= self.share <= 1.0:
            raise ScenarioError(f"the share of egos is {self.share:g}, not within 0 and 1")
        if self.region is not None and not all(map(math.isfinite, self.region)):
            raise ScenarioError(f"the region of egos is {region_text(self.region)}, not four numbers of metres")
        twice = [name for name in self.ids if self.ids.count(name) > 1]
        if twice:
            raise ScenarioError(f"ego '{twice[0]}' is named twice")

    @property
    def names_kinds(self) -> bool:
        """Whether only vehicles of some kinds, or of a region, can be drawn."""
        return bool(self.types or self.classes or self.region)

    @property
    def drawn_share(self) -> float:
        """The share that is drawn among those that can be."""
        return float(self.names_kinds) if self.share is None else self.share

    @property
    def is_open(self) -> bool:
        """Whether vehicles that are not named may be egos."""
        return bool(self.drawn_share) or not self.ids

    def is_of_kind(self, type_id: str, vehicle_class: str, place: tuple[float, float]) -> bool:
        """Whether a vehicle of a type and class that departs at a place (x, y, m) can be drawn."""
        is_named = type_id in (self.types or (type_id,)) and vehicle_class in (self.classes or (vehicle_class,))
        return is_named and (self.region is None or is_within(self.region, place))

    def __str__(self) -> str:
        said = {"ego": self.ids, "type": self.types, "class": self.classes}
        words = [f"{name} {', '.join(values)}" for name, values in said.items() if values]
        words += [f"region {region_text(self.region)}"] if self.region else []
        return "; ".join([*words, *([] if self.share is None else [f"share {self.share:g}"])])


def is_within(region: Region, place: tuple[float, float]) -> bool:
    """Whether a place (x, y, m) lies in a rectangle or on its edge, whichever corners name it."""
    (x, y), (x1, y1, x2, y2) = place, region
    return min(x1, x2) <= x <= max(x1, x2) and min(y1, y2) <= y <= max(y1, y2)


def region_of(values: Sequence[float]) -> Region:
    """Return a rectangle by its four numbers; raise ScenarioError for another many."""
    if len(values) != 4:
        raise ScenarioError(f"a region is a rectangle by two corners, x1, y1, x2, y2; {len(values)} numbers are given")
    x1, y1, x2, y2 = values
    return x1, y1, x2, y2


def region_text(region: Region) -> str:
    """Return a rectangle as the command line takes it."""
    return ",".join(f"{value!r}" for value in region)


def several(rule: EgoRule) -> EgoRule | None:
    """Return a rule that asks for more than one ego that is named, or for none; else None."""
    return rule if len(rule.ids) > 1 or rule.names_kinds or rule.share is not None else None
