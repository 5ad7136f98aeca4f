"""`run --gui`: SUMO's window shows the run, changes nothing of it, and is closed without leaving anything."""

import os
import re
import subprocess
import sys

import duckdb
import pytest
from helpers.display import NO_DISPLAY, X11, XVFB, close_window, display
from helpers.programs import ROOT
from matplotlib.image import imread

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.show.page import BEHAVIOUR_COLOURS

FIGURE4 = ROOT / "scenarios" / "figure4.toml"
SHOW = f"""
import sys, libsumo
from pathlib import Path
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.show.page import BEHAVIOUR_COLOURS
from sumo_reactive.sumo.window import Window

window = Window({{behaviour.value: colour for behaviour, colour in BEHAVIOUR_COLOURS.items()}}, 1000.0)

def see(scene):
    window.see(scene)
    if abs(scene.step.time - 84.8) < 1e-6:
        libsumo.gui.setZoom("View #0", 2.0 * libsumo.gui.getZoom("View #0"))
    if abs(scene.step.time - 85.0) < 1e-6:
        libsumo.gui.screenshot("View #0", sys.argv[1], 900, 600)
        print(*sorted(libsumo.polygon.getIDList()), libsumo.poi.getType("sumo_reactive.ego"), sep=";")

run_trial(load_scenario(Path({str(FIGURE4)!r})), observer=see, has_window=True)
"""
"""At 85 s the ego waits for those from the right; it is looked at from near, so that a bar is wide in any library."""

ENDED = "sumo-reactive: SUMO('s window was closed| died of SIG[A-Z]+, as it may when its window is closed: nothing .*)"
"""Whether SUMO is asked something at the moment of closing is chance."""

needs_display = pytest.mark.skipif(not (XVFB and X11), reason=NO_DISPLAY)


@pytest.fixture(scope="module")
def shown():
    with display() as name:
        yield os.environ | {"DISPLAY": name}


def started(*arguments, environment, cwd):
    command = [sys.executable, "-m", "sumo_reactive", "run", str(FIGURE4), *map(str, arguments)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, env=environment, cwd=cwd, **pipes)


def driven(folder):
    return duckdb.sql(f"SELECT * EXCLUDE (control_us) FROM '{folder}/trajectory.parquet'").fetchall()


@needs_display
def test_the_window_changes_nothing_of_the_driving(shown, tmp_path):
    for name, options in (("with", ("--gui", "--gui-speed", 1000)), ("without", ())):
        run = started(*options, "-q", "--out", name, environment=shown, cwd=tmp_path)
        out, _ = run.communicate(timeout=280)
        assert (run.returncode, out) == (0, "ego: arrived without a violation\n")
    assert driven(tmp_path / "with") == driven(tmp_path / "without")


@needs_display
def test_closing_the_window_ends_the_run_and_leaves_nothing(shown, tmp_path):
    run = started("--gui", "-q", "--out", "there", environment=shown, cwd=tmp_path)
    close_window(shown["DISPLAY"], "figure4")
    out, told = run.communicate(timeout=60)
    assert (run.returncode, out) == (130, "")
    assert re.fullmatch(ENDED, told.splitlines()[-1])
    assert list(tmp_path.iterdir()) == []


@needs_display
def test_the_window_shows_behaviour_curve_stop_regions_and_the_reason(shown, tmp_path):
    picture = tmp_path / "window.png"
    answer = subprocess.run(
        [sys.executable, "-c", SHOW, str(picture)], env=shown, capture_output=True, text=True, timeout=280, check=False
    )
    assert answer.returncode == 0, answer.stderr
    *drawn, words = answer.stdout.strip().split(";")
    assert {"ego.C", "ego.stop"} <= set(drawn)
    assert any(name.startswith("ego.region.") for name in drawn)
    assert words.startswith("cautious driving: traffic with priority would meet the ego in the region (right_")
    pixels = (imread(picture)[:, :, :3] * 255).round().astype(int)
    for colour in (BEHAVIOUR_COLOURS[Behaviour.CAUTIOUS], "#56b4e9", "#d55e00"):
        wanted = [*bytes.fromhex(colour[1:])]
        assert (abs(pixels - wanted).max(axis=2) <= 2).sum() > 20, colour


def test_no_display_is_one_line(tmp_path):
    bare = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    run = started("--gui", "--out", "there", environment=bare, cwd=tmp_path)
    out, told = run.communicate(timeout=280)
    assert (run.returncode, out, list(tmp_path.iterdir())) == (2, "", [])
    assert told.splitlines()[-1] == (
        "sumo-reactive: SUMO's window needs a display: DISPLAY is not set (without a screen: xvfb-run)"
    )
