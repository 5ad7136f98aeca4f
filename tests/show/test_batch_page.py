"""The page of a batch: what its tables and figures are made from."""

import re

import pytest
from helpers.stores import made_store, trial

from sumo_reactive.lab.batch.store import Store
from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.lab.fault import COLLISION, Fault
from sumo_reactive.show.batch_figures import distribution_figure, scatter_figure
from sumo_reactive.show.batch_page import batch_page, differences_table, pairs_by_group, short_names
from sumo_reactive.show.batch_trials import happenings, pairs_of, trials_in, worst_of


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    return made_store(tmp_path_factory.mktemp("store") / "made.duckdb")


@pytest.fixture(scope="module")
def trials(store):
    with Results(store) as results:
        return trials_in(results)


@pytest.fixture(scope="module")
def text(store):
    return batch_page(store)


def test_a_trip_is_paired_with_its_baseline_of_the_same_seed(trials):
    pairs = pairs_of(trials)
    assert [(pair.driven.scenario, pair.driven.seed) for pair in pairs] == [
        (scenario, seed) for scenario in ("town.toml", "land.toml") for seed in (1, 2, 3)
    ]
    assert pairs[0].of("duration_s") == (41.0, 32.0)
    assert pairs[0].of("min_time_to_collision_s") is None


def test_what_depends_on_the_trip_is_compared_only_where_both_have_arrived(trials):
    pair = pairs_of(trials)[0]
    stuck = pair.driven._replace(metrics={**pair.driven.metrics, "arrived": 0.0})
    assert pair._replace(driven=stuck).of("duration_s") is None
    assert pair._replace(driven=stuck).of("arrived") == (1.0, 0.0)


def test_pairs_are_grouped_by_scenario_and_all_together(trials):
    groups = pairs_by_group(pairs_of(trials))
    assert {group: len(inside) for group, inside in groups.items()} == {
        ("town.toml", ""): 3, ("land.toml", ""): 3, ("", ""): 6,
    }  # fmt: skip


@pytest.mark.parametrize("times", [1, 4])
def test_a_difference_that_leaves_out_zero_is_bold_if_ten_pairs_show_it(trials, times):
    (_, table) = differences_table(times * pairs_of(trials), ["duration_s"], short_names(trials))
    row = re.search(r"<tr><td>town</td>.*?</tr>", table)[0]
    cells = re.findall(r"<td[^>]*>(.*?)</td>", row)
    assert cells[:-1] == ["town", "duration (s)", str(3 * times), "42", "34", "−8"]
    assert cells[-1].startswith("<strong>−" if times > 1 else "−")


def test_the_scatter_has_the_baseline_across_and_this_driver_up(trials):
    figure = scatter_figure(pairs_of(trials), "duration_s", short_names(trials))
    line, town, land = figure.data
    assert (line.name, town.name, land.name) == ("the same", "town", "land")
    assert (list(town.x), list(town.y)) == ([41.0, 42.0, 43.0], [32.0, 34.0, 36.0])
    assert list(line.x) == list(line.y) == list(figure.layout.xaxis.range) == list(figure.layout.yaxis.range)
    assert figure.layout.xaxis.title.text == "SUMO's own driver: duration (s)"
    assert figure.layout.yaxis.title.text == "this driver: duration (s)"


def test_the_distribution_shows_every_trial_in_its_group(trials):
    figure = distribution_figure(trials, "duration_s", short_names(trials))
    points = {trace.offsetgroup: list(zip(trace.y, trace.x, strict=True)) for trace in figure.data}
    assert points["sumo"] == [("town", 41.0), ("town", 42.0), ("town", 43.0), ("land", 61.0), ("land", 62.0), ("land", 63.0)]
    assert len(points["reactive"]) == 8 and ("town", 99.0) in points["reactive"]
    assert figure.layout.xaxis.title.text == "duration (s)"


def test_what_is_varied_stands_with_its_scenario_and_the_baseline(trials):
    town, land = (next(one for one in trials if one.scenario == name) for name in ("town.toml", "land.toml"))
    varied = [one._replace(driver="reactive", varied="STUCK_S=5.0") for one in (town, land)]
    figure = distribution_figure([*varied, town, land], "duration_s", short_names(trials))
    assert list(figure.layout.yaxis.categoryarray)[::-1] == ["town STUCK_S=5.0", "town", "land STUCK_S=5.0", "land"]


def test_the_worst_come_first_and_say_why(trials):
    worst = worst_of(trials, pairs_of(trials))
    assert [(one.trial.seed, one.why) for one in worst] == [
        (6, "crashed: the process was killed by SIGKILL"),
        (5, "did not arrive (until 104 s)"),
        (4, "1 collision"),
    ]


def test_slower_than_the_baseline_is_bad_enough_to_be_told(trials):
    pair = pairs_of(trials)[0]
    slow = pair.driven._replace(metrics={**pair.driven.metrics, "duration_s": 61.5})
    (found,) = worst_of([slow], [pair._replace(driven=slow)])
    assert found.why == "took 1.50 times as long as SUMO's own driver"


def test_what_happened_in_a_trial_is_read_back(store, trials):
    (hit,) = (one for one in trials if one.metrics.get("collisions"))
    with Results(store) as results:
        entries, faults = happenings(results, hit.key)
    assert [entry.time for entry in entries] == [12.0]
    assert faults == [Fault(13.0, COLLISION, "veh_<7>", "lane_0")]


def test_the_worst_are_linked_and_have_the_command_that_replays_them(text):
    links = re.findall(r'href="#(trial-\w+)"', text)
    assert len(links) == 3
    assert all(text.count(f'id="{one}"') == 1 for one in links)
    assert text.count("<code>sumo-reactive run ") == 6
    assert "Ran into veh_&lt;7&gt; at 13.0 s; at 12.0 s the ego judged" in text
    assert "<7>" not in text.partition("<body>")[2]


def test_a_store_without_a_result_yet_has_a_page_without_figures(tmp_path):
    path = tmp_path / "one.duckdb"
    one = trial(1)
    with Store(path) as store:
        store.plan([one], ["duration_s"])
    text = batch_page(path)
    assert "0 of 1 trials finished." in text and 'class="plot"' not in text


def test_a_count_is_a_table_and_what_never_differs_a_line(text):
    assert "<td>0 (1), 1 (4)</td>" in text  # arrivals of this driver in town
    assert 'id="plot-of-duration_s"' in text and 'id="plot-of-arrived"' not in text


def test_a_scenario_is_named_in_short_where_that_tells_it_apart(trials):
    one, *_ = trials
    near = [one._replace(scenario=name) for name in ("a/x.toml", "b/x.toml", "c/y.toml")]
    assert short_names(near) == {"a/x.toml": "a/x.toml", "b/x.toml": "b/x.toml", "c/y.toml": "y"}
