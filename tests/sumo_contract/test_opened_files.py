"""SUMO opens no file of a scenario that the key of a trial does not count."""

import ctypes
import os
import struct
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest
import sumolib

from sumo_reactive.sumo.input_files import inputs_of

NETWORKS = Path(__file__).parents[2] / "networks"
OPENED = 0x20
EVENT = struct.Struct("iIII")

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="inotify tells who opens what on Linux alone")


@contextmanager
def opened_in(folder):
    """Give a function that returns the names of the files opened in a folder since."""
    libc = ctypes.CDLL(None, use_errno=True)
    watch = libc.inotify_init1(os.O_NONBLOCK)
    assert watch >= 0 and libc.inotify_add_watch(watch, os.fsencode(folder), OPENED) >= 0
    try:
        yield lambda: names_in(os.read(watch, 1 << 20))
    finally:
        os.close(watch)


def names_in(events):
    found, place = set(), 0
    while place < len(events):
        *_, length = EVENT.unpack_from(events, place)
        place += EVENT.size
        found.add(os.fsdecode(events[place : place + length].rstrip(b"\0")))
        place += length
    return found - {""}


def run(config, *options):
    command = [sumolib.checkBinary("sumo"), "-c", str(config), "--end", "5", "--no-step-log", *options]
    subprocess.run(command, check=True, capture_output=True, timeout=120, cwd=config.parent)


@pytest.mark.parametrize("name", ["four_way_priority", "city_grid"])
def test_of_an_own_scenario(name):
    config = NETWORKS / name / f"{name}.sumocfg"
    with opened_in(config.parent) as opened:
        run(config)
        assert opened() - {config.name} == {file.name for file in inputs_of(config).files}


def test_of_a_scenario_that_names_files_in_all_ways(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("KIND", "types")
    net = NETWORKS / "four_way_priority" / "four_way_priority.net.xml"
    (tmp_path / "net.xml").write_bytes(net.read_bytes())
    edge = next(one.getID() for one in sumolib.net.readNet(str(net)).getEdges())
    texts = {
        "c.sumocfg": '<configuration><net-file value="net.xml"/><additional-files value="first.add.xml,${KIND}.add.xml"/>'
        '<tripinfo-output value="trips.xml"/></configuration>',
        "first.add.xml": '<additional><include href="second.add.xml"/><edgeData id="d" file="data.xml"/>'
        f'<variableSpeedSign id="v" lanes="{edge}_0" file="v.xml"/></additional>',
        "second.add.xml": '<additional><include href="third.add.xml"/></additional>',
        "third.add.xml": '<additional><vType id="third"/></additional>',
        "types.add.xml": f'<additional><vType id="car"/><route id="way" edges="{edge}"/></additional>',
        "v.xml": '<vss><step time="0" speed="10"/></vss>',
        "more.rou.xml": '<routes><vehicle id="a" type="car" route="way" depart="0"/></routes>',
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    config, options = tmp_path / "c.sumocfg", ("--route-files", "more.rou.xml")
    with opened_in(tmp_path) as opened:
        run(config, *options)
        seen = opened() - {config.name}
    assert {"trips.xml", "data.xml", "v.xml", "third.add.xml", "more.rou.xml"} <= seen
    assert {file.name for file in inputs_of(config, options).files} >= seen - {"trips.xml", "data.xml"}
