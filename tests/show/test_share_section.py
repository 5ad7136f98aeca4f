"""How figures move with the share of egos: means, intervals, differences from the smallest share."""

import pytest
from helpers.stores import made_share_store, made_store

from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.show.batch_page import batch_page
from sumo_reactive.show.batch_trials import trials_in
from sumo_reactive.show.share_section import share_figure, share_section

METRIC = "network_mean_time_loss_s"
NAMES = {"town.toml": "town"}


def trials_of(path):
    with Results(path) as results:
        return trials_in(results)


@pytest.fixture(scope="module")
def trials(tmp_path_factory):
    return trials_of(made_share_store(tmp_path_factory.mktemp("shares") / "s.duckdb"))


def test_the_mean_of_each_share_stands_over_it_with_its_interval(trials):
    line, points = share_figure({("town.toml", ""): trials}, METRIC, NAMES).data
    assert list(line.x) == pytest.approx([0.0, 20.0, 60.0])
    assert list(line.y) == pytest.approx([20.25, 19.25, 17.25])
    assert all(above > 0.0 for above in (*line.error_y.array, *line.error_y.arrayminus))
    assert len(points.x) == len(trials) == 12


def test_differences_are_paired_by_seed_with_the_smallest_share(trials):
    text = "".join(share_section(trials, ["egos", METRIC], NAMES))
    assert "20 %" in text and "60 %" in text
    assert text.count("−3") >= 1  # 60 % against 0 %: each seed loses 3 s less
    assert "<strong>" not in text  # of four seeds nothing is bold


def test_ten_seeds_make_a_sure_difference_bold(tmp_path):
    found = trials_of(made_share_store(tmp_path / "s.duckdb", seeds=10))
    assert "<strong>" in "".join(share_section(found, [METRIC], NAMES))


def test_the_page_of_a_batch_with_shares_has_the_section_and_one_of_trips_has_not(tmp_path):
    assert "By the share of egos" in batch_page(made_share_store(tmp_path / "s.duckdb"))
    assert "By the share of egos" not in batch_page(made_store(tmp_path / "t.duckdb"))
