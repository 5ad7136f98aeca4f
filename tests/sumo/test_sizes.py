"""Road users of a size that none has: told by name, before anything is computed with it."""

from __future__ import annotations

import shutil

import pytest
from helpers.programs import ROOT, sumo_reactive

from sumo_reactive.errors import ScenarioError
from sumo_reactive.sumo.vehicle_type import LONGEST_M, WIDEST_M, size_of_body


@pytest.mark.parametrize("size", [(4.7, 1.8), (LONGEST_M, WIDEST_M), (0.2, 0.0)])
def test_a_size_that_there_is_is_taken(size):
    assert size_of_body("x", *size) == size


@pytest.mark.parametrize("size", [(4.7, 100.1), (1000.1, 1.8), (4.7, 1e308), (float("nan"), 1.8), (4.7, -1.0)])
def test_a_size_that_no_road_user_has_is_told_with_its_name(size):
    with pytest.raises(ScenarioError, match=r"^road user 'x' is .* m long and .* m wide, not up to 1000 m and 100 m$"):
        size_of_body("x", *size)


@pytest.mark.parametrize("command", ["run", "compare"])
def test_somebody_a_kilometre_wide_is_one_line(command, tmp_path):
    folder = tmp_path / "n"
    shutil.copytree(ROOT / "networks" / "four_way_priority", folder)
    (config,) = folder.glob("*.sumocfg")
    (routes,) = folder.glob("*.rou.xml")
    text = routes.read_text(encoding="utf-8")
    wide = '<vType id="wide" width="1000"/>'
    text = text.replace('<flow id="west_east" type="car"', f'{wide}<flow id="west_east" type="wide"')
    assert wide in text
    routes.write_text(text, encoding="utf-8")
    answer = sumo_reactive(command, config, "--ego", "ego")
    assert answer.returncode == 2
    assert "road user 'west_east." in answer.stderr and "1000 m wide" in answer.stderr
    assert "Traceback" not in answer.stderr
