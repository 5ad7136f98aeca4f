"""The page on drivers is true: its blocks run as they are printed."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from helpers.programs import sumo_reactive

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs" / "drivers.md").read_text(encoding="utf-8")


def blocks(language):
    """Return the code blocks of a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)


@pytest.fixture
def folder(tmp_path):
    """A folder as the page takes it: scenarios with their networks, and the examples on the way."""
    for name in ("scenarios", "networks", "examples/drivers/sumo_reactive_examples"):
        (tmp_path / Path(name).name).symlink_to(ROOT / name)
    return tmp_path


@pytest.mark.parametrize("text", blocks("python"))
def test_a_block_of_python_runs(folder, text):
    command = [sys.executable, "-c", text]
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=240, check=False)
    assert (answer.returncode, answer.stdout.strip()) == (0, "arrived without a violation"), answer.stderr


@pytest.mark.parametrize("line", [line for text in blocks("bash") for line in text.splitlines()])
def test_a_line_of_the_shell_runs(folder, line):
    program, *words = shlex.split(line, comments=True)
    assert program == "sumo-reactive"
    answer = sumo_reactive(*words, cwd=folder)
    assert answer.returncode == 0, answer.stdout + answer.stderr
