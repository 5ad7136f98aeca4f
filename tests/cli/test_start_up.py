"""What commands load, and what they do without: it is most of the time that a short one takes."""

import subprocess
import sys
from pathlib import Path

import pytest
from helpers.situations import NETWORKS

OF_PAGES = ("jinja2", "matplotlib", "pandas", "plotly", "rich")
OF_DRIVING = ("duckdb", "libsumo", "numba", "numpy", "scipy", "shapely", "sumolib")

LOADED = """
import sys
from sumo_reactive.cli import main
try:
    main()
except SystemExit as end:
    print(f"loaded {end.code}", *sorted({name.partition(".")[0] for name in sys.modules} & set({heavy!r})))
"""


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    file = tmp_path / "short.toml"
    config = NETWORKS / "four_way_priority" / "four_way_priority.sumocfg"
    file.write_text(f"[scenario]\nconfig = '{config.as_posix()}'\nego = 'ego'\nuntil_s = 20.0\n[expect]\narrived = false\n")
    return file


def loaded(heavy: tuple[str, ...], *arguments: str) -> str:
    command = [sys.executable, "-c", LOADED.replace("{heavy!r}", repr(heavy)), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1]


def test_the_package_itself_loads_nothing_heavy() -> None:
    code = f"import sys, sumo_reactive; print(*(name for name in {OF_PAGES + OF_DRIVING!r} if name in sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == ""


def test_check_leaves_simulating_to_its_processes_and_loads_nothing_for_it(scenario: Path) -> None:
    assert loaded(OF_PAGES + OF_DRIVING, "check", str(scenario)) == "loaded 0"


def test_run_loads_nothing_that_makes_pages(scenario: Path) -> None:
    assert loaded(OF_PAGES, "run", str(scenario), "--quiet") in ("loaded 0", "loaded 1")
