"""The page of several egos: a row each, and the way to its own page."""

import json
import re

import pytest

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.schema import RECORD_VERSION
from sumo_reactive.show.reports import page_beside, page_of


def fleet(folder, *egos):
    folder.mkdir()
    clean = {"verdict": "arrived without a violation", "duration_s": 12.5, "collisions": 0}
    found = [{"ego": ego, "folder": ego.replace(" ", "%20"), **clean} for ego in egos]
    refused = [{"vehicle": "tram", "reason": "a rail vehicle"}]
    text = json.dumps({"version": RECORD_VERSION, "egos": found, "refused": refused})
    (folder / "fleet.json").write_text(text, encoding="utf-8")
    return folder


def test_an_ego_is_linked_to_its_page_or_has_the_command_that_writes_it(tmp_path):
    folder = fleet(tmp_path / "out", "a 1", "b")
    own = folder / "a%201"
    own.mkdir()
    (own / "report.html").write_text("", encoding="utf-8")
    text = page_of(folder, tmp_path / "elsewhere.html")
    assert 'href="out/a%25201/report.html"' in text
    assert f"<code>sumo-reactive report {folder / 'b'}</code>" in text
    assert "2 of 2 arrived without a violation" in text and "a rail vehicle" in text and "plotly" not in text
    assert re.search(r"<td>a 1</td><td>arrived without a violation</td><td class=\"number\">12.5</td>", text)


def test_a_fleet_without_its_keys_is_one_line(tmp_path):
    folder = fleet(tmp_path / "out", "a")
    (folder / "fleet.json").write_text("{}", encoding="utf-8")
    with pytest.raises(ScenarioError, match="not the record of several egos"):
        page_of(folder, tmp_path / "page.html")


@pytest.mark.parametrize("name", ["../elsewhere", "..", ".", "", "a/b", "a\\b", "a\0", 5, None, ["a"]])
def test_a_folder_elsewhere_is_one_line(tmp_path, name):
    folder = fleet(tmp_path / "out", "a")
    data = json.loads((folder / "fleet.json").read_text(encoding="utf-8"))
    data["egos"][0]["folder"] = name
    (folder / "fleet.json").write_text(json.dumps(data), encoding="utf-8")
    with pytest.raises(ScenarioError, match="folder"):
        page_of(folder, tmp_path / "page.html")


def test_a_page_goes_into_its_folder_or_beside_the_store(tmp_path):
    assert page_beside(tmp_path) == tmp_path / "report.html"
    assert page_beside(tmp_path / "grid.duckdb") == tmp_path / "grid.html"
