"""What decides between an option of ours, the scenario's and the user's, case by case."""

from dataclasses import replace
from pathlib import Path

import pytest

from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.config import SumoConfig
from sumo_reactive.sumo.launch import chosen_step_length, passed_end, runnable_config, sumo_arguments

CONFIG = SumoConfig(
    path=Path("a.sumocfg"), options={}, net_file=Path("n.net.xml"), route_files=(), additional_files=(), begin_s=0.0,
    end_s=None, step_length_s=1.0, is_mesoscopic=False,
)  # fmt: skip


def saying(**options: str) -> SumoConfig:
    """A configuration with these options; `_` stands for `-`."""
    return replace(CONFIG, options={name.replace("_", "-"): value for name, value in options.items()})


def overrides_of(config: SumoConfig, *words: str) -> dict[str, tuple[str, str]]:
    """What is changed: option, what the scenario says and what is used."""
    _, changed = sumo_arguments(config, config.path, seed=42, step_length_s=0.5, sumo_options=words)
    return {name: (said, used) for name, said, used in changed}


def value_of(arguments, name):
    """What SUMO is told of an option; None: nothing."""
    return arguments[arguments.index(f"--{name}") + 1] if f"--{name}" in arguments else None


def test_a_scenario_that_says_nothing_is_changed_where_sumos_defaults_hide_harm():
    assert overrides_of(CONFIG) == {
        "collision.action": ("teleport", "warn"),
        "collision.check-junctions": ("false", "true"),
        "collision.mingap-factor": ("-1", "0"),
        "step-length": ("1", "0.5"),
    }


@pytest.mark.parametrize(
    ("option", "said", "is_changed"),
    [
        ("seed", "42", False), ("seed", "42.0", False), ("seed", "7", True),
        ("step-length", "0.50", False), ("step-length", "0:0:0.5", False), ("step-length", "0.1", True),
        ("random", "false", False), ("random", "True", True), ("random", " FALSE ", False),
        ("collision.action", " Warn", False), ("collision.action", "none", True),
        ("collision.check-junctions", "yes", False), ("collision.check-junctions", "no", True),
        ("collision.stoptime", "0", False), ("collision.stoptime", "1000", True),
        ("remote-port", "0", False), ("remote-port", "8813", True),
    ],
)  # fmt: skip
def test_what_means_the_same_is_no_override(option, said, is_changed):
    assert (option in overrides_of(replace(CONFIG, options={option: said}))) is is_changed


def test_arguments_are_the_file_our_options_and_last_the_users():
    words = ["--seed", "3"]
    arguments, _ = sumo_arguments(CONFIG, CONFIG.path, seed=42, step_length_s=0.25, sumo_options=words)
    assert arguments[:2] == ["--configuration-file", "a.sumocfg"] and arguments[-2:] == words
    assert "--seed" not in arguments[:-2]
    names = ("step-length", "random", "remote-port", "no-step-log", "no-warnings")
    assert [value_of(arguments, name) for name in names] == ["0.25", "false", "0", "true", "true"]


def test_options_in_place_of_the_file_leave_out_what_we_or_the_user_say():
    options = {"seed": "1", "end": "9", "no-step-log": "false", "scale": "2"}
    arguments, _ = sumo_arguments(CONFIG, options, seed=42, step_length_s=0.5, sumo_options=["-e", "3"])
    assert [word for word in arguments if "=" in word] == ["--scale=2"]
    assert value_of(arguments, "seed") == "42"


@pytest.mark.parametrize("name", ["no-warnings", "verbose", "log", "error-log", "message-log"])
def test_who_says_anything_of_the_log_hears_it(name):
    quiet, _ = sumo_arguments(CONFIG, CONFIG.path, seed=1, step_length_s=0.1)
    said, _ = sumo_arguments(replace(CONFIG, options={name: "x"}), CONFIG.path, seed=1, step_length_s=0.1)
    asked, _ = sumo_arguments(CONFIG, CONFIG.path, seed=1, step_length_s=0.1, sumo_options=[f"--{name}", "x"])
    assert [value_of(one, "no-warnings") for one in (quiet, said, asked[:-2])] == ["true", None, None]
    assert [value_of(one, "no-step-log") for one in (quiet, said, asked)] == ["true"] * 3


@pytest.mark.parametrize(
    ("end", "time", "words", "passed"),
    [
        (None, 70.0, (), ()),
        (60.0, 59.9, (), ()),
        (60.0, 60.0, (), ()),
        (60.0, 60.1, (), (("end", "0:1:0", "60.1"),)),
        (60.0, 123456.75, ("--seed", "1"), (("end", "0:1:0", "123456.75"),)),
        (60.0, 61.0, ("-e", "90"), ()),
        (60.0, 59.0, ("-e", "90"), ()),
    ],
)
def test_an_end_that_the_ego_has_driven_past_is_an_override(end, time, words, passed):
    assert passed_end(replace(saying(end="0:1:0"), end_s=end), time, words) == passed


@pytest.mark.parametrize(
    ("name", "is_for_show"),
    [("osm.poly.xml", True), ("POIs.add.xml", True), ("a.View.xml", True), ("gui.xml", True), ("Background.xml", True),
     ("decals.xml", True), ("lights.add.xml", False), ("vtypes.xml", False)],
)  # fmt: skip
def test_only_a_missing_file_that_draws_something_is_done_without(tmp_path, name, is_for_show):
    file = tmp_path / name
    config = replace(saying(additional_files=name), path=tmp_path / "a.sumocfg", additional_files=(file,))
    if is_for_show:
        assert runnable_config(config) == ({}, (("additional-files", str(file), "left out: missing"),))
        return
    with pytest.raises(ScenarioError) as told:
        runnable_config(config)
    assert str(told.value) == f"{file}: no such file (additional-files of {config.path})"


@pytest.mark.parametrize(
    ("name", "value", "kept"),
    [
        ("log", "", ""), ("log", "STDERR", "STDERR"), ("log", "-", "-"), ("log", "host:80", "host:80"),
        ("log", "${A}/b", "${A}/b"), ("log", "b", "{}/b"), ("log", "a/host:80", "{}/a/host:80"),
        ("route-files", " a , /b ", "{}/a,/b"), ("scale", "a", "a"),
    ],
)  # fmt: skip
def test_a_file_is_named_so_that_it_is_found_from_anywhere(tmp_path, name, value, kept):
    config = replace(CONFIG, path=tmp_path / "a.sumocfg", options={"start": "true", name: value})
    assert runnable_config(config) == ({name: kept.replace("{}", str(tmp_path))}, (("start", "true", "left out"),))


@pytest.mark.parametrize(
    ("asked", "is_possible"), [(1.0, True), (0.001, True), (1.001, False), (0.0, False), (0.0015, False)]
)
def test_a_step_is_whole_milliseconds_up_to_a_second(asked, is_possible):
    if is_possible:
        assert chosen_step_length(CONFIG, asked) == asked
        return
    with pytest.raises(ScenarioError) as told:
        chosen_step_length(CONFIG, asked)
    assert str(told.value) == f"a.sumocfg: impossible step length {asked:g} s: it is whole milliseconds, at most 1 s"
