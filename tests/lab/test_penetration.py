"""A share of all cars as egos: who is one, what is counted, and that a run gives the same again."""

from dataclasses import replace
from pathlib import Path

import pytest

from sumo_reactive.lab import penetration
from sumo_reactive.lab.ego_rule import EgoRule
from sumo_reactive.lab.fault import COLLISION, Fault
from sumo_reactive.lab.fundamental_diagram import EVERY_CLASS, CountedEdges
from sumo_reactive.lab.metric_names import NETWORK
from sumo_reactive.lab.penetration import contact_count, run_share
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.task import Task
from tests.helpers.results import result

SCENARIO = Path(__file__).parents[2] / "scenarios" / "right_before_left.toml"
UNTIL_S = 40.0


def shared(share, seed=3, counted=EVERY_CLASS, **others):
    """What a run with a share of egos comes to."""
    scenario = replace(load_scenario(SCENARIO), seed=seed, until_s=UNTIL_S, egos=EgoRule(share=share), **others)
    return run_share(Task(scenario, counted))


@pytest.fixture(scope="module")
def runs():
    """Runs by their share."""
    return {share: shared(share) for share in (0.0, 0.3, 1.0)}


def test_every_figure_of_a_network_is_told(runs):
    for run in runs.values():
        assert list(run["network"].metrics) == list(NETWORK)


def test_a_higher_share_adds_egos_to_the_same_traffic(runs):
    egos = [run["network"].metrics["egos"] for run in runs.values()]
    assert egos[0] == 0 < egos[1] < egos[2]
    assert len({run["network"].metrics["network_vehicles"] for run in runs.values()}) == 1
    assert egos[2] == runs[1.0]["network"].metrics["network_vehicles"]


def test_a_higher_share_keeps_every_ego_of_a_lower_one(monkeypatch):
    egos, run_fleet = [], penetration.run_fleet

    def noted(*asked, **options):
        fleet = run_fleet(*asked, **options)
        egos.append({one.ego for one in fleet.results})
        return fleet

    monkeypatch.setattr(penetration, "run_fleet", noted)
    for share in (0.2, 0.5, 1.0):
        shared(share)
    few, half, every = egos
    assert set() < few < half < every


def touching(ego, *others):
    """The result of an ego that touched others, one after the other."""
    faults = tuple(Fault(float(k), COLLISION, other, "lane") for k, other in enumerate(others))
    return result(ego=ego, faults=faults, figures={"near_misses_by_ttc": 0, "near_misses_by_pet": 0})


def test_a_contact_between_two_egos_counts_once():
    assert contact_count([touching("a", "b"), touching("b", "a")]) == 1
    assert contact_count([touching("a", "b", "b"), touching("b", "a", "a")]) == 2
    assert contact_count([touching("a", "b"), touching("b")]) == contact_count([touching("a"), touching("b", "a")]) == 1


def test_contacts_with_others_than_egos_count_each():
    assert contact_count([touching("a", "x", "b"), touching("b", "x", "a")]) == 3
    assert contact_count([touching("a"), touching("b")]) == contact_count([]) == 0


def test_the_contacts_of_egos_are_counted_once_in_the_figures_of_a_network(monkeypatch):
    run_fleet = penetration.run_fleet

    def bumped(*asked, **options):
        fleet = run_fleet(*asked, **options)
        return replace(fleet, results=(touching("a", "b"), touching("b", "a")))

    monkeypatch.setattr(penetration, "run_fleet", bumped)
    assert shared(0.0)["network"].metrics["egos_collisions"] == 1


def test_what_nobody_has_is_none_and_what_all_have_is_not(runs):
    assert runs[0.0]["network"].metrics["egos_mean_duration_s"] is None
    assert runs[1.0]["network"].metrics["egos_mean_duration_s"] > 5.0
    assert runs[0.0]["network"].metrics["network_mean_speed_m_s"] > 1.0


def test_the_same_share_gives_the_same_run_and_another_share_another(runs):
    again = shared(0.3)
    assert (again["network"], again["trajectory"]) == (runs[0.3]["network"], runs[0.3]["trajectory"])
    assert len({run["trajectory"] for run in runs.values()}) == 3


def test_arrivals_are_those_of_sumo_and_of_the_egos(runs):
    metrics = runs[1.0]["network"].metrics
    assert metrics["egos_arrived"] == metrics["network_arrived"] > 0
    assert metrics["network_arrivals_per_h"] == pytest.approx(3600.0 * metrics["network_arrived"] / UNTIL_S, rel=1e-3)
    assert "egos among" in runs[1.0]["network"].verdict


def test_the_diagram_tells_of_each_interval_and_the_last_one_ends_with_the_run():
    points = shared(1.0, counted=CountedEdges(30.0))["network"].diagram
    assert [(one.edges, one.begin_s, one.end_s) for one in points] == [("street", 0.0, 30.0), ("street", 30.0, UNTIL_S)]
    for one in points:
        assert one.flow_per_h == pytest.approx(3.6 * one.density_per_km * one.speed_m_s, rel=1e-3) and one.flow_per_h > 10.0


def test_a_cut_counts_egos_and_others_alike_and_counting_changes_no_run(runs):
    into = CountedEdges(cuts=(("into", ("from_north", "from_east", "from_south", "from_west")), ("out", ("to_north",))))
    for share in (0.0, 1.0):
        run = shared(share, counted=into)
        assert run["trajectory"] == runs[share]["trajectory"]
        metrics = run["network"].metrics
        assert list(metrics)[-2:] == ["cut_into_per_h", "cut_out_per_h"]
        passed = metrics["cut_into_per_h"] * UNTIL_S / 3600.0
        assert passed == pytest.approx(round(passed)) and metrics["network_arrived"] <= passed <= metrics["network_vehicles"]


def test_an_option_of_the_experiment_goes_beside_those_that_count():
    more = shared(0.0, sumo_options=("--scale", "2"))["network"].metrics["network_vehicles"]
    assert more > shared(0.0)["network"].metrics["network_vehicles"]
