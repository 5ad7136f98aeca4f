"""What a session says when SUMO does not start: one line, in SUMO's own words."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

START = """
import sys
from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.session import Session
try:
    with Session(["-c", sys.argv[1]]):
        pass
except ScenarioError as error:
    print(error)
"""
"""A process for each: libsumo may crash when it is started again after a start that failed."""

NET = Path(__file__).parents[2] / "networks" / "roundabout" / "roundabout.net.xml"


@pytest.mark.parametrize(
    ("configuration", "said"),
    [
        ("<no-such-option value='1'/>", "No option with the name 'no-such-option' exists."),
        (f"<net-file value='{NET}'/><route-files value='a.rou.xml'/>", "a.rou.xml' At line"),
    ],
)
def test_what_sumo_cannot_read_is_named_in_one_line(tmp_path, configuration, said):
    (tmp_path / "a.sumocfg").write_text(f"<configuration>{configuration}</configuration>", encoding="utf-8")
    (tmp_path / "a.rou.xml").write_text("<routes><vehicle", encoding="utf-8")
    command = [sys.executable, "-c", START, str(tmp_path / "a.sumocfg")]
    found = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    assert found.stderr == ""
    assert found.stdout.count("\n") == 1
    assert said in found.stdout
