"""Batches in processes of their own: killed and resumed, on a cluster, with bad input."""

import os
import re
import signal
import subprocess
import sys
from contextlib import contextmanager

import duckdb
import psutil
import pytest
from distributed.security import Security
from helpers.programs import ROOT, descendants, started, started_anew, sumo_reactive

EXPERIMENT = f"""
[experiment]
scenarios = ["{ROOT}/scenarios/four_way_priority.toml", "{ROOT}/scenarios/right_before_left.toml"]
seeds = SEEDS
metrics = ["arrived", "duration_s"]
"""
TRIALS = 12
LIMIT_S = 400


def written(folder, seeds=(1, 2, 3), more=""):
    """Write the experiment into a folder; return its path."""
    file = folder / "experiment.toml"
    file.write_text(EXPERIMENT.replace("SEEDS", str(list(seeds))) + more, encoding="utf-8")
    return file


def stored(folder):
    """Return what the store says of every trial but for wall-clock times, and every metric and event."""
    with duckdb.connect(str(folder / "experiment.duckdb"), read_only=True) as store:
        trials = "SELECT key, scenario, ego, seed, driver, ending, verdict, trajectory FROM trials ORDER BY key"
        metrics = "SELECT * FROM metrics ORDER BY key, name"
        events = "SELECT * FROM events ORDER BY ALL"
        return tuple(store.execute(query).fetchall() for query in (trials, metrics, events))


def read_until(process, pattern):
    """Read lines until one matches; return it."""
    for line in process.stdout:
        if found := re.search(pattern, line):
            return found
    raise AssertionError(f"ended without {pattern!r}")


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed")
    answer = started_anew("batch", written(folder), "--workers", 2, cwd=folder)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return folder


def test_a_batch_stores_each_trial_once(undisturbed):
    trials, metrics, events = stored(undisturbed)
    assert len(trials) == TRIALS and {row[5] for row in trials} == {"done"}
    assert all(row[7] for row in trials)
    assert {row[0] for row in metrics} == {row[0] for row in trials} and events
    again = sumo_reactive("batch", undisturbed / "experiment.toml", cwd=undisturbed)
    assert again.returncode == 0 and f"{TRIALS} of them" in again.stdout
    assert stored(undisturbed)[0] == trials


def test_killed_twice_it_resumes_and_ends_with_the_same_trials(undisturbed, tmp_path):
    file = written(tmp_path)
    with started("sumo_reactive", "batch", file, "--workers", 2, cwd=tmp_path) as batch:
        read_until(batch, r"^2 of")
        workers = [one for one in descendants(batch) if any("trial_process" in word for word in one.cmdline())]
        workers[0].kill()
        read_until(batch, r"^5 of")
        family = descendants(batch)
        batch.kill()
        batch.wait()
        assert not psutil.wait_procs(family, timeout=20)[1]
    assert 5 <= len(stored(tmp_path)[0]) < TRIALS
    answer = sumo_reactive("batch", file, "--workers", 2, cwd=tmp_path)
    assert answer.returncode == 0 and "of them in" in answer.stdout, answer.stdout + answer.stderr
    assert stored(tmp_path) == stored(undisturbed)


def test_on_one_machine_no_port_is_open(tmp_path):
    with started("sumo_reactive", "batch", written(tmp_path), "--workers", 2, cwd=tmp_path) as batch:
        read_until(batch, r"^1 of")
        family = [psutil.Process(batch.pid), *descendants(batch)]
        assert len(family) == 3
        assert [one.net_connections(kind="inet") for one in family] == [[]] * 3


def test_on_one_machine_dask_is_not_needed(tmp_path):
    code = "import sys; sys.modules['distributed'] = sys.modules['dask'] = None; from sumo_reactive.cli import main; main()"
    file = written(tmp_path, seeds=(1,), more='drivers = ["sumo"]\n')
    for more, status in (((), 0), (("--scheduler", "tcp://127.0.0.1:9"), 2)):
        command = [sys.executable, "-c", code, "batch", str(file), "--workers", "1", *more]
        answer = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, cwd=tmp_path, check=False)
        assert answer.returncode == status, answer.stderr
        (tmp_path / "experiment.duckdb").unlink()
    assert answer.stderr == "sumo-reactive: --scheduler needs dask: pip install 'sumo-reactive[cluster]'\n"


