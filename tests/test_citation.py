"""The citation is of this version."""

import re
import tomllib
from pathlib import Path

import sumo_reactive

ROOT = Path(__file__).resolve().parents[1]


def test_the_citation_names_the_version_and_the_licence_of_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    told = dict(re.findall(r"^([\w-]+): (.+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE))
    assert (told["version"], told["license"]) == (sumo_reactive.__version__, project["license"])
    assert told["title"] in (ROOT / "README.md").read_text(encoding="utf-8")
