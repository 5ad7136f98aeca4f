"""The walk through one step names files and functions that are there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
TEXT = (ROOT / "docs" / "one_step.md").read_text(encoding="utf-8")
PACKAGE = ROOT / "sumo_reactive"
FILES = sorted(set(re.findall(r"`((?:driver|sumo)/[\w/]+\.py)`", TEXT)))
NAMED = re.findall(r"`(\w+(?:\.\w+)?)`\s+\(`([\w/]+\.py)`", TEXT)
"""What is named together with its file."""


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_the_walk_exists(name):
    assert (PACKAGE / name).is_file()


@pytest.mark.parametrize(("name", "file"), NAMED)
def test_a_name_of_the_walk_is_defined_in_its_file(name, file):
    source = (PACKAGE / file).read_text(encoding="utf-8")
    assert all(re.search(rf"^ *(?:def|class) {part}\b", source, re.MULTILINE) for part in name.split("."))


def test_the_walk_visits_every_room_of_a_step():
    assert {file.rsplit("/", 1)[0] for file in FILES} >= {
        "driver", "driver/field", "driver/nouns", "driver/pilot", "driver/pilot/rules", "driver/vehicle", "driver/view"
    }  # fmt: skip
    assert len(NAMED) > 15
