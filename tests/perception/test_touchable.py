"""Whose turning matters: who moves, near and not behind."""

import math

import numpy as np

from sumo_reactive.perception.corridor import touchable


def box(x: float, y: float, speed: float = 10.0) -> tuple[float, ...]:
    return x, y, math.pi, speed, 5.0, 1.8, 0.0


def test_who_is_near_and_moves_ahead_can_be_touched_and_nobody_else():
    ahead, standing, behind, far = box(15.0, 3.0), box(15.0, 3.0, 0.0), box(-15.0, 0.0), box(40.0, 0.0)

    found = touchable(np.array([behind, standing, ahead, far]), 0.0, 0.0, 0.0, 10.0, 5.0)

    assert found.tolist() == [2]


def test_nobody_is_there():
    assert len(touchable(np.empty((0, 7)), 0.0, 0.0, 0.0, 10.0, 5.0)) == 0