def test_an_interrupt_ends_it_in_order_and_it_goes_on_later(tmp_path):
    file = written(tmp_path)
    with started("sumo_reactive", "batch", file, "--workers", 1, cwd=tmp_path) as batch:
        read_until(batch, r"^1 of")
        family = descendants(batch)
        batch.send_signal(signal.SIGINT)
        said = batch.stdout.read()
        assert batch.wait(timeout=60) == 130 and "Traceback" not in said
        told = [line for line in said.splitlines() if not line.startswith("1 of")]  # what was being written comes once more
        assert told[-1] == "sumo-reactive: interrupted"
        assert not psutil.wait_procs(family, timeout=20)[1]
    assert 1 <= len(stored(tmp_path)[0]) < TRIALS


@contextmanager
def cluster(cwd, protocol="tcp"):
    """Start a scheduler and two workers; give the scheduler and its address."""
    asked = ("--port", 0, "--no-dashboard", "--protocol", protocol)
    with started("distributed.cli.dask_scheduler", *asked, cwd=cwd) as scheduler:
        address = read_until(scheduler, rf"Scheduler at:\s*({protocol}://\S+)")[1]
        worker = ("distributed.cli.dask_worker", address, "--nthreads", 1, "--no-dashboard")
        with started(*worker, cwd=cwd), started(*worker, cwd=cwd):
            yield scheduler, address


def test_on_workers_started_separately_in_another_order_every_byte_is_the_same(undisturbed, tmp_path):
    with cluster(tmp_path) as (_, address):
        file = written(tmp_path, seeds=(3, 2, 1))
        answer = sumo_reactive("batch", file, "--scheduler", address, cwd=tmp_path)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert stored(tmp_path) == stored(undisturbed)


def test_a_scheduler_with_tls_takes_only_who_has_its_certificate(tmp_path, monkeypatch):
    held = Security.temporary()
    for name, text in (("ca.pem", held.tls_ca_file), ("own.pem", held.tls_client_cert), ("own.key", held.tls_client_key)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "dask").mkdir()
    (tmp_path / "dask" / "tls.yaml").write_text(tls_in_readme(), encoding="utf-8")
    file = written(tmp_path, seeds=(1,), more='drivers = ["sumo"]\n')
    monkeypatch.setenv("DASK_CONFIG", str(tmp_path / "dask"))
    with cluster(tmp_path, "tls") as (_, address):
        answer = sumo_reactive("batch", file, "--scheduler", address, cwd=tmp_path)
        assert answer.returncode == 0, answer.stdout + answer.stderr
        assert address.startswith("tls://") and len(stored(tmp_path)[0]) == 2
        monkeypatch.delenv("DASK_CONFIG")
        monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "none"))
        (tmp_path / "experiment.duckdb").unlink()
        plain = address.replace("tls:", "tcp:")
        refused = sumo_reactive("batch", file, "--scheduler", plain, cwd=tmp_path)
        assert refused.returncode == 2 and refused.stderr.startswith(f"sumo-reactive: no scheduler at '{plain}'")
        assert len(refused.stderr.splitlines()) == 1


def tls_in_readme():
    """Return the configuration that the page shows."""
    page = (ROOT / "docs" / "batch.md").read_text(encoding="utf-8")
    return re.search(r"```yaml\n(distributed:.*?)```", page, re.DOTALL)[1]


def test_a_scheduler_that_is_lost_on_the_way_is_one_line_and_nothing_is_lost(tmp_path):
    file = written(tmp_path)
    with (
        cluster(tmp_path) as (scheduler, address),
        started("sumo_reactive", "batch", file, "--scheduler", address, cwd=tmp_path) as batch,
    ):
        read_until(batch, r"^1 of")
        scheduler.kill()
        said = batch.stdout.read()
        assert batch.wait(timeout=60) == 2
        told = [line for line in said.splitlines() if not re.match(r"\d+ of", line)]
        assert len(told) == 1 and told[0].startswith("sumo-reactive: the scheduler was lost")
    assert len(stored(tmp_path)[0]) >= 1


