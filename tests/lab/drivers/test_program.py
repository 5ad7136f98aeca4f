"""Drivers that are programs: in Python and in C++, and those that die, babble or say nothing."""

import json
import shutil
import subprocess
import sys

import pytest
from test_users_trip import EXAMPLES, driven_by, steps_of

from sumo_reactive.driver.nouns.state import Command
from sumo_reactive.lab.drivers import program
from sumo_reactive.lab.drivers.choice import DriverChoice
from sumo_reactive.lab.drivers.program import Message, words_of_program
from sumo_reactive.lab.drivers.protocol import LaneCommand, MotionPlan, Placement, Waypoint

READY = "import sys\nsys.stdin.readline()\nprint('{\"ready\": true}', flush=True)\nsys.stdin.readline()\n"


def program_of(tmp_path, code):
    """Return the scenario with a driver that runs this Python code."""
    (tmp_path / "driver.py").write_text(code, encoding="utf-8")
    return driven_by(f"exec:{sys.executable} driver.py", tmp_path)


def test_the_python_client_drives_and_tells_its_reasons():
    result, steps = steps_of(driven_by(f"exec:{sys.executable} pass_on.py", EXAMPLES))
    assert result.arrived, result.failure
    assert {"drives freely"} < {step.reason for step in steps}


@pytest.mark.skipif(shutil.which("g++") is None, reason="no C++ compiler here")
def test_the_client_in_another_language_drives_a_whole_trip(tmp_path):
    build = ["g++", "-O1", "-std=c++17", "-Wall", "-Werror", "-o", tmp_path / "pass_on", EXAMPLES / "pass_on.cpp"]
    subprocess.run(build, check=True, timeout=120)
    result, steps = steps_of(driven_by("exec:./pass_on", tmp_path))
    assert result.arrived, result.failure
    assert {step.reason for step in steps} >= {"drives freely", "keeps its distance"}


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("raise SystemExit(7)", "the program ended with code 7"),
        ("print('hello', flush=True); input(); input()", "answered 'hello'"),
        (READY + "raise SystemExit(3)", "the program ended with code 3"),
        (READY + "print('{\"command\": [1.0]}', flush=True); input()", "command.1: Field required"),
        (READY + "print('{\"speed\": 3}', flush=True); input()", "speed: Extra inputs"),
        (READY + "print('x' * 2**21, flush=True); input()", "answered with more than 1048576 bytes"),
        ("print('{}', flush=True); input()", "its first answer is not"),
    ],
)
def test_a_program_that_does_not_keep_to_the_protocol_has_failed(tmp_path, code, told):
    result, _ = steps_of(program_of(tmp_path, code))
    assert told in result.ended


def test_a_program_that_is_silent_has_failed(tmp_path, monkeypatch):
    monkeypatch.setattr(program, "ANSWER_LIMIT_S", 0.3)
    result, _ = steps_of(program_of(tmp_path, READY + "import time; time.sleep(60)"))
    assert "no answer within 0.3 s" in result.ended


def test_a_program_that_does_not_read_its_mission_has_failed(tmp_path, monkeypatch):
    monkeypatch.setattr(program, "ANSWER_LIMIT_S", 0.3)
    (tmp_path / "driver.py").write_text("import time; time.sleep(60)", encoding="utf-8")
    more_than_a_pipe_holds = "x" * 2**18
    result, _ = steps_of(driven_by(f"exec:{sys.executable} driver.py", tmp_path, text=more_than_a_pipe_holds))
    assert "has not read what it is told within 0.3 s" in result.ended


def test_the_program_has_ended_when_the_trip_has(tmp_path):
    code = READY + (
        "print('{\"lane\": [2.0, null, true]}', flush=True)\n"
        "for line in sys.stdin:\n"
        "    if line.startswith('{\"end\"'):\n        open('end.json', 'w').write(line)\n"
        "    else:\n        print('{\"lane\": [2.0, null, true]}', flush=True)\n"
    )
    result, _ = steps_of(program_of(tmp_path, code))
    assert result.arrived
    assert json.loads((tmp_path / "end.json").read_text(encoding="utf-8")) == {"end": {"arrived": True, "reason": "arrived"}}


def test_every_answer_has_a_message():
    told = {
        '{"command": [1.0, 0.1]}': Command(1.0, 0.1),
        '{"lane": [1.0, 2, false], "reason": "so"}': LaneCommand(1.0, 2, False),
        '{"place": [1, 2, 3, 4]}': Placement(1.0, 2.0, 3.0, 4.0),
        '{"plan": [[0, 1, 2, 3, 4]]}': MotionPlan((Waypoint(0.0, 1.0, 2.0, 3.0, 4.0),)),
        '{"go_on": true}': None,
    }
    assert {text: Message.model_validate_json(text).answer for text in told} == told


def test_the_words_of_a_program_are_those_of_a_shell():
    assert words_of_program(DriverChoice("exec:python 'a b.py' --x", folder=EXAMPLES)) == ["python", "a b.py", "--x"]
