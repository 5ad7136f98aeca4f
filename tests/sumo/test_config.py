"""SUMO configuration files: every form that real ones have, and the one line that a bad one gets."""

from pathlib import Path

import pytest

from sumo_reactive.errors import NetworkError, ReactiveError, ScenarioError
from sumo_reactive.sumo.config import read_config, seconds_of

ROOT = Path(__file__).parents[2]


def config_file(folder, inner, root="configuration"):
    """Write a configuration beside an (empty) network."""
    (folder / "a.net.xml").write_text("<net/>", encoding="utf-8")
    path = folder / "a.sumocfg"
    path.write_text(f"<{root}>{inner}</{root}>", encoding="utf-8")
    return path


@pytest.mark.parametrize("path", sorted((ROOT / "networks").rglob("*.sumocfg")), ids=lambda path: path.stem)
def test_every_configuration_of_the_repository_is_read(path):
    config = read_config(path)
    assert config.net_file.exists() and all(file.exists() for file in config.route_files)
    assert config.step_length_s == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("57600", 57600.0), ("16:0:0", 57600.0), ("1:16:00:00", 144000.0), ("10.5", 10.5), ("0:0:1.5", 1.5)],
)
def test_times_are_seconds_or_clock_times(text, seconds):
    assert seconds_of(text) == seconds


def test_an_option_may_stand_anywhere_under_any_of_its_names(tmp_path):
    inner = '<input><n v="a.net.xml"/><r value="a.rou.xml, b.rou.xml"/><step-length value=".2"/></input><b value="16:0:0"/>'
    config = read_config(config_file(tmp_path, inner, "sumoConfiguration"))
    assert config.net_file == tmp_path / "a.net.xml"
    assert config.route_files == (tmp_path / "a.rou.xml", tmp_path / "b.rou.xml")
    assert (config.begin_s, config.end_s, config.step_length_s) == (57600.0, None, 0.2)


def test_a_step_of_one_second_is_sumos_own(tmp_path):
    assert read_config(config_file(tmp_path, '<net-file value="a.net.xml"/><end value="100"/>')).step_length_s == 1.0


NET = '<net-file value="a.net.xml"/>'


@pytest.mark.parametrize(
    ("inner", "error", "place"),
    [
        ("", ScenarioError, "a.sumocfg: no net-file"),
        ('<net-file value=""/>', ScenarioError, "a.sumocfg: no net-file"),
        ('<net-file value="b.net.xml"/>', NetworkError, "b.net.xml: no such file"),
        ('<net-file value="."/>', NetworkError, "a directory, not a file"),
        (NET + '<mesosim value="true"/>', ScenarioError, "option 'mesosim'"),
        (NET + '<step-length value="0"/>', ScenarioError, "impossible step length '0'"),
        (NET + '<step-length value="-1"/>', ScenarioError, "impossible step length '-1'"),
        (NET + '<step-length value="soon"/>', ScenarioError, "option 'step-length': 'soon' is not a time"),
        (NET + '<begin value="0:5"/>', ScenarioError, "option 'begin': '0:5' is not a time"),
        (NET + "<input>", ScenarioError, "a.sumocfg:1: not XML: mismatched tag"),
    ],
)
def test_a_bad_configuration_gets_one_line_that_names_file_and_place(tmp_path, inner, error, place):
    with pytest.raises(error) as raised:
        read_config(config_file(tmp_path, inner))
    assert place in str(raised.value) and "\n" not in str(raised.value)
    assert raised.value.exit_code == 2


def test_what_is_no_configuration_file_is_named(tmp_path):
    (tmp_path / "net.xml").write_text("<net/>", encoding="utf-8")
    (tmp_path / "empty").touch()
    (tmp_path / "binary").write_bytes(b"\x1f\x8b\x00\xff")
    places = {
        "net.xml": "root element is <net>",
        "empty": "not XML",
        "binary": "cannot be read",
        "nowhere": "no such file",
        ".": "a directory",
    }
    for name, place in places.items():
        with pytest.raises(ReactiveError, match=place):
            read_config(tmp_path / name)
