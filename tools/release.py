"""What a release says of itself: checks that a tag, the package, the citation and the changelog name one version.

    python tools/release.py v1.2.3

It prints the changelog's part of that version, and exits with 1 and one line naming file and place where one differs, or
where the version has no date yet.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

_VERSIONS = {"sumo_reactive/__init__.py": r'__version__ = "(.+)"', "CITATION.cff": r"version: (.+)"}
"""Where a version stands, beside the changelog; `pyproject.toml` takes it from the package."""

_HEADING = re.compile(r"## \[(?P<version>[^\]]+)\] - (?P<date>.+)")
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}")


class ReleaseError(Exception):
    """What is wrong, with file and place."""


def notes_of(tag: str, root: Path) -> str:
    """Return what the changelog says of the version that a tag names; raise ReleaseError if one thing is not ready."""
    version = tag.removeprefix("v")
    if version == tag:
        raise ReleaseError(f"tag '{tag}': a tag of a release begins with 'v'")
    for name, pattern in _VERSIONS.items():
        number, found = _first(root / name, re.compile(pattern))
        if found[1] != version:
            raise ReleaseError(f"{name}:{number}: version {found[1]}, but the tag is {tag}")
    return _part_of(version, root / "CHANGELOG.md")


def _part_of(version: str, changelog: Path) -> str:
    number, heading = _first(changelog, _HEADING)
    place = f"{changelog.name}:{number}"
    if heading["version"] != version:
        raise ReleaseError(f"{place}: version {heading['version']}, but the tag is v{version}")
    if not _DATE.fullmatch(heading["date"]):
        raise ReleaseError(f"{place}: '{heading['date']}' where the date of the release has to be")
    lines = changelog.read_text(encoding="utf-8").splitlines()[number:]
    end = next((k for k, line in enumerate(lines) if _HEADING.fullmatch(line)), len(lines))
    return "\n".join(lines[:end]).strip() + "\n"


def _first(file: Path, pattern: re.Pattern[str]) -> tuple[int, re.Match[str]]:
    """Return the first line that is as a pattern says, and its number."""
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1):
        if found := pattern.fullmatch(line):
            return number, found
    raise ReleaseError(f"{file.name}: no line like '{pattern.pattern}'")


def main(arguments: list[str]) -> int:
    """Print the notes of the release that a tag names; return the exit code."""
    if len(arguments) != 1:
        print("usage: python tools/release.py TAG", file=sys.stderr)
        return 2
    try:
        print(notes_of(arguments[0], ROOT), end="")
    except ReleaseError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
