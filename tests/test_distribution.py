"""What is released: a wheel with all that the package reads, and a source distribution that gives the same wheel."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest
import yaml

import sumo_reactive

ROOT = Path(__file__).resolve().parents[1]
NOT_BUILT_FROM = (".*", "__pycache__", "build", "dist", "*.egg-info", "docs", "networks", "runs")
BESIDE_THE_PACKAGE = {"LICENSE", "README.md", "CHANGELOG.md", "CITATION.cff", "pyproject.toml", "MANIFEST.in"}
MADE_BY_THE_BUILD = {"PKG-INFO", "setup.cfg", "sumo_reactive.egg-info"}
WORKFLOW = ROOT / ".github" / "workflows" / "release.yml"
OFFLINE = {"PIP_NO_INDEX": "1", "PIP_NO_DEPS": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
"""What the package needs is found where it is installed already: no test depends on a network."""


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A folder with all that the release workflow makes of a tag, and in `tree/` the wheel made from the tree itself."""
    place = tmp_path_factory.mktemp("built") / "copy"
    shutil.copytree(ROOT, place, ignore=shutil.ignore_patterns(*NOT_BUILT_FROM))
    changelog = place / "CHANGELOG.md"
    changelog.write_text(changelog.read_text(encoding="utf-8").replace("- Unreleased", "- 2026-11-24", 1), encoding="utf-8")
    environment = os.environ | OFFLINE | {
        "GITHUB_REF_NAME": f"v{sumo_reactive.__version__}", "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "PYTHONPATH": sysconfig.get_path("purelib"),
    }  # fmt: skip
    jobs = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))["jobs"]
    lines = [step["run"] for step in jobs["build"]["steps"] if "run" in step]
    for line in (*lines, "python -m build --no-isolation --wheel --outdir tree ."):
        answer = subprocess.run(
            ["bash", "-ec", line], cwd=place, env=environment, capture_output=True, text=True, timeout=240, check=False
        )
        assert answer.returncode == 0, line + answer.stdout + answer.stderr
    return place


def wheel_in(folder):
    """Return the only wheel in a folder, opened."""
    (file,) = folder.glob("*.whl")
    return zipfile.ZipFile(file)


def test_the_wheel_made_from_the_source_distribution_is_the_one_made_from_the_tree(built):
    with wheel_in(built / "dist") as one, wheel_in(built / "tree") as other:
        assert {it.filename: it.CRC for it in one.infolist()} == {it.filename: it.CRC for it in other.infolist()}


def test_the_wheel_holds_each_file_of_the_package_and_nothing_else(built):
    package = ROOT / "sumo_reactive"
    files = {file.relative_to(ROOT).as_posix() for file in package.rglob("*") if file.is_file()}
    with wheel_in(built / "dist") as wheel:
        told = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert told == {name for name in files if "__pycache__" not in name}


def test_the_source_distribution_holds_what_a_reader_of_it_needs_and_no_part_of_the_tests(built):
    (file,) = (built / "dist").glob("*.tar.gz")
    with tarfile.open(file) as source:
        tops = {Path(name).parts[1] for name in source.getnames() if len(Path(name).parts) > 1}
    assert tops == BESIDE_THE_PACKAGE | MADE_BY_THE_BUILD | {"sumo_reactive"}


def test_the_demo_that_the_workflow_runs_is_that_of_the_wheel(built):
    (installed,) = (built / "fresh").glob("lib/python*/site-packages/sumo_reactive/demo/figure4.sumocfg")
    (record,) = built.glob("*/summary.json")
    assert json.loads(record.read_text(encoding="utf-8"))["scenario"] == str(installed)


def test_the_release_is_told_by_the_changelog(built):
    assert (built / "notes.md").read_text(encoding="utf-8").startswith("### Added\n")
