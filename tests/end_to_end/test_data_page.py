"""Each block of docs/data.md is run in order, on the records that its commands make."""

import re
import shlex
import shutil
import subprocess
import sys

import pytest
from helpers.programs import ROOT, sumo_reactive

SMALL = """[experiment]
scenarios = ["../scenarios/four_way_priority.toml"]
seeds = [1]
store = "../runs/grid.duckdb"
"""
BLOCKS = re.findall(r"^```(bash|python)\n(.*?)^```$", (ROOT / "docs" / "data.md").read_text(), re.DOTALL | re.MULTILINE)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder where the commands of the page have been run."""
    folder = tmp_path_factory.mktemp("data")
    shutil.copytree(ROOT / "scenarios", folder / "scenarios")
    shutil.copytree(ROOT / "networks", folder / "networks")
    (folder / "experiments").mkdir()
    (folder / "experiments" / "grid.toml").write_text(SMALL, encoding="utf-8")
    for kind, block in BLOCKS:
        for line in block.splitlines() if kind == "bash" else ():
            program, *words = shlex.split(line)
            assert program == "sumo-reactive" and sumo_reactive(*words, cwd=folder).returncode == 0, line
    return folder


@pytest.mark.parametrize("k", range(len([kind for kind, _ in BLOCKS if kind == "python"])))
def test_a_query_of_the_page_gives_rows(place, k):
    code = [block for kind, block in BLOCKS if kind == "python"][k]
    answer = subprocess.run([sys.executable, "-c", code], cwd=place, capture_output=True, text=True, timeout=60, check=False)
    assert answer.returncode == 0, answer.stderr
    rows = [line for line in answer.stdout.splitlines() if line.startswith("│")]
    assert len(rows) > 2, answer.stdout  # names, types, and what was found
