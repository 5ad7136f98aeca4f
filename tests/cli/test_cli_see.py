"""`figure` and `film` on the command line: what they write, and the one line for what they cannot do."""

import shlex

import pytest
from helpers.programs import ROOT, sumo_reactive
from helpers.recordings import made_record, step

PAGE = (ROOT / "docs" / "figures.md").read_text(encoding="utf-8")
MISSING = "import importlib.util as u; found = u.find_spec; u.find_spec = lambda name: None if name == {!r} else found(name)"


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    return made_record(tmp_path_factory.mktemp("record") / "out", [step(k) for k in range(30)])


def test_every_command_of_the_page_does_what_it_says(tmp_path):
    (block,) = (part.split("```")[0] for part in PAGE.split("```bash\n")[1:])
    for line in block.splitlines():
        arguments = [word.replace("scenarios/", f"{ROOT}/scenarios/") for word in shlex.split(line)[1:]]
        answer = sumo_reactive(*arguments, cwd=tmp_path)
        assert answer.returncode == 0, answer.stderr
    assert {"moment.pdf", "overtaking.svg", "crossing.gif"} <= {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("figure", "--at", "1", "-o", "a.bmp"), "a figure is a file .png, .svg, .pdf"),
        (("figure", "--at", "99", "-o", "a.png"), "99 s is outside the run"),
        (("film", "-o", "a.avi"), "a film is a file .mp4 or .gif"),
        (("film", "--from", "2", "--to", "1", "-o", "a.gif"), "no part of the run"),
    ],
)
def test_what_cannot_be_drawn_is_one_line(record, tmp_path, arguments, told):
    command, *others = arguments
    answer = sumo_reactive(command, record, *others, cwd=tmp_path)
    assert (answer.returncode, answer.stdout, list(tmp_path.iterdir())) == (2, "", [])
    assert told in answer.stderr
    assert answer.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("module", "arguments", "extra"),
    [
        ("matplotlib", ("figure", "--at", "1", "-o", "a.png"), "plot"),
        ("matplotlib", ("film", "-o", "a.gif"), "plot"),
        ("imageio_ffmpeg", ("film", "-o", "a.mp4"), "film"),
    ],
)
def test_a_library_that_is_missing_is_told_with_the_command_that_installs_it(record, tmp_path, module, arguments, extra):
    command, *others = arguments
    answer = sumo_reactive(command, record, *others, cwd=tmp_path, code=MISSING.format(module))
    assert answer.returncode == 2
    assert answer.stderr == f"sumo-reactive: this needs {module}: pip install 'sumo-reactive[{extra}]'\n"
