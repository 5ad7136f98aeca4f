"""The benchmark of the control step: it runs, and its figures fit together."""

import pytest
from helpers.programs import numbers_in, run_tool

STAGES = (
    "step with an event", "step between events", "perceive", "what lies ahead", "detect events", "outlook (on an event)",
    "decide (on an event)", "execute",
)  # fmt: skip


@pytest.fixture(scope="module")
def lines():
    answer = run_tool("benchmark_step", "--repeats", 20, "--starts", 1)
    assert (answer.returncode, answer.stderr) == (0, "")
    return {line[:42].split("  mean")[0].strip(): line for line in answer.stdout.splitlines()}


def found(lines, name):
    (line,) = (line for line in lines.values() if line.strip().startswith(name))
    return numbers_in(line.strip().removeprefix(name))


@pytest.mark.parametrize("stage", STAGES)
def test_each_stage_has_its_times_by_both_clocks(lines, stage):
    mean, middle, p99, largest, mean_cpu, p99_cpu, largest_cpu = found(lines, stage)
    assert 0.0 < middle <= p99 <= largest and 0.0 < mean <= largest
    assert 0.0 < mean_cpu <= largest_cpu and p99_cpu <= largest_cpu


def test_the_scene_holds_the_ten_cars(lines):
    assert found(lines, "control step, ")[:1] == [10.0]


@pytest.mark.parametrize("name", ["without obstacles", "with static obstacles"])
def test_the_bitmap_is_timed(lines, name):
    mean, middle, largest = found(lines, name)
    assert 0.0 < middle <= largest and 0.0 < mean <= largest


def test_the_parts_of_the_start_up_add_up(lines):
    parts = ("interpreter", "numpy, numba", "libsumo", "the rest of the imports", "SUMO, map, plan, kernels, first step")
    (whole,) = (numbers_in(line)[-1] for line in lines.values() if line.strip().startswith("together  "))
    assert sum(found(lines, part)[-1] for part in parts) == pytest.approx(whole, abs=0.03)
