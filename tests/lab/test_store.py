"""The store alone: a trial is one row whatever happens, and what it says comes out again."""

from dataclasses import replace
from pathlib import Path

import duckdb
import pytest
from distributed import KilledWorker

from sumo_reactive.errors import ClusterError, StoreError
from sumo_reactive.lab.batch.cluster import report_of
from sumo_reactive.lab.batch.engine import Order
from sumo_reactive.lab.batch.store import Store
from sumo_reactive.lab.batch.stored_results import Results
from sumo_reactive.lab.batch.trials import Departure, Trial
from sumo_reactive.lab.fault import HARD_BRAKING, Fault
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.task import Ending, Outcome, Task

FOUR_WAY = Path(__file__).parents[2] / "scenarios" / "four_way_priority.toml"


def trial(seed):
    return Trial("four_way", {"STUCK_S": 5.0}, {}, Task(replace(load_scenario(FOUR_WAY), seed=seed)))


def done(one, duration, **more):
    result = TrialResult(
        scenario="four_way", ego="ego", chosen="as named", seed=1, step_length_s=0.1, profile="default", arrived=True,
        ended="arrived", begin_s=0.0, departure_s=1.0, end_s=1.0 + duration, time_loss_s=0.0, distance_m=1.0,
        length_m=4.7, width_m=1.8, figures={"min_time_to_collision_s": None}, **more,
    )  # fmt: skip
    return Outcome(task=one.task, ending=Ending.DONE, result=result, trajectory="digest", wall_s=0.1)


def failed(one):
    return Outcome(task=one.task, ending=Ending.CRASHED, reason="the process was killed by SIGKILL")


def test_a_trial_is_stored_once_and_known_again(tmp_path):
    first, second = trial(1), trial(2)
    with Store(tmp_path / "new" / "s.duckdb") as store:
        assert store.plan([first, second], ["duration_s"]) == set()
        store.put(first, done(first, 10.0), 1)
        store.put(first, done(first, 99.0), 1)
    with Store(tmp_path / "new" / "s.duckdb") as store:
        assert store.plan([second, first], ["duration_s"]) == {first.key}
    with Results(tmp_path / "new" / "s.duckdb") as results:
        assert results.progress == (1, 2)
        (group,) = results.groups(results.metrics([]))
    assert (group.done, group.finished, group.varied, group.means[0].mean) == (1, 1, "STUCK_S=5.0", 10.0)


def test_a_failure_is_a_row_that_can_be_forgotten(tmp_path):
    one = trial(1)
    with Store(tmp_path / "s.duckdb") as store:
        store.plan([one], [])
        store.put(one, failed(one), 2)
        ((key, reason, replay),) = store.without_result()
        assert key == one.key and reason == "crashed: the process was killed by SIGKILL"
        assert replay.startswith("sumo-reactive run ") and "--seed 1" in replay
        assert store.plan([one], []) == {one.key}
        assert store.plan([one], [], forget_failed=True) == set()


def test_what_fails_on_the_way_leaves_nothing_of_the_trial(tmp_path):
    one = trial(1)
    broken = done(one, 10.0, faults=(Fault("no time", HARD_BRAKING, "other", "lane"),))
    with Store(tmp_path / "s.duckdb") as store:
        with pytest.raises(StoreError):
            store.put(one, broken, 1)
        assert store.plan([one], []) == set()
        store.put(one, done(one, 10.0, faults=(Fault(3.0, "red light", "", "lane"),)), 1)
    with duckdb.connect(str(tmp_path / "s.duckdb"), read_only=True) as database:
        assert database.execute("SELECT time_s, kind FROM events").fetchall() == [(3.0, "red light")]
        nothing = database.execute("SELECT value FROM metrics WHERE name = 'min_time_to_collision_s'").fetchall()
    assert nothing == [(None,)]


def test_trips_found_are_kept_by_scenario(tmp_path):
    found = [Departure("a", 1.0, 300.0), Departure("b", 2.0, 400.0)]
    with Store(tmp_path / "s.duckdb") as store:
        store.put_departures("key", found)
        assert store.departures("key") == found and store.departures("other") == []


@pytest.mark.parametrize(("metric", "said"), [("duration", "unknown metric 'duration'; near it: duration_s")])
def test_an_unknown_metric_is_told_with_those_near_it(tmp_path, metric, said):
    Store(tmp_path / "s.duckdb").close()
    with Results(tmp_path / "s.duckdb") as results, pytest.raises(StoreError, match=said):
        results.metrics([metric])


def test_a_query_that_fails_is_one_line(tmp_path):
    Store(tmp_path / "s.duckdb").close()
    with Results(tmp_path / "s.duckdb") as results, pytest.raises(StoreError) as raised:
        results.asked("SELECT nothing FROM trials")
    assert "nothing" in str(raised.value) and "\n" not in str(raised.value)


class Ended:
    """A future that has come to no result."""

    def __init__(self, status, error=None):
        self.status = status
        self._error = error

    def exception(self):
        return self._error


def test_a_trial_whose_workers_die_is_a_row_and_a_lost_scheduler_an_error():
    order = Order(trial(1).task, 1.0, 0, "batch", "sources")
    report = report_of(Ended("error", KilledWorker("task", None, 3)), order)
    assert (report.outcome.ending, report.attempts) == (Ending.CRASHED, 4)
    with pytest.raises(ClusterError, match="lost"):
        report_of(Ended("lost"), order)
    with pytest.raises(ClusterError, match="cannot run this package: ModuleNotFoundError"):
        report_of(Ended("error", ModuleNotFoundError("sumo_reactive")), order)
