"""Help and completion: what each command's help ends with, and what the shell is told."""

import re
import shlex

import pytest
import typer
from helpers.programs import ROOT, sumo_reactive

from sumo_reactive.cli.app import app

COMMANDS = sorted(typer.main.get_command(app).commands)
PAGE = (ROOT / "docs" / "demo.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("command", COMMANDS)
def test_help_ends_with_an_example_of_options_that_the_command_has(command):
    told = " ".join(sumo_reactive(command, "--help").stdout.split())
    example = told.rpartition("Example: ")[2].split(" -- ")[0]
    program, named, *words = shlex.split(example)
    assert (program, named) == ("sumo-reactive", command)
    assert all(f" {word}" in told.rpartition("Example: ")[0] for word in words if word.startswith("-"))


@pytest.mark.parametrize(
    ("words", "position", "completed"),
    [("sumo-reactive fi", "1", ["figure", "film"]), ("sumo-reactive run --profile p", "3", ["paper"])],
)
def test_a_shell_completes_commands_and_values(words, position, completed):
    asked = {"_SUMO_REACTIVE_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": position}
    answer = sumo_reactive(more_environment=asked)
    assert (answer.returncode, answer.stdout.split()) == (0, completed)


def test_every_command_of_the_demo_page_does_what_it_says(tmp_path):
    (block,) = re.findall(r"^```bash\n(.*?)^```$", PAGE, re.DOTALL | re.MULTILINE)
    for line in block.splitlines():
        answer = sumo_reactive(*shlex.split(line)[1:], cwd=tmp_path)
        assert (answer.returncode, bool(answer.stdout)) == (0, True), answer.stderr
