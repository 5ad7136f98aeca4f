"""SUMO configuration files: every form that real ones have, and the one line that a bad one gets."""

import gzip
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


def test_times_and_files_are_read_as_they_are_said(tmp_path):
    (tmp_path / "n.net.xml").touch()
    inner = (
        '<net-file value="n.net.xml"/><route-files value="a.rou.xml, b.rou.xml.gz"/><begin value="0:1:0"/>'
        '<end value="1:0:0"/><step-length value="0.5"/>'
    )
    (tmp_path / "a.sumocfg").write_text(f"<configuration>{inner}</configuration>", encoding="utf-8")
    config = read_config(tmp_path / "a.sumocfg")
    assert (config.begin_s, config.end_s, config.step_length_s) == (60.0, 3600.0, 0.5)
    assert config.route_files == (tmp_path / "a.rou.xml", tmp_path / "b.rou.xml.gz")
    assert config.additional_files == () and not config.is_mesoscopic


def test_a_scenario_without_an_end_has_none(tmp_path):
    (tmp_path / "n.net.xml").touch()
    for said in ("", '<end value="-1"/>'):
        text = f'<configuration><net-file value="n.net.xml"/>{said}</configuration>'
        (tmp_path / "a.sumocfg").write_text(text, encoding="utf-8")
        assert read_config(tmp_path / "a.sumocfg").end_s is None


def test_what_route_and_additional_files_mention_is_found_packed_or_not(tmp_path):
    (tmp_path / "n.net.xml").touch()
    (tmp_path / "a.rou.xml").write_bytes(b"<routes>one</routes>")
    (tmp_path / "b.add.xml.gz").write_bytes(gzip.compress(b"<additional>two</additional>"))
    files = '<route-files value="a.rou.xml"/><additional-files value="b.add.xml.gz,gone.xml"/>'
    text = f'<configuration><net-file value="n.net.xml"/>{files}</configuration>'
    (tmp_path / "a.sumocfg").write_text(text, encoding="utf-8")
    config = read_config(tmp_path / "a.sumocfg")
    assert [config.mentions([mark]) for mark in (b"one", b"two", b"three")] == [True, True, False]
    assert config.mentions((b"three", b"two")) and not config.mentions(())
