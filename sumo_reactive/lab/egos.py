"""Who of those that depart is an ego."""

from __future__ import annotations

import hashlib

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.scenario import Scenario
from sumo_reactive.sumo.config import SumoConfig
from sumo_reactive.sumo.session import Progress, Session, class_and_place_of, is_road_car, type_of
from sumo_reactive.sumo.vehicle_type import Equipment

EGO = "ego"
"""Without an ego's id, a vehicle or type of this name is driven."""


def chooses(rule: EgoRule, vehicle_id: str, equipment: Equipment, seed: int) -> bool:
    """Whether a vehicle that has just departed is an ego."""
    if vehicle_id in rule.ids:
        return True
    if not rule.is_open or not is_road_car(vehicle_id):
        return False
    if rule.names_kinds and not rule.is_of_kind(type_of(vehicle_id), *class_and_place_of(vehicle_id)):
        return False
    share = equipment.share(vehicle_id)
    return drawn(vehicle_id, seed) < (rule.drawn_share if share is None else share)


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
