"""The glossary has every noun of the driver with its file, and no home-made word is left in the package."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "sumo_reactive"
TEXT = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| (?:[\w -]+, )?`(\w+)` \| [^|]+ \| `([\w/]+\.py)` \|$", TEXT, re.MULTILINE)
"""What each row defines, and the file that owns it."""

ROOMS = ("nouns", "world", "pilot", "field")
NAMES = {
    "Pose", "VehicleState", "Command", "Lane", "Connection", "Junction", "stop_line", "ConflictRegion", "PostConflictRegion",
    "RightOfWay", "TimeConstraint", "leaders", "gap_for_follower", "time_headway", "arrival", "clearance", "is_enough",
    "lane_room", "times_to_collision", "PostEncroachment", "Event", "Premises", "Behaviour", "Instruction", "Decision",
    "off_tracking_of", "OccupiedLane", "lateral_conflicts", "parallel_lanes", "leave_queue", "Rerouting", "ObservedVehicle",
    "unmapped_lanes", "walk",
}  # fmt: skip
"""The field's terms, or what carries them in the code."""

HOME_MADE = ("haunt", "straddl", "abreast", "waysbeside", "heldup", "wayround", "spectator", "overlooked")
"""Words that others have a term for, without underscores."""


def classes() -> Iterator[tuple[str, str]]:
    """Yield every public class of the driver's rooms with its file."""
    for room in ROOMS:
        for file in sorted((PACKAGE / "driver" / room).rglob("*.py")):
            for node in ast.parse(file.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    yield node.name, file.relative_to(PACKAGE).as_posix()


def identifiers(file: Path) -> Iterator[str]:
    """Yield the name of a file and all that it names."""
    yield file.stem
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        yield from (name for field in ("name", "id", "attr", "arg") if isinstance(name := getattr(node, field, None), str))


def test_every_line_of_the_glossary_is_read():
    assert len(ROWS) == sum(line.startswith("| ") and line != "| term | meaning | file |" for line in TEXT.splitlines())


def test_every_noun_of_the_driver_is_in_the_glossary_with_its_file():
    rooms = tuple(f"driver/{room}/" for room in ROOMS)
    assert {(name, file) for name, file in ROWS if name[0].isupper() and file.startswith(rooms)} == set(classes())


def test_the_fields_terms_are_in_the_glossary():
    assert NAMES - {name for name, _ in ROWS} == set()


def test_no_term_is_told_twice():
    assert [name for name, times in Counter(name for name, _ in ROWS).items() if times > 1] == []


@pytest.mark.parametrize(("name", "file"), ROWS)
def test_a_term_is_owned_by_the_file_that_the_glossary_names(name, file):
    assert name in set(identifiers(PACKAGE / file))


def test_no_home_made_word_names_anything():
    found = {(name, file.name) for file in PACKAGE.rglob("*.py") for name in identifiers(file)}
    assert {one for one in found if any(word in one[0].lower().replace("_", "") for word in HOME_MADE)} == set()
