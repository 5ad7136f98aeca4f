"""Which vehicles of a scenario are egos."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.sumo.config import SumoConfig
from sumo_reactive.sumo.session import Progress, Session, is_road_car, type_of
from sumo_reactive.sumo.vehicle_type import Equipment

EGO = "ego"
"""Without an ego's id, a vehicle or type of this name is driven."""


@dataclass(frozen=True)
class EgoRule:
    """Every vehicle of these `ids` and `types`, and a share `probability` of all road cars, is an ego.

    What a vehicle or its type says of itself (`has.reactive.device`, `device.reactive.probability`) comes before the share.
    The same vehicle of the same seed is always drawn alike. A rule without anything leaves it to the vehicles.
    """

    ids: tuple[str, ...] = ()
    types: tuple[str, ...] = ()
    probability: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.probability <= 1.0:
            raise ScenarioError(f"the share of egos is {self.probability:g}, not within 0 and 1")
        twice = [name for name in self.ids if self.ids.count(name) > 1]
        if twice:
            raise ScenarioError(f"ego '{twice[0]}' is named twice")

    @property
    def is_open(self) -> bool:
        """Whether vehicles that are not named may be egos."""
        return bool(self.types or self.probability) or not self.ids

    def chooses(self, vehicle_id: str, equipment: Equipment, seed: int) -> bool:
        """Whether a vehicle that has just departed is an ego."""
        if vehicle_id in self.ids:
            return True
        if not self.is_open or not is_road_car(vehicle_id):
            return False
        if type_of(vehicle_id) in self.types:
            return True
        share = equipment.share(vehicle_id)
        return drawn(vehicle_id, seed) < (self.probability if share is None else share)


def drawn(vehicle_id: str, seed: int) -> float:
    """Return a number in [0, 1) that depends on vehicle and seed alone, not on who else departs, or when."""
    digest = hashlib.sha256(f"{seed}:{vehicle_id}".encode()).digest()
    return int.from_bytes(digest[:8]) / 2.0**64


def find_ego(session: Session, scenario: Scenario, config: SumoConfig, progress: Progress | None) -> tuple[str, str]:
    """Step until the one ego of a scenario departs; return its id and how it was chosen."""
    if scenario.ego is not None:
        name = scenario.ego
        found = session.wait_for(lambda vehicle_id: vehicle_id == name, scenario.until_s, progress, name)
        chosen = "as named"
    elif config.mentions((b'id="ego"', b'type="ego"')):
        found = session.wait_for(lambda vehicle_id: EGO in (vehicle_id, type_of(vehicle_id)), scenario.until_s, progress)
        chosen = f"vehicle or type '{EGO}'"
    else:
        found = session.wait_for(is_road_car, scenario.until_s, progress)
        chosen = "the first car to depart"
    if found:
        return found, chosen
    if scenario.ego is not None:
        raise ScenarioError(f"{scenario.source}: {session.why_not(scenario.ego)}")
    raise ScenarioError(f"{scenario.source}: no car departs before {session.time:.1f} s")
