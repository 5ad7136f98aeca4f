"""The jobs of docs/ci.md: every line of them is run as a runner does, with a cache that an earlier run has left."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from helpers.programs import ROOT, compile_kernels

from sumo_reactive.driver.kernel_folder import CACHE_FOLDER

PAGE = (ROOT / "docs" / "ci.md").read_text(encoding="utf-8")
HUB, LAB = (yaml.safe_load(block) for block in re.findall(r"^```yaml\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE))
EVERYBODYS = 0o777


@pytest.fixture
def project(tmp_path):
    """A project with a scenario, a home of its own, and programs on the path: sumo-reactive, and a pip that only speaks."""
    folder, programs = tmp_path / "project", tmp_path / "bin"
    (folder / "scenarios").mkdir(parents=True)
    programs.mkdir()
    (tmp_path / "home").mkdir()
    shutil.copy(ROOT / "scenarios" / "four_way_priority.toml", folder / "scenarios")
    shutil.copytree(ROOT / "networks" / "four_way_priority", folder / "networks" / "four_way_priority")
    for name, line in (("pip", 'echo "pip $@"'), ("sumo-reactive", f'exec "{sys.executable}" -m sumo_reactive "$@"')):
        (programs / name).write_text(f"#!/bin/sh\n{line}\n", encoding="utf-8")
        (programs / name).chmod(0o755)
    return folder


def run_lines(lines, folder):
    """Run lines as a runner does, in one shell; return how that ended."""
    removed = {"XDG_CACHE_HOME", "SUMO_REACTIVE_KERNELS"}
    environment = {name: value for name, value in os.environ.items() if name not in removed} | {
        "HOME": str(folder.parent / "home"), "PATH": f"{folder.parent / 'bin'}{os.pathsep}{os.environ['PATH']}",
        "SUMO_REACTIVE": "a.whl", "PYTHONPATH": str(ROOT),
    }  # fmt: skip
    command = ["bash", "-ec", "\n".join(lines)]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=280, check=False)


def left_by_an_earlier_run(place):
    """Put the kernels into a cache as it is restored, compiled before if need be."""
    compile_kernels()
    half_written = shutil.ignore_patterns(".*")
    shutil.copytree(CACHE_FOLDER, place / "sumo_reactive" / CACHE_FOLDER.name, ignore=half_written)


def require_told(answer, folder):
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "pip install a.whl" in answer.stdout and "2 of 2 met" in answer.stdout
    assert "compiling" not in answer.stderr
    assert "<testsuite" in (folder / "verdicts.xml").read_text(encoding="utf-8")


def test_the_job_on_github_finds_its_kernels_and_tells_its_verdicts(project):
    steps = HUB["jobs"]["check"]["steps"]
    kept = next(step["with"]["path"].split() for step in steps if step.get("uses", "").startswith("actions/cache"))
    place = Path(kept[1].replace("~", str(project.parent / "home")))
    assert place.name == "sumo_reactive"
    left_by_an_earlier_run(place.parent)
    require_told(run_lines([step["run"] for step in steps if "run" in step], project), project)


def test_the_job_on_gitlab_finds_its_kernels_though_everybody_may_write_to_its_folder(project):
    job = LAB["scenarios"]
    assert job["cache"]["paths"] == [".cache"]
    left_by_an_earlier_run(project / ".cache")
    for folder in (project, *(one for one in project.rglob("*") if one.is_dir())):
        folder.chmod(EVERYBODYS)
    lines = [*job["before_script"], *job["script"], *job["after_script"]]
    require_told(run_lines(lines, project), project)
    assert (project / ".cache" / "sumo_reactive" / CACHE_FOLDER.name / "complete").is_file()


def test_the_first_job_on_gitlab_has_an_empty_cache_to_copy(project):
    answer = run_lines([*LAB["scenarios"]["before_script"], "ls ~/.cache"], project)
    assert (answer.returncode, answer.stdout) == (0, "sumo_reactive\n")
