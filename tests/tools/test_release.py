"""A release is made where tag, package, citation and changelog name one version with a date, and nowhere else."""

import re
import shutil

import pytest
from helpers.programs import ROOT, run_tool
from helpers.tools import tool

import sumo_reactive

FILES = ("CHANGELOG.md", "CITATION.cff", "sumo_reactive/__init__.py")
RELEASE = tool("release")
TAG = f"v{sumo_reactive.__version__}"


@pytest.fixture
def copy(tmp_path):
    """The files that name a version, with a date in the changelog, and an older version below."""
    (tmp_path / "sumo_reactive").mkdir()
    for name in FILES:
        shutil.copy(ROOT / name, tmp_path / name)
    edit(tmp_path / "CHANGELOG.md", r"(?m)^(## \[.+\] - ).+$", r"\g<1>2026-11-24")
    with (tmp_path / "CHANGELOG.md").open("a", encoding="utf-8") as file:
        file.write("\n## [0.0.1] - 2025-01-01\n\n- Older.\n")
    return tmp_path


def edit(file, pattern, text):
    file.write_text(re.sub(pattern, text, file.read_text(encoding="utf-8"), count=1), encoding="utf-8")


def test_the_notes_are_the_part_of_the_changelog_that_is_new(copy):
    notes = RELEASE.notes_of(TAG, copy)
    assert notes.startswith("### Added\n") and "- `bundle` puts a record" in notes and "Older" not in notes


@pytest.mark.parametrize(
    ("name", "pattern", "text", "says"),
    [
        ("CITATION.cff", "^version: .+", "version: 9.9.9", r"CITATION\.cff:\d+: version .+, but the tag is v"),
        ("sumo_reactive/__init__.py", '__version__ = ".+"', '__version__ = "9"', r"__init__\.py:\d+: version 9, but"),
        ("CHANGELOG.md", r"## \[.+\] - 2026", "## [9.9.9] - 2026", r"CHANGELOG\.md:\d+: version 9\.9\.9, but the tag is v"),
        ("CHANGELOG.md", "2026-11-24", "Unreleased", r"CHANGELOG\.md:\d+: 'Unreleased' where the date of"),
        ("CITATION.cff", "^version: .+$", "", r"CITATION\.cff: no line like"),
    ],
)  # fmt: skip
def test_what_names_another_version_or_no_date_is_told_with_its_place(copy, name, pattern, text, says):
    edit(copy / name, f"(?m){pattern}", text)
    with pytest.raises(RELEASE.ReleaseError, match=says):
        RELEASE.notes_of(TAG, copy)


def test_the_tool_tells_in_one_line_and_by_its_exit_code():
    told = {(): (2, "usage"), ("1.2.3",): (1, "begins with 'v'"), ("v0.0.0",): (1, "but the tag is v0.0.0")}
    for arguments, (code, says) in told.items():
        answer = run_tool("release", *arguments)
        assert (answer.returncode, answer.stdout) == (code, "")
        assert says in answer.stderr and answer.stderr.count("\n") == 1
