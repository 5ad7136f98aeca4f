"""Every network of this repository as the reader tells it, held against SUMO's own Python library."""

import gzip
from pathlib import Path

import pytest
import sumolib
from helpers.tools import tool

from sumo_reactive.driver.world.lane import VEHICLE_CLASSES

NETWORKS = Path(__file__).parents[2] / "networks"
READERS = tool("compare_net_readers")
CROSSROADS = NETWORKS / "signalised_left_turns" / "signalised_left_turns.net.xml"


@pytest.mark.parametrize("file", READERS.networks_in(NETWORKS), ids=lambda file: file.parent.name)
def test_lanes_connections_and_right_of_way_are_those_that_sumolib_reads(file):
    assert list(READERS.differences(file)) == []


def test_the_vehicle_classes_are_those_of_sumolib():
    known, deprecated = sumolib.net.lane.SUMO_VEHICLE_CLASSES, sumolib.net.lane.SUMO_VEHICLE_CLASSES_DEPRECATED
    assert known - deprecated <= VEHICLE_CLASSES <= known


@pytest.mark.parametrize(
    ("what", "wrong"),
    [
        ("length", lambda text: text.replace('length="', 'length="1', 1)),
        ("shape", lambda text: text.replace('shape="', 'shape="7.5,7.5 ', 1)),
        ("permissions", lambda text: text.replace('index="0" ', 'index="0" allow="tram" ', 1)),
        ("who yields to whom", lambda text: text.replace('response="0', 'response="1', 1)),
        ("paths that meet", lambda text: text.replace('foes="0', 'foes="1', 1)),
        ("connections", lambda text: text.replace('dir="s"', 'dir="l"', 1)),
    ],
)
def test_the_comparison_notices_a_difference(tmp_path, monkeypatch, what, wrong):
    """Another file is read by sumolib than by the reader: what they tell must differ in just this."""
    other, read = tmp_path / "other.net.xml", sumolib.net.readNet
    other.write_text(wrong(CROSSROADS.read_text(encoding="utf-8")), encoding="utf-8")
    monkeypatch.setattr(READERS.sumolib.net, "readNet", lambda _, **options: read(str(other), **options))
    found = list(READERS.differences(CROSSROADS))
    assert found
    assert all(f": {what} " in line for line in found), found


def test_the_tool_tells_differences_and_times_of_a_packed_network(tmp_path, capsys, monkeypatch):
    (tmp_path / "a.net.xml.gz").write_bytes(gzip.compress(CROSSROADS.read_bytes()))
    monkeypatch.setattr("sys.argv", ["compare_net_readers.py", str(tmp_path), "--times"])
    with pytest.raises(SystemExit) as end:
        READERS.main()
    assert end.value.code == 0
    line = capsys.readouterr().out
    assert line.startswith(f"{tmp_path / 'a.net.xml.gz'}: 0 differences; sumolib 0.")
    assert "times faster), with the world around " in line
