"""A run told in sentences: every reason has its words, and each names the road user behind it."""

import json
import math
from dataclasses import replace

import pytest

from sumo_reactive.driver.nouns.assessment import NOT_ASSESSED, Assessment, Encounter, PlanOutcome
from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Instruction, Reason
from sumo_reactive.driver.nouns.event import Event, EventKind
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.trace import Entry, entry_of, line_of
from sumo_reactive.show.explain import about, brief, decision_told, footer, in_short, paragraph, story
from sumo_reactive.show.recording import Recording, read_run
from sumo_reactive.show.sentences import BEHAVIOURS, EVENTS, INSTRUCTIONS, OUTCOMES, REASONS


def entry(time=0.0, **others):
    values = {
        "events": (),
        "assessment": NOT_ASSESSED,
        "behaviour": Behaviour.CAUTIOUS,
        "instruction": Instruction.APPROACH,
        "decisions": (),
    }
    return Entry(time, **(values | others))


def meeting(passes, own, other, reason=Reason.YIELD_TO):
    """Return a decision about a region in which `own` and `other` would be from the first to the second number, s."""
    names = ("arrival_s", "clearance_s", "foe_arrival_s", "foe_clearance_s")
    return Decision(
        behaviour=Behaviour.CAUTIOUS, reason=reason, region="J3_4x7", cause="veh_12", passes=passes,
        figures=tuple(zip(names, (*own, *other), strict=True)),
    )  # fmt: skip


def told(decision, instruction=Instruction.STOP):
    return decision_told(decision, instruction)


@pytest.mark.parametrize(
    ("table", "choices"),
    [
        (EVENTS, EventKind),
        (OUTCOMES, PlanOutcome),
        (BEHAVIOURS, Behaviour),
        (INSTRUCTIONS, Instruction),
        (REASONS, Reason),
    ],
    ids=lambda one: getattr(one, "__name__", "table"),
)
def test_every_choice_has_its_words(table, choices):
    assert set(table) == set(choices)


@pytest.mark.parametrize("passes", [False, True])
@pytest.mark.parametrize("reason", Reason)
def test_every_reason_makes_a_clause_with_and_without_a_cause(reason, passes):
    for cause in ("veh_12", ""):
        clause = told(Decision(behaviour=Behaviour.CAUTIOUS, reason=reason, region="J3_4x7", cause=cause, passes=passes))
        assert clause and "{" not in clause and "  " not in clause


def test_going_on_into_a_touch_leads_to_a_stop_before_the_region():
    new = entry(
        41.3,
        events=(Event(EventKind.NEW_OBSTACLE, "veh_12"), Event(EventKind.NEW_OBSTACLE, "veh_13")),
        assessment=Assessment(PlanOutcome.FAILURE, 0.0, 90.0, Encounter("veh_12", 44.1, 60.0, 0.0, 0.0)),
        instruction=Instruction.STOP,
        decisions=(meeting(False, (2.5, 4.2), (2.9, 3.8)),),
    )
    assert paragraph(new) == (
        "A new obstacle is ahead (veh_12, veh_13). Going on would touch veh_12 at 44.1 s. "
        "Cautious driving: stops before region J3_4x7, since veh_12 has priority "
        "(it would be there in 2.9 s, the ego would leave after 4.2 s)."
    )


@pytest.mark.parametrize(
    ("passes", "own", "other", "words"),
    [
        (True, (2.0, 3.1), (5.2, 6.0), "goes before veh_12, which has priority, through {region} (it arrives in 5.2 s"),
        (True, (4.0, 5.0), (1.0, 2.0), "goes after veh_12, which has priority, through {region} (it has cleared after 2.0"),
        (True, (2.0, 9.0), (5.0, 6.0), "goes before veh_12, which has priority, through {region} (it arrives in 5.0 s, the"),
        (False, (2.0, 3.0), (3.5, 4.0), "(the ego would leave after 3.0 s and it arrive in 3.5 s: too close)"),
        (False, (5.0, 6.0), (3.5, 4.9), "(it would leave after 4.9 s and the ego arrive in 5.0 s: too close)"),
        (False, (2.0, 6.0), (0.0, 1.5), "(it leaves after 1.5 s, the ego would be there in 2.0 s)"),
        (False, (2.0, 6.0), (math.inf, math.inf), "since veh_12 has priority"),
    ],
)
def test_who_goes_first_follows_from_the_figures(passes, own, other, words):
    assert words.replace("{region}", "region J3_4x7") in told(meeting(passes, own, other))


def test_a_yellow_light_too_close_is_passed_with_the_braking_that_it_would_take():
    figures = (("to_line_m", 8.0), ("braking_needed_m_s2", 7.25))
    clause = told(Decision(
        behaviour=Behaviour.CROSSING, reason=Reason.YELLOW_TOO_CLOSE, region="", cause="tl", passes=True, figures=figures,
    ))  # fmt: skip
    assert clause == (
        "goes on, since light tl is yellow but the line too close to stop (8.0 m away, which would take 7.2 m/s²)"
    )


def test_an_overtaking_is_told_from_pulling_out_to_being_back():
    passing = Decision(behaviour=Behaviour.OVERTAKING, reason=Reason.SLOW_AHEAD, cause="slow", passes=True)
    out = entry(behaviour=Behaviour.OVERTAKING, instruction=Instruction.OVERTAKE, decisions=(passing,))
    back = out._replace(instruction=Instruction.RETURN)
    after = entry(behaviour=Behaviour.NORMAL, instruction=Instruction.FOLLOW_CURVE)
    assert in_short(out) == (
        "Overtaking: pulls out to pass; slow is slow or has halted, and the simulated pass meets nobody."
    )
    assert in_short(back) == "Overtaking: returns to C; slow is passed."
    assert paragraph(after, back).endswith("The ego is back on C. Normal driving: follows C.")


