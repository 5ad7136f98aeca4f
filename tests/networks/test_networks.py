"""The project's own networks: their scenario files point at them, they match their sources, and SUMO can drive them."""

from __future__ import annotations

import gzip
import re
import shutil
import subprocess
import sys
import tomllib
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import libsumo
import pytest

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = sorted((ROOT / "scenarios").glob("*.toml"))
NETWORKS = sorted(folder for folder in (ROOT / "networks").iterdir() if folder.is_dir())
TOOL = ROOT / "tools" / "build_networks.py"
ABSOLUTE_PATH = re.compile(r'["\s]/\w+/|[A-Z]:\\')
SEED = 42

each_scenario = pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
each_network = pytest.mark.parametrize("folder", NETWORKS, ids=lambda folder: folder.name)


def scenario(path: Path) -> dict[str, Any]:
    """The [scenario] table of a scenario file."""
    table: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))["scenario"]
    return table


def config_of(path: Path) -> Path:
    """The SUMO configuration that a scenario file names."""
    return (path.parent / str(scenario(path)["config"])).resolve()


def text_of(path: Path) -> str:
    """Text of a plain or gzipped file."""
    content = path.read_bytes()
    return (gzip.decompress(content) if path.suffix == ".gz" else content).decode("utf-8")


def sumo_start(config: Path, *options: str) -> None:
    """Start SUMO in this process so that it reports collisions instead of hiding them."""
    safety = ("--collision.action", "warn", "--collision.check-junctions", "true")
    libsumo.start(["sumo", "-c", str(config), "--seed", str(SEED), *safety, "--no-warnings", "true", *options])


def test_there_is_a_scenario_for_every_network() -> None:
    assert {path.stem for path in SCENARIOS} == {folder.name for folder in NETWORKS}


@each_scenario
def test_the_configuration_of_a_scenario_exists_and_all_files_it_names_parse(path: Path) -> None:
    config = config_of(path)
    inputs = ET.parse(config).getroot().find("input")
    assert inputs is not None
    for element in inputs:
        assert (config.parent / element.attrib["value"]).is_file()
    routes = ET.parse(config.parent / f"{config.stem}.rou.xml").getroot()
    ego = scenario(path)["ego"]
    assert [vehicle.get("type") for vehicle in routes.iter("vehicle") if vehicle.get("id") == ego] == ["car"]


@each_scenario
def test_a_scenario_ends_no_later_than_its_configuration(path: Path) -> None:
    end = ET.parse(config_of(path)).getroot().find("time/end")
    assert end is not None
    assert scenario(path)["until_s"] <= float(end.attrib["value"])


@each_network
def test_no_file_of_a_network_holds_an_absolute_path(folder: Path) -> None:
    for path in folder.iterdir():
        assert not ABSOLUTE_PATH.search(text_of(path)), path.name


def test_every_network_is_up_to_date_with_its_sources() -> None:
    if shutil.which("netconvert", path=str(Path(sys.executable).parent)) is None and shutil.which("netconvert") is None:
        pytest.skip("netconvert is not installed")
    run = subprocess.run([sys.executable, str(TOOL), "--check"], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_the_tool_refuses_a_network_it_does_not_know() -> None:
    run = subprocess.run([sys.executable, str(TOOL), "atlantis"], capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert "atlantis" in run.stderr


@each_network
def test_every_connection_of_a_network_runs_over_an_internal_lane(folder: Path) -> None:
    (path,) = folder.glob("*.net.xml*")
    connections = [
        link for link in ET.fromstring(text_of(path)).iter("connection") if not link.attrib["from"].startswith(":")
    ]
    assert connections
    assert all(link.get("via") for link in connections)


@each_scenario
def test_sumos_own_driver_finishes_the_trip_of_the_ego_without_collision_or_teleport(path: Path) -> None:
    settings = scenario(path)
    sumo_start(config_of(path), "--step-length", str(settings["step_length_s"]))
    collisions: list[str] = []
    teleports = 0
    arrived = False
    try:
        while not arrived and libsumo.simulation.getTime() < settings["until_s"]:
            libsumo.simulationStep()
            collisions += [f"{hit.collider} hits {hit.victim} on {hit.lane}" for hit in libsumo.simulation.getCollisions()]
            teleports += libsumo.simulation.getStartingTeleportNumber()
            arrived = settings["ego"] in libsumo.simulation.getArrivedIDList()
    finally:
        libsumo.close()
    assert arrived, f"the ego has not arrived after {settings['until_s']} s"
    assert collisions == []
    assert teleports == 0
