"""Edges that share a carriageway."""

from world_pieces import lane

from sumo_reactive.driver.world.lane import nearest_opposite

OWN = lane("ab_0", [(0, 0), (100, 0)])


def test_the_oncoming_lane_right_beside_is_the_opposite():
    beside = lane("ba_0", [(100, 3.2), (0, 3.2)])
    assert nearest_opposite(OWN, [beside]) is beside


def test_a_road_behind_a_wide_median_is_no_opposite():
    assert nearest_opposite(OWN, [lane("ba_0", [(100, 9), (0, 9)])]) is None


def test_the_nearest_of_several_candidates_is_chosen():
    beside, farther = lane("ba_0", [(100, 3.2), (0, 3.2)]), lane("bc_0", [(100, 4.0), (0, 4.0)])
    assert nearest_opposite(OWN, [farther, beside]) is beside


def test_a_track_that_no_car_may_use_is_no_opposite_of_a_street():
    street = lane("ab_0", [(0, 0), (100, 0)], allowed=frozenset({"passenger"}))
    track = lane("ba_0", [(100, 3.2), (0, 3.2)], allowed=frozenset({"tram"}))
    assert nearest_opposite(street, [track]) is None
