"""SUMO's own driver without manners: who watches has something to see."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from sumo_reactive.lab.scenario import Scenario, load_scenario

ROOT = Path(__file__).resolve().parents[2]
RUNS_RED = {"jmDriveAfterRedTime": 100}
TAKES_IT = {"jmIgnoreFoeProb": 1, "jmIgnoreFoeSpeed": 100, "jmIgnoreJunctionFoeProb": 1, "jmTimegapMinor": 0}


def in_a_hurry(folder: Path, name: str, **rudeness: object) -> Scenario:
    """Return an own scenario in which the ego's type has these attributes of SUMO's junction model."""
    source = ROOT / "networks" / name
    routes = (source / f"{name}.rou.xml").read_text(encoding="utf-8")
    said = " ".join(f'{key}="{value}"' for key, value in rudeness.items())
    rude = f'<vType id="rude" length="4.7" width="1.8" sigma="0" {said}/><vehicle id="ego" type="rude"'
    (folder / f"{name}.rou.xml").write_text(routes.replace('<vehicle id="ego" type="car"', rude), encoding="utf-8")
    (folder / f"{name}.net.xml").symlink_to(source / f"{name}.net.xml")
    (folder / f"{name}.sumocfg").symlink_to(source / f"{name}.sumocfg")
    return replace(load_scenario(folder / f"{name}.sumocfg"), ego="ego")
