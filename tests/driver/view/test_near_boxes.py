"""Who is near, and whose turning matters: who moves, and is not behind."""

import math

import numpy as np

from sumo_reactive.driver.nouns.snapshot import NEAR_M
from sumo_reactive.driver.view.corridor import near_boxes


def box(x: float, y: float, speed: float = 10.0) -> tuple[float, ...]:
    return x, y, math.pi, speed, 5.0, 1.8


def test_who_is_near_and_moves_ahead_can_be_touched_and_nobody_else():
    ahead, standing, behind, far = box(15.0, 3.0), box(15.0, 3.0, 0.0), box(-15.0, 0.0), box(40.0, 0.0)

    near, touchable = near_boxes(np.array([behind, standing, ahead, far]), 0.0, 0.0, 0.0, 10.0, 5.0)

    assert len(near) == 4
    assert touchable.tolist() == [[2, 2]]


def test_who_is_not_near_is_left_out_and_the_others_are_found_again():
    beyond, ahead = box(NEAR_M, 0.1), box(15.0, 3.0)

    near, touchable = near_boxes(np.array([beyond, ahead]), 0.0, 0.0, 0.0, 10.0, 5.0)

    assert near.tolist() == [[*ahead, 0.0, math.inf]]
    assert touchable.tolist() == [[0, 1]]


def test_nobody_is_there():
    near, touchable = near_boxes(np.empty((0, 6)), 0.0, 0.0, 0.0, 10.0, 5.0)

    assert near.shape == (0, 8)
    assert len(touchable) == 0
