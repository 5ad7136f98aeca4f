"""The benchmark of fleets: a small one for real, what it tells of a regression, and the pages that it writes."""

import importlib.util
import json
import sys

import pytest
from helpers.programs import TOOLS, run_tool


@pytest.fixture(scope="module")
def bench():
    sys.path.insert(0, str(TOOLS))
    spec = importlib.util.spec_from_file_location("benchmark_fleet", TOOLS / "benchmark_fleet.py")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(TOOLS))
    return module


def words(line):
    return line.strip("| ").split(" | ")


def test_a_small_fleet_is_measured_beside_plain_sumo():
    answer = run_tool("benchmark_fleet", "--until", 15, "--scale", 0.5, "--shares", 0.2)
    assert (answer.returncode, answer.stderr) == (0, "")
    head, _, row = answer.stdout.splitlines()
    cells = dict(zip(words(head), words(row), strict=True))
    parts = [float(cells[name]) for name in ("observe", "control", "place", "judge", "record")]
    assert min(parts) > 0.0
    assert float(cells["µs"]) == pytest.approx(sum(parts) + float(cells["in SUMO"]), abs=4.0)
    assert float(cells["at most"]) >= float(cells["egos"]) > 0.0


def test_a_ratio_that_has_grown_by_more_than_a_tenth_is_told(bench):
    def figures(*ratios):
        return {"rows": [{"share": share, "ratio": ratio} for share, ratio in zip((0.0, 0.5), ratios, strict=True)]}

    assert bench.regressions(figures(50.0, 40.0), figures(54.9, 40.0)) == []
    assert bench.regressions(figures(50.0, 40.0), figures(50.0, 44.1)) == [
        "share 0.5: an ego costs 44.1 of SUMO's vehicles, before 40.0"
    ]


def test_the_pages_are_what_the_tool_makes_of_the_figures_beside_it(bench):
    figures = json.loads(bench.FIGURES.read_text(encoding="utf-8"))
    assert bench.SPEED.read_text(encoding="utf-8") == bench.speed_page(figures)
    assert bench.SCALE.read_text(encoding="utf-8") == bench.scale_page(figures)
