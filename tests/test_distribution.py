"""What is released: a wheel with all that the package reads, and a source distribution that gives the same wheel."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
NOT_BUILT_FROM = (".*", "__pycache__", "build", "dist", "*.egg-info", "docs", "networks", "runs")
BESIDE_THE_PACKAGE = {"LICENSE", "README.md", "CHANGELOG.md", "CITATION.cff", "pyproject.toml", "MANIFEST.in"}
MADE_BY_THE_BUILD = {"PKG-INFO", "setup.cfg", "sumo_reactive.egg-info"}
USE = "import sumo_reactive; print(sumo_reactive.__file__); from sumo_reactive.__main__ import main; main()"


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A folder with the source distribution, the wheel that is made from it, and in `tree/` the wheel made from the tree."""
    place = tmp_path_factory.mktemp("built")
    shutil.copytree(ROOT, place / "copy", ignore=shutil.ignore_patterns(*NOT_BUILT_FROM))
    for options in (["--outdir", place], ["--wheel", "--outdir", place / "tree"]):
        command = [sys.executable, "-m", "build", "--no-isolation", *map(str, options), "."]
        answer = subprocess.run(command, cwd=place / "copy", capture_output=True, text=True, timeout=240, check=False)
        assert answer.returncode == 0, answer.stdout + answer.stderr
    return place


def wheel_in(folder):
    """Return the only wheel in a folder, opened."""
    (file,) = folder.glob("*.whl")
    return zipfile.ZipFile(file)


def test_the_wheel_made_from_the_source_distribution_is_the_one_made_from_the_tree(built):
    with wheel_in(built) as one, wheel_in(built / "tree") as other:
        assert {it.filename: it.CRC for it in one.infolist()} == {it.filename: it.CRC for it in other.infolist()}


def test_the_wheel_holds_each_file_of_the_package_and_nothing_else(built):
    package = ROOT / "sumo_reactive"
    files = {file.relative_to(ROOT).as_posix() for file in package.rglob("*") if file.is_file()}
    with wheel_in(built) as wheel:
        told = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert told == {name for name in files if "__pycache__" not in name}


def test_the_source_distribution_holds_what_a_reader_of_it_needs_and_no_part_of_the_tests(built):
    (file,) = built.glob("*.tar.gz")
    with tarfile.open(file) as source:
        tops = {Path(name).parts[1] for name in source.getnames() if len(Path(name).parts) > 1}
    assert tops == BESIDE_THE_PACKAGE | MADE_BY_THE_BUILD | {"sumo_reactive"}


def test_the_demo_runs_from_the_wheel_alone(built, tmp_path):
    with wheel_in(built) as wheel:
        wheel.extractall(tmp_path / "packages")
    told = subprocess.run(
        [sys.executable, "-c", USE, "demo", "-q"], cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(tmp_path / "packages")},
        capture_output=True, text=True, timeout=240, check=False,
    )  # fmt: skip
    assert told.returncode == 0, told.stderr
    assert Path(told.stdout.splitlines()[0]).is_relative_to(tmp_path / "packages")
    assert (tmp_path / told.stdout.splitlines()[1]).is_file()
