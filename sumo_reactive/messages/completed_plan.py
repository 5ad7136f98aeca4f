"""The completed plan P⁺ = P with adjusted time constraints and symbolic instructions (F&L 1991, §1.3)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from sumo_reactive.messages.decision import Behaviour, Decision, Leader, StopAt
from sumo_reactive.messages.plan import NominalPlan, TimeConstraint


class Intent(Enum):
    """What a standing or creeping ego tells the others: it drives, it yields, or it goes next."""

    DRIVE = "drive"
    YIELD = "yield"
    GO_NEXT = "go next"


@dataclass(frozen=True, slots=True)
class Weights:
    """Weights w₁, w₂, w₃ of U = w₁U₁ + w₂U₂ + w₃U₃ (per m, dimensionless, per m/s)."""

    valley: float
    shadow: float
    velocity: float


@dataclass(frozen=True, slots=True)
class CompletedPlan:
    """P⁺: what the executor tracks until the pilot says otherwise.

    `target` is the next (l, t_l); `stop` the nearest place to stop at; `leaders` every vehicle to stay behind;
    `change_lane` asks the planner for a curve that begins the change now (+1 left, −1 right, 0 none); `slot` is the
    vehicle on the other lane to fall in behind, which bounds the desired speed but no safety.
    """

    plan: NominalPlan
    behaviour: Behaviour
    target: TimeConstraint
    stop: StopAt | None
    leaders: tuple[Leader, ...]
    weights: Weights
    intent: Intent
    decisions: tuple[Decision, ...]
    change_lane: int = 0
    slot: Leader | None = None
