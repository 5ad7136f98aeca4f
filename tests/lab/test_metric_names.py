"""One figure, one name: every figure is a metric, and nothing else in the package spells its label or its unit."""

import ast
import re
from pathlib import Path

import pytest
from helpers.results import result
from scenes import record

import sumo_reactive
from sumo_reactive.driver.nouns.event import EventKind
from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.lab import metric_names
from sumo_reactive.lab.comparison.comparison import EGO_METRICS, OTHERS_METRICS
from sumo_reactive.lab.fault import RED_LIGHT_RUN, RIGHT_OF_WAY_TAKEN
from sumo_reactive.lab.metric_names import BASELINE, EVERY, METRICS, NETWORK, OTHERS, TIMINGS
from sumo_reactive.lab.metrics.jury import Jury
from sumo_reactive.lab.result import rows_of

PACKAGE = Path(sumo_reactive.__file__).parent
HOME = Path(metric_names.__file__)
UNIT_OF_ENDING = {
    "_g_per_km": "g/km", "_per_km": "1/km", "_per_h": "1/h", "_m_s2": "m/s²", "_m_s3": "m/s³", "_m_s": "m/s",
    "_rad_s2": "rad/s²", "_rad_s": "rad/s", "_s2": "s²", "_us": "µs", "_km": "km", "_kg": "kg", "_nox_g": "g", "_s": "s",
    "_m": "m",
}  # fmt: skip
"""A longer ending comes first."""


def texts_in(path):
    """Yield every text of a module but its docstrings."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told:
            yield node.value


def spelled_in(text):
    """Return the labels and units of metrics that a text spells: a title, a label of several words, a unit of its own.

    A label of one word is one of English, and a key may be the same: alone they are nobody's.
    """
    words = [metric.label for metric in EVERY.values() if " " in metric.label]
    titles = [rf"\b{re.escape(metric.label)} \(?{re.escape(metric.unit)}\b" for metric in EVERY.values() if metric.unit]
    units = {metric.unit for metric in EVERY.values() if len(metric.unit) > 2} - {"m/s"}  # which is any speed's
    found = [one for one in words if re.search(rf"\b{re.escape(one)}\b", text)]
    found += [one for one in titles if re.search(one, text)]
    return found + [unit for unit in units if text.strip(" ()") == unit]


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_other_place_spells_a_label_or_a_unit_of_a_metric(path):
    if path == HOME:
        return
    kinds = {kind.value for kind in EventKind}
    assert {text: found for text in texts_in(path) if text not in kinds and (found := spelled_in(text))} == {}


def test_what_spells_a_label_or_a_unit_is_found():
    assert spelled_in("red lights run") and spelled_in("duration s") and spelled_in("duration (s)") and spelled_in("m/s³")
    assert not spelled_in("duration") and not spelled_in("collisions")


def test_every_figure_of_the_judges_and_every_wall_clock_figure_is_a_metric_in_the_order_shown():
    jury = Jury(4.0, 1.8, 2.5)
    jury.see(Scene(record(), ()))
    metrics = result(figures=jury.figures()).metrics
    assert list(metrics) == list(METRICS)
    assert list(jury.timing()) == list(TIMINGS)


def test_a_key_is_one_metric_its_ending_is_its_unit_and_no_two_read_alike():
    assert len(EVERY) == len(METRICS) + len(BASELINE) + len(OTHERS) + len(NETWORK) + len(TIMINGS)
    for key, metric in EVERY.items():
        unit = next((unit for ending, unit in UNIT_OF_ENDING.items() if key.endswith(ending)), "")
        assert (metric.key, metric.unit) == (key, unit)
        assert metric.label and metric.meaning
    assert len({metric.label for metric in EVERY.values()}) == len(EVERY)


def test_a_comparison_compares_metrics():
    assert set(EGO_METRICS) < set(METRICS)
    assert tuple(OTHERS) == OTHERS_METRICS


def test_a_violation_is_called_what_one_of_the_counted_is():
    called = [METRICS[key].one for key in ("red_lights_run", "right_of_way_violations")]
    assert called == [RED_LIGHT_RUN, RIGHT_OF_WAY_TAKEN]


def test_a_value_is_told_with_its_digits_and_unit_and_a_count_in_its_number():
    assert METRICS["duration_s"].text(34.26) == "34.3 s"
    assert METRICS["collisions"].text(2) == "2"
    assert METRICS["min_time_to_collision_s"].text(None) == "none"
    assert METRICS["emergencies"].counted(1) == "1 emergency"
    assert METRICS["emergencies"].counted(2) == "2 emergencies"


def test_the_terminal_shows_each_metric_by_its_label():
    figures, timing = {"rms_jerk_m_s3": 1.5, "pilot_free_share": None}, {"control_step_max_us": 7.6}
    rows = dict(rows_of(result(figures=figures, timing=timing)))
    assert rows["duration"] == "30.0 s"
    assert rows["RMS jerk"] == "1.50 m/s³"
    assert rows["steps without the pilot"] == "none"
    assert rows["control step, longest"] == "8 µs"
