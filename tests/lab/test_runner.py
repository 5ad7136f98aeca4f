"""Trials in child processes: what happens to one is told, and the next one runs."""

import os
import signal
import threading
import time
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from sumo_reactive.driver.parameters import Parameters
from sumo_reactive.lab.drivers.choice import SUMO
from sumo_reactive.lab.runner import Runner, close_all, run_all
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.task import Ending, Task
from sumo_reactive.lab.trial_process import scratch

LIMIT_S = 200.0
SCENARIOS = Path(__file__).parents[2] / "scenarios"


@pytest.fixture(scope="module")
def scenario():
    return load_scenario(SCENARIOS / "four_way_priority.toml")


@pytest.fixture(scope="module")
def runner():
    with Runner() as one:
        yield one


def children():
    return [one for one in psutil.Process().children() if any("trial_process" in word for word in one.cmdline())]


def test_the_same_trial_twice_with_others_between_is_the_same(runner, scenario):
    first, other, again = (runner.run(Task(replace(scenario, seed=seed)), LIMIT_S) for seed in (42, 7, 42))
    baseline = runner.run(Task(replace(scenario, driver=SUMO)), LIMIT_S)
    assert {one.ending for one in (first, other, again, baseline)} == {Ending.DONE}
    assert first.trajectory == again.trajectory != other.trajectory
    assert first.result.metrics == again.result.metrics
    assert first.entries == again.entries and first.entries
    assert not baseline.entries and baseline.trajectory != first.trajectory


def test_what_the_user_did_wrong_is_a_line(runner, scenario):
    unknown = runner.run(Task(replace(scenario, ego="nobody")), LIMIT_S)
    assert (unknown.ending, unknown.result) == (Ending.FAILED, None) and "nobody" in unknown.reason


def test_parameters_count_for_the_trial_that_names_them(runner, scenario):
    short = runner.run(Task(replace(scenario, parameters=Parameters(stuck_s=1.0))), LIMIT_S)
    assert short.result is not None and not short.result.arrived and "stood still for 1 s" in short.result.ended
    assert runner.run(Task(scenario), LIMIT_S).result.arrived


def test_a_limit_and_a_kill_end_one_trial(runner, scenario):
    assert runner.run(Task(scenario), 0.02).ending is Ending.TIMEOUT
    assert runner.run(Task(scenario), LIMIT_S).ending is Ending.DONE

    def kill():
        time.sleep(0.15)
        children()[0].kill()

    threading.Thread(target=kill).start()
    lasting = replace(load_scenario(SCENARIOS / "city_grid.toml"), until_end=True)
    killed = runner.run(Task(lasting), LIMIT_S)
    assert killed.ending is Ending.CRASHED and killed.reason == "the process was killed by SIGKILL"
    assert runner.run(Task(scenario), LIMIT_S).ending is Ending.DONE


def test_outcomes_come_in_the_order_of_the_tasks_and_nothing_stays(scenario):
    seen = []
    tasks = [Task(replace(scenario, seed=seed)) for seed in (5, 1, 3)]
    outcomes = list(run_all(tasks, 2, LIMIT_S, seen.append))
    assert [one.task.scenario.seed for one in outcomes] == [5, 1, 3] and len(seen) == 3
    some = run_all(tasks, 2, LIMIT_S)
    next(some)
    some.close()
    assert len(children()) <= 1  # the one of the fixture


@pytest.mark.skipif(not hasattr(os, "fork"), reason="signals")
def test_a_process_whose_caller_is_gone_ends(scenario):
    one = Runner()
    one.run(Task(scenario), LIMIT_S)
    (child,) = [child for child in children() if child.pid == one._child._process.pid]
    one._child._orders.close()
    psutil.wait_procs([child], timeout=10)
    assert not child.is_running() or child.status() == psutil.STATUS_ZOMBIE
    one.close()


def test_a_process_that_does_not_go_by_itself_is_killed_and_its_folder_removed(scenario):
    one = Runner()
    one.run(Task(scenario), LIMIT_S)
    folder = one._child._own_scratch
    assert folder.is_dir()
    os.kill(one._child._process.pid, signal.SIGSTOP)
    one.close()
    assert not folder.exists()


def test_what_runs_in_a_common_folder_leaves_it_to_who_gave_it(scenario, tmp_path):
    with scratch() as folder:
        assert not folder.exists()
        outcomes = list(run_all([Task(scenario)], 1, LIMIT_S, scratch=folder))
        assert outcomes[0].ending is Ending.DONE
    assert not folder.exists()


def test_an_interrupt_while_runners_are_closed_leaves_neither_a_process_nor_a_folder(scenario, monkeypatch):
    runners = [Runner(), Runner()]
    for one in runners:
        assert one.run(Task(replace(scenario, driver=SUMO)), LIMIT_S).ending is Ending.DONE
    child = runners[0]._child
    processes = {one._child._process.pid for one in runners}
    folders, wait, begun = [one._child._own_scratch for one in runners], child._process.wait, []

    def interrupted(*patience):
        if patience and not begun:
            begun.append(1)
            raise KeyboardInterrupt
        return wait(*patience)

    os.kill(child._process.pid, signal.SIGSTOP)  # so that it cannot clean up by itself
    monkeypatch.setattr(child._process, "wait", interrupted)
    with pytest.raises(KeyboardInterrupt):
        close_all(runners)
    assert begun and not any(folder.exists() for folder in folders)
    assert not processes & {one.pid for one in children()}
