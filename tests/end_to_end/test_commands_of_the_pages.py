"""Every command that a page shows does what it says: in order, in a folder where what it names is there."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys

import pytest
from helpers.programs import ROOT, sumo_reactive

PAGES = ("README.md", *(f"docs/{name}.md" for name in ("batch", "check", "compare", "publish", "replay", "run")))
"""Those of demo.md, figures.md and drivers.md have tests of their own, with what those say."""

SMALL = """[experiment]
scenarios = ["../scenarios/right_before_left.toml"]
seeds = [1]
drivers = ["reactive", "sumo"]
store = "../runs/grid.duckdb"
"""

MINE = """
from sumo_reactive.lab.drivers.protocol import LaneCommand

class Driver:
    def start(self, mission): pass
    def step(self, view): return LaneCommand(5.0 - view.ego.speed, is_checked=True)
    def end(self, result): pass
"""

CONFIG = """<configuration><input>
<net-file value="networks/right_before_left/right_before_left.net.xml"/><route-files value="my.rou.xml"/>
</input><time><end value="700"/></time></configuration>
"""

WAYS = ("from_south to_north", "from_east to_west", "from_north to_south", "from_west to_east")


def commands_of(page):
    """Return the commands of a page's blocks, without what is said of them."""
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = re.findall(r"^```bash\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    return [shlex.split(line, comments=True) for block in blocks for line in block.splitlines() if line.strip()]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with all that the pages' commands name: a city of 45 cars, two scenarios, an experiment, a driver."""
    folder = tmp_path_factory.mktemp("pages")
    shutil.copytree(ROOT / "networks", folder / "networks")
    (folder / "scenarios").mkdir()
    for name in ("figure4", "four_way_priority", "roundabout", "right_before_left"):
        shutil.copy(ROOT / "scenarios" / f"{name}.toml", folder / "scenarios")
    (folder / "experiments").mkdir()
    (folder / "experiments" / "grid.toml").write_text(SMALL, encoding="utf-8")
    (folder / "experiment.toml").write_text(SMALL.replace("../", ""), encoding="utf-8")
    (folder / "mine.py").write_text(MINE, encoding="utf-8")
    names = {9: "veh_40", 40: "veh_9"}  # who is near when veh_12 comes
    cars = "".join(
        f'<vehicle id="{names.get(k, f"veh_{k}")}" type="{"taxi" if k % 9 == 0 else "car"}" depart="{2 * k}">'
        f'<route edges="{WAYS[k % 4]}"/></vehicle>'
        for k in range(45)
    )
    (folder / "my.rou.xml").write_text(f'<routes><vType id="car"/><vType id="taxi"/>{cars}</routes>', encoding="utf-8")
    (folder / "my.sumocfg").write_text(CONFIG, encoding="utf-8")
    assert sumo_reactive("batch", "experiments/grid.toml", "--workers", "1", cwd=folder).returncode == 0
    return folder


@pytest.mark.parametrize("page", PAGES)
def test_every_command_of_a_page_does_what_it_says(place, page):
    shutil.rmtree(place / "DIR", ignore_errors=True)
    if page == "docs/batch.md":
        assert sumo_reactive("run", "my.sumocfg", "--ego", "veh_12", "--out", "DIR", cwd=place).returncode == 0
    for words in commands_of(page):
        if words[1] == "run" and "--out" in words:
            shutil.rmtree(place / words[words.index("--out") + 1], ignore_errors=True)
        code, said = answer_to(words, place)
        is_driver_on_trial = "mine:Driver" in words
        assert code == 0 or (code == 1 and is_driver_on_trial), (words, said)


def answer_to(words, place):
    """Run a command with few seeds, and no ego but the two named; return its exit code and all that it said."""
    few = ["1-2" if word in ("1-10", "1-3") else word for word in words[1:]]
    if words[0] == "pytest":
        command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *few]
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, timeout=280, check=False)
        return done.returncode, done.stdout + done.stderr
    assert words[0] == "sumo-reactive", words
    if few[0] == "compare" and "--ego" not in few and "--ego-probability" not in few:
        few += ["--ego", "veh_12"]
    answer = sumo_reactive(*few, cwd=place)
    return answer.returncode, answer.stdout + answer.stderr
