"""What a scenario file expects, held against what a trial came to."""

import pytest
from helpers.results import result

from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.lab.check import unmet as reasons_of
from sumo_reactive.lab.check import unmet_by_several
from sumo_reactive.lab.fault import COLLISION, Fault
from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.result import NetworkResult
from sumo_reactive.lab.scenario import Expectation, Limit

CRASH = Fault(12.34, COLLISION, "veh_12", "a_0")
RED = Fault(8.0, "red light run", "", "a_0")


def unmet(expectation, result):
    """What was not met by one ego."""
    return tuple(reasons_of(expectation, result))


def fleet(faults=(), collisions=0, violations=0, stranded=()):
    """What several egos came to."""
    metrics = {"egos_collisions": collisions, "egos_violations": violations, "network_mean_speed_m_s": 7.5}
    return NetworkResult(share=0.3, metrics=metrics, by_ego=faults, departure_s=0.0, stranded=stranded)


def test_a_clean_arrival_is_what_is_expected_of_everybody():
    assert unmet(Expectation(), result()) == ()


def test_what_did_not_come_is_named():
    found = unmet(Expectation(), result(arrived=False, ended="until 35 s", faults=(RED, CRASH)))
    assert found == ("did not arrive (until 35 s)", "collision with veh_12 at 12.3 s", "red light run at 8.0 s")


def test_more_faults_may_be_allowed():
    assert unmet(Expectation(collisions=1), result(faults=(CRASH,))) == ()
    (reason,) = unmet(Expectation(collisions=1), result(faults=(CRASH, CRASH)))
    assert reason.startswith("2 collisions, expected at most 1: collision with veh_12")


def test_an_ego_may_be_expected_not_to_arrive():
    assert unmet(Expectation(arrived=False), result(arrived=False)) == ()
    assert unmet(Expectation(arrived=False), result()) == ("arrived at 35.0 s, expected not to",)


@pytest.mark.parametrize(
    ("limit", "reasons"),
    [
        (Limit(max=30.0), ()),
        (Limit(min=30.0), ()),
        (Limit(max=29.5), ("duration_s is 30, expected at most 29.5",)),
        (Limit(min=31.0, max=40.0), ("duration_s is 30, expected at least 31",)),
    ],
)
def test_a_metric_stays_within_its_limits(limit, reasons):
    assert unmet(Expectation(metrics={"duration_s": limit}), result()) == reasons


def test_a_metric_without_a_value_is_beyond_every_measure():
    nobody = result(figures={"min_post_encroachment_s": None})
    assert unmet(Expectation(metrics={"min_post_encroachment_s": Limit(min=1.0)}), nobody) == ()
    (reason,) = unmet(Expectation(metrics={"min_post_encroachment_s": Limit(max=1.0)}), nobody)
    assert reason == "min_post_encroachment_s is none, expected at most 1"


def test_every_kind_of_event_has_its_metric():
    assert {f"events_{kind.name.lower()}" for kind in EventKind} <= set(METRICS)


def test_of_several_egos_each_that_is_to_blame_is_named_and_the_rest_counted():
    assert tuple(unmet_by_several(Expectation(), fleet())) == ()
    touched = tuple((f"veh_{k}", CRASH) for k in range(5))
    lost = (("veh_7", "stood still for 600 s"),)
    found = tuple(unmet_by_several(Expectation(), fleet((*touched, ("veh_9", RED)), 5, 1, lost)))
    named = ", ".join(f"veh_{k}: collision with veh_12 at 12.3 s" for k in range(3))
    assert found == (
        "veh_7 did not arrive (stood still for 600 s)", f"5 collisions, expected at most 0: {named}, … and 2 more",
        "1 violations, expected at most 0: veh_9: red light run at 8.0 s",
    )  # fmt: skip
    assert tuple(unmet_by_several(Expectation(collisions=5, violations=1), fleet(touched, 5, 1))) == ()


def test_limits_of_several_egos_are_those_of_the_network():
    slow = Expectation(metrics={"network_mean_speed_m_s": Limit(min=8.0)})
    assert tuple(unmet_by_several(slow, fleet())) == ("network_mean_speed_m_s is 7.5, expected at least 8",)
