"""The record of a driver that has no behaviours and no field is shown like any other: the page, a picture, a film."""

import pytest
from helpers.programs import ROOT, sumo_reactive
from helpers.still import STILL

from sumo_reactive.lab.recorder import PAGE

NETWORK = ROOT / "networks" / "four_way_priority" / "four_way_priority.sumocfg"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with records of SUMO's own driver and of a driver of somebody's."""
    folder = tmp_path_factory.mktemp("others")
    (folder / "still.py").write_text(STILL, encoding="utf-8")
    for driver, out in (("sumo", "sumo"), ("still:Still", "still")):
        answer = sumo_reactive("run", NETWORK, "--driver", driver, "--horizon", 6, "--out", out, "-q", cwd=folder)
        assert answer.returncode in (0, 1), answer.stderr
    return folder


@pytest.mark.parametrize("driver", ["sumo", "still"])
def test_its_page_is_drawn_without_behaviours(place, driver):
    answer = sumo_reactive("report", driver, cwd=place)
    assert answer.returncode == 0, answer.stderr
    text = (place / driver / PAGE).read_text(encoding="utf-8")
    assert "The pilot decided" not in text and '"driving"' in text and 'id="replay-player"' in text
    assert ("waits for &lt;nobody&gt;" in text) == (driver == "still") and "<nobody>" not in text


@pytest.mark.parametrize("driver", ["sumo", "still"])
def test_a_moment_of_it_is_drawn_and_filmed(place, driver):
    start = 13.0
    answer = sumo_reactive("figure", driver, "--at", start, "--field", "-o", f"{driver}.svg", cwd=place)
    assert answer.returncode == 0, answer.stderr
    answer = sumo_reactive("film", driver, "--from", start, "--to", start + 0.2, "-o", f"{driver}.gif", cwd=place)
    assert answer.returncode == 0, answer.stderr


def test_check_keeps_its_record_and_page_where_it_fails(place):
    scenario = f'[scenario]\nconfig = "{NETWORK}"\ndriver = "still:Still"\nuntil_s = 16.0\n'
    (place / "still.toml").write_text(scenario, encoding="utf-8")
    answer = sumo_reactive("check", "still.toml", "--out", "failed", cwd=place)
    assert answer.returncode == 1, answer.stderr
    (page,) = (place / "failed").glob(f"*/{PAGE}")
    assert "waits for &lt;nobody&gt;" in page.read_text(encoding="utf-8")