def test_a_region_is_named_once_and_a_road_user_once():
    far = meeting(False, (6.0, 9.0), (7.0, 8.0))
    other = Decision(behaviour=Behaviour.CROSSING, reason=Reason.YIELD_TO, region="J3_4x7", cause="veh_9", passes=True)
    text = in_short(entry(decisions=(other, far, meeting(False, (5.0, 9.0), (7.0, 8.0))), instruction=Instruction.STOP))
    assert text == (
        "Cautious driving: stops before region J3_4x7, since veh_12 has priority; "
        "goes before veh_9, which has priority, through the same region."
    )


def test_an_emergency_is_told():
    assert "No command is admissible: the ego brakes as hard as it can along C. " in paragraph(entry(emergency=True))


def test_what_an_emergency_is_for_is_told():
    text = paragraph(entry(emergency=True, hazard="veh_12"))
    assert "An emergency: milder braking than this would not stop the ego clear of veh_12. " in text
    assert entry_of(line_of(entry(emergency=True, hazard="veh_12"))).hazard == "veh_12"


def test_the_footer_tells_what_activated_the_pilot_most_often_first():
    figures = {"pilot_activations": 6, "pilot_free_share": 0.934}
    figures |= {"events_light_change": 2, "events_new_obstacle": 4}
    assert footer(figures) == (
        "The pilot decided 6 times; 93 % of the steps went without it. "
        "What activated it: a new obstacle is ahead (4), a light changes (2)."
    )
    assert footer({"pilot_free_share": None}) == "The pilot decided 0 times."


def test_a_run_without_entries_has_a_header_and_a_footer(tmp_path):
    summary = {"ego": "cab", "scenario": "a.toml", "verdict": "did not arrive", "figures": {}}
    assert list(story(Recording(folder=tmp_path, summary=summary, entries=()))) == [
        "cab in a.toml: did not arrive.",
        "The pilot decided 0 times.",
    ]


@pytest.mark.parametrize("summary", ["[]", "{", '{"ego": "cab"}'])
def test_a_folder_with_another_summary_is_refused(tmp_path, summary):
    (tmp_path / "decisions.jsonl").write_text(json.dumps(line_of(entry())), encoding="utf-8")
    (tmp_path / "trajectory.parquet").touch()
    (tmp_path / "summary.json").write_text(summary, encoding="utf-8")
    with pytest.raises(ScenarioError, match="not the summary of a run"):
        read_run(tmp_path)


def recorded(folder, *entries):
    """Return a run with these entries."""
    return Recording(folder=folder, summary={"ego": "ego", "scenario": "s.toml", "verdict": "arrived"}, entries=entries)


def test_in_brief_a_behaviour_is_a_line_with_each_of_its_reasons_once_and_stops_first(tmp_path):
    goes, waits = meeting(True, (5.0, 8.0), (1.0, 2.0)), meeting(False, (5.0, 8.0), (6.0, 9.0))
    later = replace(waits, region="J9", figures=())
    others = [replace(waits, cause=f"veh_{k}") for k in (20, 21, 22)]
    entries = (
        entry(1.0, decisions=(goes,)),
        entry(2.0, decisions=(waits,)),
        entry(3.0, decisions=(later, *others)),
        entry(4.0, behaviour=Behaviour.NORMAL, instruction=Instruction.FOLLOW_CURVE),
    )
    _, cautious, normal = brief(recorded(tmp_path, *entries))
    assert cautious.startswith("1.0 s  Cautious driving: stops before region J3_4x7, since veh_12 has priority; stops")
    assert "J9" not in cautious and "(" not in cautious
    assert cautious.endswith("; and 2 more.")
    assert normal == "4.0 s  Normal driving: follows C."


def test_all_that_names_a_road_user_is_told_about_him_and_nothing_else(tmp_path):
    meets = Assessment(PlanOutcome.FAILURE, 0.0, 0.0, Encounter("veh_12", 7.5, 0.0, 0.0, 0.0))
    waits = meeting(False, (5.0, 8.0), (6.0, 9.0))
    entries = (
        entry(1.0, events=tuple(Event(EventKind.NEW_OBSTACLE, one) for one in ("veh_12", "veh_9")), assessment=meets),
        entry(2.0, decisions=(waits, replace(waits, cause="veh_9"))),
        entry(3.0, emergency=True, hazard="veh_12"),
        entry(4.0, decisions=(replace(waits, cause="veh_9"),)),
    )
    head, *lines = about(recorded(tmp_path, *entries), "veh_12")
    assert head == "ego in s.toml: arrived."
    assert [line.split()[0] for line in lines] == ["1.0", "2.0", "3.0"]
    assert "veh_12" in lines[0] and "7.5 s" in lines[0]
    assert lines[1].startswith("2.0 s  The ego stops before region J3_4x7, since veh_12 has priority (")
    assert not any("veh_9" in line for line in lines)
    with pytest.raises(ScenarioError, match="nothing was decided about 'veh_13'; near it: veh_12"):
        list(about(recorded(tmp_path, *entries), "veh_13"))
