"""Why a case failed: who suffered, what had been judged of him, and what came of it."""

from pathlib import Path

import pytest
from helpers.results import result

from sumo_reactive.driver.nouns.assessment import NOT_ASSESSED
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Reason
from sumo_reactive.lab.check import Case, Verdict
from sumo_reactive.lab.fault import COLLISION, HARD_BRAKING, Fault
from sumo_reactive.lab.scenario import Expectation, Scenario
from sumo_reactive.lab.task import Ending, Outcome
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show.faults import failure_told, fault_told, judgement_of


def entry(time, *decisions):
    return Entry(time, (), NOT_ASSESSED, Behaviour.CAUTIOUS, Instruction.APPROACH, decisions)


def meeting(passes, own, other, cause="veh_12"):
    """Return a decision about a region in which `own` and `other` would be from the first to the second number, s."""
    names = ("arrival_s", "clearance_s", "foe_arrival_s", "foe_clearance_s")
    figures = tuple(zip(names, (*own, *other), strict=True))
    return Decision(
        behaviour=Behaviour.CAUTIOUS, reason=Reason.YIELD_TO, region="J3_4x7", cause=cause, passes=passes, figures=figures
    )


BEFORE = entry(38.4, meeting(True, (2.0, 3.1), (4.2, 5.0)))
"""The ego goes before the other: clear at 41.5 s, the other there at 42.6 s."""


def test_a_gap_that_was_smaller_than_judged():
    told = fault_told(Fault(41.3, COLLISION, "veh_12", "a_0"), [BEFORE])
    assert told.startswith("ran into veh_12 at 41.3 s; at 38.4 s the ego judged: goes before veh_12")
    assert told.endswith("judged the gap 4.2 s, it was 2.9 s")


@pytest.mark.parametrize(
    ("fault", "did", "came"),
    [
        (Fault(43.4, COLLISION, "veh_12", ""), "ran into", "the ego was still there after 5.0 s"),
        (
            Fault(41.0, "right of way taken", "veh_12", ""),
            "got into the way of",
            "it suffered after 2.6 s, 1.6 s before it was expected there, 0.5 s before the ego was to be clear",
        ),
        (Fault(42.0, HARD_BRAKING, "veh_12", ""), "made veh_12 brake hard", "when the ego was late by 0.5 s"),
        (Fault(43.4, HARD_BRAKING, "veh_12", ""), "made veh_12 brake hard", "the ego was still there after 5.0 s"),
    ],
)
def test_what_came_is_compared_with_the_judgement(fault, did, came):
    told = fault_told(fault, [BEFORE])
    assert told.startswith(did) and told.endswith(came)


def test_the_judgement_is_the_last_by_which_the_ego_went_on_not_long_before():
    fault = Fault(41.3, COLLISION, "veh_12", "a_0")
    stops = entry(41.0, meeting(False, (0.5, 2.0), (0.3, 1.0)))
    others = entry(39.0, meeting(True, (1.0, 2.0), (5.0, 6.0), cause="veh_3"))
    later = entry(41.4, meeting(True, (1.0, 2.0), (5.0, 6.0)))
    assert judgement_of(fault, [BEFORE, others, stops, later]).time == 38.4
    assert judgement_of(fault, [entry(2.0, *BEFORE.decisions), stops]).time == 41.0
    assert judgement_of(fault, [others]) is None


def test_somebody_of_whom_nothing_was_decided():
    hit = Fault(41.3, COLLISION, "veh_12", "a_0")
    assert fault_told(hit, []) == "ran into veh_12 at 41.3 s; no decision before speaks of it"
    assert fault_told(Fault(8.0, "red light run", "", "a_0"), []) == "at 8.0 s: red light run"


def failed(entries, **others):
    scenario = Scenario(config=Path("a.sumocfg"), seed=7, source=Path("a.toml"))
    case = Case(scenario, Expectation())
    return Verdict(
        case, Outcome(task=case.task, ending=Ending.DONE, result=result(**others), reason="", entries=tuple(entries)),
        ("why not",),
    )  # fmt: skip


def test_a_failure_tells_reasons_faults_the_trace_before_and_the_replay():
    crash = Fault(41.3, COLLISION, "veh_12", "a_0")
    trace = [entry(float(time)) for time in range(5)] + [BEFORE, entry(50.0)]
    reason, fault, *lines, replay = failure_told(failed(trace, faults=(crash,)))
    assert (reason, replay) == ("why not", "replay: sumo-reactive run a.toml --seed 7")
    assert fault.startswith("ran into veh_12") and fault.endswith(":")
    assert [line.split()[0] for line in lines] == ["3.0", "4.0", "38.4"]
    assert "Cautious driving" in lines[-1]


def test_a_failure_without_a_fault_shows_the_last_decisions():
    _, label, *lines, _ = failure_told(failed([entry(float(time)) for time in range(5)]))
    assert label == "the last decisions:"
    assert [line.split()[0] for line in lines] == ["2.0", "3.0", "4.0"]


def test_an_ego_that_was_late_shows_what_it_waited_for_longest():
    stops, goes = meeting(False, (2.0, 3.1), (2.2, 5.0)), meeting(True, (2.0, 3.1), (4.2, 5.0))
    trace = [entry(1.0, stops), entry(2.0, goes), entry(9.0, stops), entry(12.0), entry(13.0, goes, stops), entry(15.0)]
    _, label, *lines, _ = failure_told(failed([*trace, entry(20.0, stops)]))
    assert label == "what it waited for longest:"
    assert [line.split()[0] for line in lines] == ["9.0", "13.0", "20.0"]


def test_many_faults_are_not_all_told():
    faults = tuple(Fault(float(time), COLLISION, "veh_12", "a_0") for time in range(5))
    assert "… and 2 more" in failure_told(failed([BEFORE], faults=faults))


def test_a_case_that_crashed_has_reason_and_replay_only():
    case = failed([]).case
    verdict = Verdict(case, Outcome(task=case.task, ending=Ending.CRASHED, reason="killed"), ("crashed: killed",))
    assert list(failure_told(verdict)) == ["crashed: killed", "replay: sumo-reactive run a.toml --seed 7"]
