"""The benchmark of whole runs: what its stopwatch counts, and a small case for real."""

import importlib.util
import sys

import pytest
from helpers.programs import ROOT, TOOLS, numbers_in, run_tool

SCENARIO = ROOT / "scenarios" / "right_before_left.toml"


@pytest.fixture(scope="module")
def bench():
    spec = importlib.util.spec_from_file_location("benchmark_run", TOOLS / "benchmark_run.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_the_stopwatch_leaves_out_what_lies_between_waiting_and_driving(bench, monkeypatch):
    clock = iter([10.0, 11.0, 50.0, 52.0, 55.0])
    monkeypatch.setattr(bench.clock, "process_time", lambda: next(clock))
    watch = bench.Stopwatch()
    for time, doing in ((0.1, bench.WAITS), (0.2, bench.WAITS), (0.3, "normal driving"), (0.4, "normal driving")):
        watch.step(time, doing)
    watch.step(0.5, bench.PLAYS)
    assert (watch.simulation, watch.until, watch.steps) == (1.0 + 2.0 + 3.0, 0.5, 2)


def test_a_process_is_measured_by_the_processor_and_not_by_the_wall(bench):
    sleeps, _ = bench.processor_time([sys.executable, "-c", "import time; time.sleep(1.5)"])
    works = "import time\nwhile time.process_time() < 1.5: pass\nprint('done')"
    busy, said = bench.processor_time([sys.executable, "-c", works])
    assert sleeps < 1.0 < 1.5 <= busy
    assert said == "done\n"


def test_a_program_that_fails_ends_the_benchmark_with_what_it_said(bench):
    with pytest.raises(SystemExit, match="no such trip"):
        bench.processor_time([sys.executable, "-c", "import sys; sys.exit('no such trip')"])


def test_a_small_case_is_driven_by_both_to_the_same_time():
    answer = run_tool("benchmark_run", "--scenario", SCENARIO, "--until", 15, "--repeats", 1)
    assert (answer.returncode, answer.stderr) == (0, "")
    line = answer.stdout.splitlines()[-1]
    assert line.startswith("right_before_left × 1 ")
    vehicles, until, sumo, ours, ratio, *_ = numbers_in(line.removeprefix("right_before_left × 1").replace("|", " "))
    assert until == 15.0
    assert 0.5 < vehicles < 50.0
    assert ratio == pytest.approx(ours / sumo, rel=0.15)
