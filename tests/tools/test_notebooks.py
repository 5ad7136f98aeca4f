"""The notebooks: each runs in a fresh kernel, and says what it has been kept with."""

import json
import shutil

import pytest
from helpers.programs import ROOT, run_tool

PATHS = ROOT / "docs" / "paths"
NAMES = ("researcher", "engineer", "student")


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_runs_and_says_what_it_is_kept_with(name):
    answer = run_tool("notebooks", name, "--check")
    assert (answer.returncode, answer.stdout.strip()) == (0, "up to date"), answer.stdout + answer.stderr


def test_a_notebook_that_says_something_else_is_found_and_written_anew(tmp_path):
    for file in PATHS.glob("student.*"):
        shutil.copy(file, tmp_path)
    kept = tmp_path / "student.ipynb"
    text = kept.read_text(encoding="utf-8")
    kept.write_text(text.replace("arrived without a violation after", "arrived at"), encoding="utf-8")
    answer = run_tool("notebooks", "--check", "--paths", tmp_path)
    assert (answer.returncode, answer.stdout) == (1, "out of date: student\n")
    answer = run_tool("notebooks", "--paths", tmp_path)
    assert (answer.returncode, answer.stdout) == (0, "written: student\n")
    assert json.loads(kept.read_text(encoding="utf-8"))["cells"] == json.loads(text)["cells"]


def test_a_page_that_is_not_there_is_wrong_usage():
    answer = run_tool("notebooks", "engineers")
    assert answer.returncode == 2
    assert "no page named engineers" in answer.stderr


def test_every_command_of_the_notebooks_has_ended_as_its_page_says():
    """None was used wrongly (2); a red verdict (1) is what the engineer's page shows."""
    for name in NAMES:
        notebook = json.loads((PATHS / f"{name}.ipynb").read_text(encoding="utf-8"))
        said = "".join("".join(one.get("text", "")) for cell in notebook["cells"] for one in cell.get("outputs", ()))
        codes = {line for line in said.splitlines() if line.startswith("[exit code")}
        assert codes <= ({"[exit code 1]"} if name == "engineer" else {"[exit code 0]"})
