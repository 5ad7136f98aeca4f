"""TOML files that nobody has written with good intent: one line, and soon."""

from __future__ import annotations

import os

import pytest

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.experiment import load_experiment
from sumo_reactive.lab.discovery import is_scenario_file
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.schema import MOST_TOML_BYTES


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[scenario]\na = " + "[" * 30_000 + "]" * 30_000, "nested too deeply"),
        ("[scenario]\na = " + "{a = " * 30_000, "nested too deeply"),
        ("[scenario]\nconfig = 1\n" + "# more\n" * 20_000, "a.toml: key 'scenario.config'"),
        ("[scenario]\nseed = " + "9" * 5000, "not TOML"),
        ("# more\n" * MOST_TOML_BYTES, "more than 1 MB"),
        ("[scenario]\nconfig = 2020-13-45", "not TOML"),
    ],
    ids=["lists", "tables", "lines", "digits", "size", "date"],
)
@pytest.mark.parametrize("load", [load_scenario, load_experiment])
def test_what_cannot_be_read_is_one_line(tmp_path, load, text, says):
    path = tmp_path / "a.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError, match=says if load is load_scenario or says[0] != "a" else "a.toml") as raised:
        load(path)
    assert "\n" not in str(raised.value)
    is_scenario_file(path)


def test_a_pipe_is_no_scenario(tmp_path):
    os.mkfifo(tmp_path / "a.toml")
    with pytest.raises(ScenarioError, match=r"a\.toml: a pipe, not a file"):
        load_scenario(tmp_path / "a.toml")
    assert not is_scenario_file(tmp_path / "a.toml")
