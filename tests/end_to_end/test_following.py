"""A run that drives is followed: its page is written again and again, and nothing but the record and the page is left."""

import json
import re
import signal
import time as clock

import pytest
from helpers.programs import ROOT, compile_kernels, started, sumo_reactive

from sumo_reactive.lab import under_way
from sumo_reactive.lab.recorder import PAGE, SUMMARY
from sumo_reactive.lab.under_way import is_alive, place_to_tell

FOUR_WAY = ROOT / "scenarios" / "four_way_priority.toml"
SLOW = """
import time
from pathlib import Path
from sumo_reactive.lab.drivers.protocol import LaneCommand

class Slow:
    reason, steps = "takes its time", 0
    def start(self, mission): pass
    def step(self, view):
        self.steps += 1
        while not Path("go").exists():
            time.sleep(0.05)
            if self.steps < 100:
                break
        return LaneCommand(10.0 - view.ego.speed, is_checked=True)
    def end(self, result): pass
"""
"""A driver that takes a twentieth of a second a step, and none where there is a file `go`, for which it waits later on."""

PATIENCE_S = 60.0


@pytest.fixture
def place(tmp_path):
    compile_kernels()
    (tmp_path / "slow.py").write_text(SLOW, encoding="utf-8")
    return tmp_path


def slow_run(place, *more):
    """Start a run that takes a while: of every step a twentieth of a second."""
    return started("sumo_reactive", "run", FOUR_WAY, "--driver", "slow:Slow", "--out", "out", "-q", *more, cwd=place)


def follower(place, *more):
    return started("sumo_reactive", "report", "out", "--follow", "-q", *more, cwd=place)


def wait_for(found):
    """Wait until a call gives something, and return it."""
    until = clock.monotonic() + PATIENCE_S
    while clock.monotonic() < until:
        if value := found():
            return value
        clock.sleep(0.05)
    raise AssertionError("did not come")


def moments_on(page):
    """Return how far a page of a run that is under way says that it has come, s."""
    text = page.read_text(encoding="utf-8") if page.exists() else ""
    return [float(found) for found in re.findall(r"Under way at ([\d.]+) s", text)]


def test_the_page_grows_with_the_run_and_is_the_usual_one_in_the_end(place):
    page = place / "out" / PAGE
    with follower(place) as report:
        wait_for(lambda: place_to_tell(place / "out").is_dir())
        with slow_run(place) as run:
            first = wait_for(lambda: moments_on(page))
            later = wait_for(lambda: [moment for moment in moments_on(page) if moment > first[0]])
            assert not (place / "out" / SUMMARY).exists() and later
            (place / "go").touch()
            assert run.wait(PATIENCE_S) == report.wait(PATIENCE_S) == 0
    followed = page.read_bytes()
    assert sumo_reactive("report", "out", cwd=place).returncode == 0
    assert page.read_bytes() == followed
    assert {one.name for one in place.iterdir()} <= {"slow.py", "__pycache__", "go", "out"}


def test_what_is_recorded_does_not_depend_on_who_follows(place):
    page = place / "out" / PAGE
    with slow_run(place) as run, follower(place):
        wait_for(lambda: moments_on(page))
        (place / "go").touch()
        assert run.wait(PATIENCE_S) == 0
    followed = json.loads((place / "out" / SUMMARY).read_text(encoding="utf-8"))
    with slow_run(place, "--overwrite") as run:
        assert run.wait(PATIENCE_S) == 0
    alone = json.loads((place / "out" / SUMMARY).read_text(encoding="utf-8"))
    assert alone["trajectory"] == followed["trajectory"] != "" and under_way.PROCESS not in followed


def test_a_run_that_is_killed_is_told_and_its_page_stays(place):
    page = place / "out" / PAGE
    with follower(place) as report:
        wait_for(lambda: place_to_tell(place / "out").is_dir())
        with slow_run(place) as run:
            wait_for(lambda: moments_on(page))
            run.kill()
            run.wait(PATIENCE_S)
        assert report.wait(PATIENCE_S) == 2
        said = report.stdout.read()
    assert "out: the run ended without a record; out/report.html shows how far it came" in said
    assert moments_on(page) and not place_to_tell(place / "out").exists()


def test_who_follows_may_go_and_nothing_is_left_of_it(place):
    with slow_run(place) as run:
        with follower(place) as report:
            wait_for(lambda: moments_on(place / "out" / PAGE))
            report.send_signal(signal.SIGINT)
            assert report.wait(PATIENCE_S) == 130
        (place / "go").touch()
        assert run.wait(PATIENCE_S) == 0
    assert not place_to_tell(place / "out").exists() and (place / "out" / SUMMARY).is_file()


def test_a_record_that_is_there_is_the_last_word_where_no_run_answers(place):
    (place / "go").touch()
    with slow_run(place) as run:
        assert run.wait(PATIENCE_S) == 0
    with follower(place) as report:
        assert report.wait(PATIENCE_S) == 0
    assert (place / "out" / PAGE).is_file()


def test_a_place_that_others_may_write_to_is_told_nothing(tmp_path):
    told = []
    teller = under_way.Teller(tmp_path / "out", {}, lambda folder, summary: told.append(folder))
    place_to_tell(tmp_path / "out").mkdir()
    place_to_tell(tmp_path / "out").chmod(0o777)
    teller.see("ego", 1.0)
    assert told == []


def test_only_a_file_is_no_run_to_follow(tmp_path):
    (tmp_path / "out").write_text("", encoding="utf-8")
    answer = sumo_reactive("report", "out", "--follow", cwd=tmp_path)
    assert answer.returncode == 2 and "out: a file, not the folder of a run" in answer.stderr


def test_a_process_is_known_by_its_number_and_its_begin():
    assert not any(is_alive(process) for process in (None, [1], [1, 0.0], ["a", 1.0], [-1, 1.0], [2**40, 1.0]))
