"""The page of a comparison's folder: its differences, every trip, and the worst with the commands that replay them."""

from __future__ import annotations

import json
import re

import pytest

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.comparison.record import COMPARISON_VERSION, JSON_FILE
from sumo_reactive.lab.comparison.recorded import read_comparison
from sumo_reactive.show.batch_trials import pairs_of
from sumo_reactive.show.comparison_page import trials_compared
from sumo_reactive.show.reports import page_of


def side(duration, **figures):
    return {"ending": "done", "verdict": "arrived", "command": "sumo x", "figures": {"duration_s": duration, **figures}}


def pair(seed, theirs, ours, **others):
    """Return a pair as `comparison.json` has it; `others`: what both say of others, by metric."""
    return {
        "scenario": "town.toml", "ego": "<veh>", "seed": seed, "sumo": side(theirs),
        "mine:Driver": side(ours, collisions=0) | {"command": f"sumo-reactive run town.toml --seed {seed}"},
        "metrics": {
            "arrived": {"sumo": 1, "mine:Driver": 1}, "duration_s": {"sumo": theirs, "mine:Driver": ours},
            **{name: dict(zip(("sumo", "mine:Driver"), values, strict=True)) for name, values in others.items()},
        },
    }  # fmt: skip


def folder_with(tmp_path, *pairs, drivers=("sumo", "mine:Driver")):
    told = {"version": COMPARISON_VERSION, "drivers": drivers, "pairs": pairs}
    (tmp_path / JSON_FILE).write_text(json.dumps(told), encoding="utf-8")
    return tmp_path


def page(folder):
    return page_of(folder, folder / "report.html")


def test_the_page_has_the_mean_difference_that_of_each_trip_and_the_worst_with_its_command(tmp_path):
    text = page(folder_with(tmp_path, pair(1, 40.0, 30.0), pair(2, 40.0, 60.0), pair(3, 40.0, 39.0)))
    assert "3 of 3 pairs driven by both." in text
    rows = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>(<td.*?)</tr>", text)]
    assert ["town", "mine:Driver", "duration (s)", "3", "40", "43", "+3"] in [row[:7] for row in rows]
    trips = [row for row in rows if row[:2] == ["town", "&lt;veh&gt;"] and len(row) == 4]
    assert [row[2:] for row in trips] == [["1", "−10"], ["2", "+20"], ["3", "−1"]]
    (worst,) = (row for row in rows if "took 1.50 times as long as SUMO&#x27;s own driver" in row)
    assert "<code>sumo-reactive run town.toml --seed 2</code>" in worst
    assert "<veh>" not in text and 'href="#trial-' not in text and "plot-pair-duration_s" in text


def test_a_trip_without_a_result_is_the_worst_and_in_no_difference(tmp_path):
    failed = pair(2, 40.0, 1.0)
    failed["mine:Driver"] = {"ending": "crashed", "verdict": "crashed: signal 11", "command": "sumo-reactive run it"}
    text = page(folder_with(tmp_path, pair(1, 40.0, 40.0), failed))
    assert "1 of 2 pairs driven by both." in text and "crashed: signal 11" in text
    assert "crashed: crashed" not in text and "<code>sumo-reactive run it</code>" in text


def test_what_happened_to_the_others_is_compared_also_where_the_ego_has_not_arrived(tmp_path):
    stuck = pair(1, 40.0, 80.0, arrived=(1, 0), others_time_loss_s=(10.0, 12.0))
    (found,) = pairs_of(trials_compared(read_comparison(folder_with(tmp_path, stuck))))
    assert found.of("others_time_loss_s") == (10.0, 12.0)
    assert found.of("duration_s") is None


@pytest.mark.parametrize(
    ("data", "told"),
    [
        ("[]", "not a comparison"),
        ('{"drivers": ["sumo"], "pairs": []}', "key 'drivers'"),
        ('{"version": 1, "drivers": ["other", "sumo"], "pairs": []}', "not SUMO's own and another"),
        (
            json.dumps({"version": COMPARISON_VERSION, "drivers": ["sumo", "another"], "pairs": [pair(1, 1.0, 1.0)]}),
            "key 'pairs.0.another' is missing",
        ),
        (json.dumps({"drivers": ["sumo", "mine:Driver"], "pairs": [pair(1, 1e99, 1.0)]}), "pairs.0.sumo.figures"),
    ],
)
def test_another_file_of_that_name_is_told_in_one_line_with_the_key(tmp_path, data, told):
    (tmp_path / JSON_FILE).write_text(data, encoding="utf-8")
    with pytest.raises(ScenarioError, match=re.escape(JSON_FILE)) as raised:
        page(tmp_path)
    assert told in str(raised.value) and "\n" not in str(raised.value)
