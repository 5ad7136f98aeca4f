"""One control step on one screen: perceive, decide, execute, advance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

from sumo_reactive.executor.executor import Execution, execute
from sumo_reactive.executor.valley_map import NO_MAP, ValleyMap, valley_map_around
from sumo_reactive.messages.completed_plan import CompletedPlan
from sumo_reactive.messages.plan import NominalPlan
from sumo_reactive.messages.snapshot import Snapshot
from sumo_reactive.messages.state import VehicleState
from sumo_reactive.messages.traffic import Traffic
from sumo_reactive.parameters import CONTROL_PERIOD_S, PAPER_CONTROL_PERIOD_S
from sumo_reactive.perception.attention import conflicts_of, in_sight
from sumo_reactive.perception.perceive import perceive
from sumo_reactive.pilot.memory import PilotMemory
from sumo_reactive.pilot.pilot import Ahead, decide
from sumo_reactive.vehicle.limits import VehicleLimits
from sumo_reactive.world.road_graph import RoadGraph
