"""What each symbolic instruction changes in the executor: weights of U, velocity profile, command grid.

The paper finds its coefficients by hand and names that as open (F&L 1991, §4); so are these, each with its reason.
"""

from __future__ import annotations

from sumo_reactive.driver.nouns.completed_plan import Tuning, VelocityProfile, Weights
from sumo_reactive.driver.nouns.decision import Instruction

PASSING_HEADWAY = 0.6
"""Share of the driver's time headway kept to X while pulling out."""

_USUAL = Weights(valley=10.0, shadow=100.0, velocity=1.0)
_WEAKENED = Weights(valley=4.0, shadow=150.0, velocity=1.0)
_CALM = VelocityProfile()

TUNINGS: dict[Instruction, Tuning] = {
    # 0.1 m beside C weighs as much as 1 m/s of speed: C is kept through every bend. U₂ knows no speed, only where in its
    # lane the ego drives: there it leans away from a body which it would pass within a second nearer than 1.1 m
    Instruction.FOLLOW_CURVE: Tuning(_USUAL, _CALM),
    Instruction.APPROACH: Tuning(_USUAL, _CALM),
    Instruction.STOP: Tuning(_USUAL, _CALM),
    Instruction.CROSS: Tuning(_USUAL, _CALM),
    # the attraction of C gives way, U₂ counts three times as much, and the gap behind X may close while pulling out
    Instruction.OVERTAKE: Tuning(_WEAKENED, VelocityProfile(headway=PASSING_HEADWAY)),
    Instruction.RETURN: Tuning(_USUAL, _CALM),
    # behind X again soon: brake a third harder than in comfort, keep the whole headway
    Instruction.FALL_BACK: Tuning(_USUAL, VelocityProfile(deceleration=1.35)),
    Instruction.BACK_UP: Tuning(_USUAL, VelocityProfile(acceleration=0.4)),
    Instruction.TURN_ROUND: Tuning(_USUAL, VelocityProfile(acceleration=0.8)),
    # a standing ego that finds no way down U looks at more commands, and C holds it less
    Instruction.WIDEN: Tuning(_WEAKENED, _CALM, wide_grid=True),
}

_PAPER_USUAL = Weights(valley=15.0, shadow=0.3, velocity=1.0)
"""Nine commands keep to C only if U₁ outweighs a step of speed."""

PAPER_TUNINGS: dict[Instruction, Tuning] = {
    instruction: Tuning(
        _PAPER_USUAL if tuning.weights is _USUAL else Weights(valley=8.0, shadow=1.0, velocity=1.0), tuning.profile
    )
    for instruction, tuning in TUNINGS.items()
}
