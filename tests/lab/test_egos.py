"""Which vehicles are egos: by id, by type, by a share that depends on nothing but vehicle and seed."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.ego_rule import EgoRule, is_within, region_of
from sumo_reactive.lab.egos import drawn


@given(st.text(min_size=1, max_size=20), st.integers(0, 2**31 - 1))
def test_a_draw_is_a_share_and_the_same_each_time(name, seed):
    assert 0.0 <= drawn(name, seed) < 1.0
    assert drawn(name, seed) == drawn(name, seed)


def test_draws_are_spread_evenly():
    below = sum(drawn(f"veh{k}", 42) < 0.3 for k in range(4000))
    assert 1100 < below < 1300


def test_another_seed_draws_others():
    first, second = ([drawn(f"veh{k}", seed) < 0.5 for k in range(100)] for seed in (1, 2))
    assert first != second


def test_named_egos_leave_all_others_alone():
    assert not EgoRule(ids=("a", "b")).is_open
    assert EgoRule(types=("taxi",)).is_open
    assert EgoRule(ids=("a",), share=0.1).is_open
    assert EgoRule().is_open


@pytest.mark.parametrize("share", [-0.1, 1.1])
def test_an_impossible_share_is_refused(share):
    with pytest.raises(ScenarioError, match="share of egos"):
        EgoRule(share=share)


def test_an_ego_named_twice_is_refused():
    with pytest.raises(ScenarioError, match="'a' is named twice"):
        EgoRule(ids=("a", "a"))


corner = st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4))


@given(corner, corner, corner)
def test_a_region_is_a_rectangle_whichever_corners_name_it(one, other, place):
    (x1, y1), (x2, y2) = one, other
    corners = [(x1, y1, x2, y2), (x2, y2, x1, y1), (x1, y2, x2, y1), (x2, y1, x1, y2)]
    assert len({is_within(region, place) for region in corners}) == 1
    assert is_within(corners[0], one) and is_within(corners[0], (0.5 * (x1 + x2), 0.5 * (y1 + y2)))
    assert not is_within(corners[0], (max(x1, x2) + 1.0, y1))


def test_kinds_and_region_must_all_be_met():
    rule = EgoRule(types=("a", "b"), classes=("bus",), region=(0.0, 0.0, 10.0, 10.0))
    assert rule.is_of_kind("b", "bus", (5.0, 5.0))
    for other in (("c", "bus", (5.0, 5.0)), ("b", "taxi", (5.0, 5.0)), ("b", "bus", (11.0, 5.0))):
        assert not rule.is_of_kind(*other)
    assert EgoRule(classes=("bus",)).is_of_kind("any", "bus", (99.0, 99.0))


def test_a_rule_that_names_kinds_and_no_share_means_all_of_them():
    assert EgoRule(types=("a",)).drawn_share == EgoRule(region=(0.0, 0.0, 1.0, 1.0)).drawn_share == 1.0
    assert EgoRule(types=("a",), share=0.2).drawn_share == 0.2 and EgoRule().drawn_share == 0.0


@pytest.mark.parametrize("region", [(1.0, 2.0), (1.0, 2.0, 3.0, 4.0, 5.0)])
def test_a_region_of_other_than_four_numbers_is_refused(region):
    with pytest.raises(ScenarioError, match="a region is a rectangle"):
        region_of(region)


def test_a_region_without_an_end_is_refused():
    with pytest.raises(ScenarioError, match="region of egos"):
        EgoRule(region=(0.0, 0.0, float("inf"), 1.0))