def test_results_are_shown_and_handed_on(undisturbed, tmp_path):
    store = undisturbed / "experiment.duckdb"
    shown = started_anew("results", store, cwd=tmp_path)
    assert shown.returncode == 0 and "duration_s" in shown.stdout and f"{TRIALS} of {TRIALS}" in shown.stdout
    asked = sumo_reactive("results", store, "--sql", "SELECT count(*) AS number FROM trials", cwd=tmp_path)
    assert str(TRIALS) in asked.stdout
    assert sumo_reactive("results", store, "--csv", "t.csv", "--parquet", "t.parquet", cwd=tmp_path).returncode == 0
    columns = duckdb.read_parquet(str(tmp_path / "t.parquet")).columns
    assert len((tmp_path / "t.csv").read_text().splitlines()) == TRIALS + 1
    assert {"scenario", "driver", "duration_s", "rms_jerk_m_s3"} <= set(columns)


def test_a_trial_that_takes_too_long_is_a_row_with_its_reason(tmp_path):
    file = written(tmp_path, seeds=(1,), more='drivers = ["reactive"]\nwall_limit_s = 0.05\nretries = 1\n')
    answer = sumo_reactive("batch", file, "--workers", 1, cwd=tmp_path)
    assert answer.returncode == 1 and "SUMO_REACTIVE" not in answer.stdout
    assert "0 of 2 trials have a result" in answer.stdout and "sumo-reactive run " in answer.stdout
    with duckdb.connect(str(tmp_path / "experiment.duckdb"), read_only=True) as store:
        rows = store.execute("SELECT ending, attempts FROM trials").fetchall()
    assert rows == [("timeout", 2)] * 2


def test_a_second_batch_on_the_same_store_is_refused_with_the_first_ones_process(tmp_path):
    file = written(tmp_path)
    with started("sumo_reactive", "batch", file, "--workers", 1, cwd=tmp_path) as batch:
        read_until(batch, "12 trials")
        second = sumo_reactive("batch", file, cwd=tmp_path)
    assert second.returncode == 2 and f"in use by process {batch.pid}" in second.stderr
    assert len(second.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("batch", "nowhere.toml"), "nowhere.toml: no such file"),
        (("batch", "experiment.toml", "--scheduler", "tcp://127.0.0.1:9"), "no scheduler at 'tcp://127.0.0.1:9'"),
        (("batch", "experiment.toml", "--scheduler", "nonsense"), "no scheduler at 'nonsense'"),
        (("batch", "experiment.toml", "--scheduler", "tls://127.0.0.1:9"), "no scheduler at 'tls://127.0.0.1:9'"),
        (("results", "nowhere.duckdb"), "nowhere.duckdb: no such file"),
        (("results", "experiment.toml"), "not the store of an experiment"),
        (("results", "old.duckdb"), "a store of version 0"),
        (("results", "other.duckdb"), "not the store of an experiment"),
    ],
)
def test_bad_input_gets_one_line(tmp_path, arguments, said):
    written(tmp_path)
    with duckdb.connect(str(tmp_path / "old.duckdb")) as old, duckdb.connect(str(tmp_path / "other.duckdb")) as other:
        old.execute("CREATE TABLE store AS SELECT 0 AS version")
        other.execute("CREATE TABLE something AS SELECT 0 AS version")
    answer = sumo_reactive(*arguments, cwd=tmp_path)
    assert answer.returncode == 2 and "Traceback" not in answer.stderr
    assert len(answer.stderr.splitlines()) == 1 and said in answer.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="limits of a process")
def test_no_room_for_the_store_is_one_line(tmp_path):
    code = (
        "import resource, signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))"
    )
    answer = sumo_reactive("batch", written(tmp_path), cwd=tmp_path, code=code)
    assert answer.returncode == 2 and "Traceback" not in answer.stderr
    assert "no room to write" in answer.stderr, answer.stderr
