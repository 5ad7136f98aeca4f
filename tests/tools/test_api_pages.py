"""The pages of the API: they are what the source says, one for each public name, and each has what a caller needs."""

import shutil

from helpers.programs import ROOT, run_tool

import sumo_reactive

FOLDER = ROOT / "docs" / "api"


def page(name):
    """Return the text of a page."""
    return (FOLDER / f"{name}.md").read_text(encoding="utf-8")


def test_the_pages_are_what_the_source_says():
    answer = run_tool("api_pages", "--check")
    assert (answer.returncode, answer.stdout) == (0, "up to date\n"), answer.stderr


def test_a_page_that_is_out_of_date_is_written_anew_and_one_too_many_taken_away(tmp_path):
    copy = tmp_path / "api"
    shutil.copytree(FOLDER, copy)
    (copy / "compare.md").write_text("# compare\n", encoding="utf-8")
    (copy / "contrast.md").write_text("", encoding="utf-8")
    assert run_tool("api_pages", "--check", "--folder", copy).stdout == "out of date: compare.md, contrast.md\n"
    assert run_tool("api_pages", "--folder", copy).stdout == "written: compare.md, contrast.md\n"
    assert {one.name: one.read_text() for one in copy.iterdir()} == {one.name: one.read_text() for one in FOLDER.iterdir()}


def test_every_public_name_has_a_page_and_the_first_page_leads_to_all():
    pages = {one.stem for one in FOLDER.glob("*.md")}
    assert pages > set(dir(sumo_reactive)) - {"__version__"}
    assert all(f"[{name}]({name}.md)" in page("index") for name in pages - {"index"})


def test_a_page_has_signature_fields_methods_and_what_is_said_of_them():
    assert "    observer: SceneObserver | None = None,\n" in page("run_trial")
    assert "Raises ScenarioError or NetworkError" in page("run_trial")
    assert "- `ego: str | None = None`" in page("Scenario")
    assert "- `users: tuple[RoadUser, ...]`" in page("DriverView")
    assert "step(view: DriverView) -> DriverAnswer" in page("Driver")
    assert "from sumo_reactive.lab.scenario import Scenario" in page("Scenario")
