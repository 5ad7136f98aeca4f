"""The fundamental diagram on the page of a batch: points by share, means with intervals, nothing where there is none."""

import pytest
from helpers.stores import made_share_store, made_store

from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.lab.fundamental_diagram import DiagramPoint
from sumo_reactive.show.batch_page import batch_page
from sumo_reactive.show.batch_trials import trials_in
from sumo_reactive.show.diagram_section import diagram_figure, diagram_section, whole_of

NAMES = {"town.toml": "town"}


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """The trials of a store, and their points by the key of the trial."""
    with Results(made_share_store(tmp_path_factory.mktemp("shares") / "s.duckdb")) as results:
        return trials_in(results), results.diagram()


def test_the_store_gives_each_trial_its_points_in_order_of_time(stored):
    trials, points = stored
    assert set(points) == {trial.key for trial in trials}
    assert [point.begin_s for point in points[trials[0].key]] == [0.0, 60.0]
    assert points[trials[0].key][0] == DiagramPoint("main <road>", 0.0, 60.0, 396.0, 11.0, 10.0)


def test_a_figure_has_a_colour_a_share_and_a_point_an_interval_of_each_run(stored):
    trials, points = stored
    traces = diagram_figure([(trial, points[trial.key]) for trial in trials], "town: main").data
    assert [trace.name for trace in traces] == ["0 %", "20 %", "60 %"]
    assert len({trace.marker.color for trace in traces}) == 3
    assert [len(trace.x) for trace in traces] == [8, 8, 8]
    assert (traces[0].x[0], traces[0].y[0]) == (11.0, 396.0)


def test_means_by_share_stand_with_their_intervals(stored):
    text = "".join(diagram_section(*stored, NAMES))
    assert "main &lt;road&gt;" in text and "<road>" not in text
    for number in ("450", "540", "720", "12.5", "16"):  # flows at 0, 20 and 60 %, the density, the speed at 60 %
        assert f'<td class="number">{number}</td>' in text
    assert text.count(" … ") >= 6


def test_a_run_as_a_whole_weighs_its_intervals_by_their_length():
    points = DiagramPoint("a", 0.0, 60.0, 360.0, 10.0, 10.0), DiagramPoint("a", 60.0, 90.0, 0.0, 0.0, None)
    assert whole_of(points) == pytest.approx((240.0, 20.0 / 3.0, 10.0))
    assert whole_of(points[1:]) == (0.0, 0.0, None)
    assert whole_of(()) == (0.0, 0.0, None)


def test_the_page_of_a_batch_without_shares_has_no_diagram(tmp_path):
    assert "Fundamental diagram" in batch_page(made_share_store(tmp_path / "s.duckdb"))
    assert "Fundamental diagram" not in batch_page(made_store(tmp_path / "t.duckdb"))
