"""The pages in a real browser: nothing on the console, every figure drawn, and in the colours of what it shows."""

import subprocess
import sys
from pathlib import Path

import pytest
from helpers.browser import BROWSER, NO_BROWSER, coloured, of_colour, opened, pressed
from helpers.stores import made_store

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.show.page import BEHAVIOUR_COLOURS, Html, Section, driver_colour, page
from sumo_reactive.writing import write_whole

pytestmark = pytest.mark.skipif(BROWSER is None, reason=NO_BROWSER)

ROOT = Path(__file__).parents[2]
SCENARIO = ROOT / "scenarios" / "figure4.toml"
SOME = 40
"""So many pixels of a colour are something that one sees."""

TWO_FIGURES = ["plot-map", "plot-time"]


def sumo_reactive(*arguments):
    """Run the command line; what it prints."""
    command = [sys.executable, "-m", "sumo_reactive", *map(str, arguments)]
    answer = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=300, check=True)
    return answer.stdout.strip()


@pytest.fixture(scope="module")
def run_page(tmp_path_factory):
    """The page of a run that overtakes, waits before an intersection and crosses it."""
    folder = tmp_path_factory.mktemp("run")
    sumo_reactive("run", SCENARIO, "--quiet", "--out", folder / "out")
    written = Path(sumo_reactive("report", folder / "out"))
    assert written == folder / "out" / "report.html"
    return written


@pytest.fixture(scope="module")
def batch_page(tmp_path_factory):
    """The page of a batch."""
    folder = tmp_path_factory.mktemp("batch")
    made_store(folder / "made.duckdb")
    written = Path(sumo_reactive("report", folder / "made.duckdb", "--out", folder / "page.html"))
    assert written == folder / "page.html"
    return written


@pytest.fixture(scope="module")
def run_opened(run_page):
    return opened(run_page, run_page.parent.parent)


@pytest.fixture(scope="module")
def batch_opened(batch_page):
    return opened(batch_page, batch_page.parent)


def test_the_page_of_a_run_says_nothing_on_the_console(run_opened):
    assert run_opened.console == []


def test_the_page_of_a_run_has_its_figures(run_opened):
    assert list(run_opened.plots) == TWO_FIGURES
    assert run_opened.dom.count('<svg class="main-svg"') >= 2
    for title in ("x (m)", "y (m)", "speed (m/s)", "way ahead (m)", "potential (–)", "simulation time (s)"):
        assert f">{title}</text>" in run_opened.dom


@pytest.mark.parametrize("behaviour", [Behaviour.NORMAL, Behaviour.CAUTIOUS, Behaviour.OVERTAKING, Behaviour.CROSSING])
@pytest.mark.parametrize("name", TWO_FIGURES)
def test_map_and_track_show_each_behaviour_in_its_colour(run_opened, name, behaviour):
    assert of_colour(run_opened.plots[name], BEHAVIOUR_COLOURS[behaviour]) > SOME


def test_the_decisions_stand_on_the_page_in_sentences(run_opened):
    assert "Overtaking: pulls out to pass; slow is slow or has halted" in run_opened.dom
    assert "Crossing the intersection: crosses without stopping" in run_opened.dom


def test_the_page_of_a_batch_says_nothing_on_the_console(batch_opened):
    assert batch_opened.console == []


def test_the_page_of_a_batch_has_its_figures_each_of_its_width(batch_opened):
    metrics = ("duration_s", "rms_jerk_m_s3")
    assert list(batch_opened.plots) == [*(f"plot-of-{one}" for one in metrics), *(f"plot-pair-{one}" for one in metrics)]
    widths = {picture.shape[1] for picture in batch_opened.plots.values()}
    assert max(widths) - min(widths) <= 2
    assert all(coloured(picture) > SOME for picture in batch_opened.plots.values())
    assert ">SUMO's own driver: duration (s)</text>" in batch_opened.dom.replace("&#39;", "'")


def test_distributions_show_both_drivers(batch_opened):
    picture = batch_opened.plots["plot-of-duration_s"]
    assert all(of_colour(picture, colour) > SOME for colour in (driver_colour(one, ()) for one in ("reactive", "sumo")))


@pytest.mark.parametrize(("name", "some"), [("run_page", "whole trip"), ("batch_page", "Zoom in")])
def test_no_button_of_a_page_asks_anybody_for_anything(request, tmp_path, name, some):
    found = pressed(request.getfixturevalue(name), tmp_path)
    assert len(found.buttons) > 10 and some in found.buttons
    assert "Download plot as a PNG" in " ".join(found.buttons)
    assert (found.hosts, found.console) == (set(), [])


@pytest.mark.parametrize("site", ["https://share.example/x", "http://share.example/x"])
def test_a_button_that_opens_a_foreign_site_would_be_noticed(tmp_path, site):
    script = f"<button onclick=\"window.open('{site}', '_blank')\">Share</button>"
    write_whole(tmp_path / "sharing.html", page("Sharing", "A page.", [Section("a", "A", [Html(script)])], is_drawn=False))
    found = pressed(tmp_path / "sharing.html", tmp_path)
    assert (found.buttons, found.hosts) == (["Share"], {"share.example"})


@pytest.mark.parametrize(
    ("script", "said"),
    [("nobody.knows()", "nobody is not defined"), ("fetch('http://127.0.0.1:9/')", "Content Security Policy")],
)
def test_an_error_and_a_request_would_be_noticed(tmp_path, script, said):
    broken = page("Broken", "A page.", [Section("a", "A", [Html(f"<script>{script}</script>")])], is_drawn=False)
    write_whole(tmp_path / "broken.html", broken)
    assert any(said in line for line in opened(tmp_path / "broken.html", tmp_path).console)
