"""Which vehicles are egos: by id, by type, by a share that depends on nothing but vehicle and seed."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.egos import EgoRule, drawn


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
    assert EgoRule(ids=("a",), probability=0.1).is_open
    assert EgoRule().is_open


@pytest.mark.parametrize("share", [-0.1, 1.1])
def test_an_impossible_share_is_refused(share):
    with pytest.raises(ScenarioError, match="share of egos"):
        EgoRule(probability=share)


def test_an_ego_named_twice_is_refused():
    with pytest.raises(ScenarioError, match="'a' is named twice"):
        EgoRule(ids=("a", "a"))
