"""The manoeuvre that passes somebody, as the pilot simulates it."""

import numpy as np
import pytest
from helpers.curves import plan_along, straight

from sumo_reactive.driver.pilot.assessment import way_of
from sumo_reactive.driver.pilot.manoeuvre import displaced


@pytest.mark.parametrize(("start", "reached"), [(-5.0, 2.0), (2.0, 0.0)])
def test_a_way_is_moved_aside_from_a_place_on_and_not_at_all_where_it_ends_before_that(start, reached):
    way = way_of(plan_along(straight()))
    length = way.step * (len(way.x) - 1)
    moved = displaced(way, np.full(len(way.x), 2.0), length + start)
    aside = np.hypot(moved.x - way.x, moved.y - way.y)
    assert aside[-1] == pytest.approx(reached, abs=1e-6)
    assert aside[0] == 0.0
