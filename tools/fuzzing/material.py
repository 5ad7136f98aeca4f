"""What is mutated: a scenario with its network, an experiment, the records of one ego and of two, and a store."""

from __future__ import annotations

import gzip
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NETWORK = ROOT / "networks" / "four_way_priority"

STORE = "store.duckdb"

SCENARIO = """[scenario]
config = "a.sumocfg"
ego = "ego"
seeds = [42]
step_length_s = 0.1
until_s = 20.0
parameters = {}
obstacle_polygons = "obstacle"

[expect]
arrived = false
violations = 0

[expect.metrics]
duration_s = { max = 60 }
"""

EXPERIMENT = """[experiment]
scenarios = ["a.toml"]
seeds = [1]
drivers = ["reactive", "sumo"]
metrics = ["arrived", "duration_s", "rms_jerk_m_s3"]
store = "store.duckdb"
until_s = 12.0
wall_limit_s = 50.0
retries = 0

[egos]
names = ["ego"]

[options]
"lanechange.duration" = 0
"""

CONFIG = """<configuration>
    <net-file value="{net}"/>
    <route-files value="a.rou.xml"/>
    <additional-files value="a.add.xml"/>
    <begin value="0"/>
    <end value="200"/>
    <step-length value="0.1"/>
</configuration>
"""

ADDITIONAL = """<additional>
    <poly id="stone" type="obstacle" shape="-100,3 -99,3 -99,4 -100,4" color="1,0,0"/>
    <poly id="house" type="building" shape="20,20 30,20 30,30 20,30" color="1,0,0"/>
</additional>
"""

_PARAMETERS = "".join(
    f'<param key="reactive.{name}" value="{value}"/>'
    for name, value in {"width": 1.8, "wheelbase": 2.7, "max_steering_angle": 0.6, "time_headway": 1.1}.items()
)


def make(folder: Path) -> None:
    """Write the scenario into a folder, and run it for the records and the store."""
    folder.mkdir(parents=True)
    net = (NETWORK / "four_way_priority.net.xml").read_bytes()
    (folder / "a.net.xml").write_bytes(net)
    (folder / "a.net.xml.gz").write_bytes(gzip.compress(net, mtime=0))
    routes = (NETWORK / "four_way_priority.rou.xml").read_text(encoding="utf-8")
    (folder / "a.rou.xml").write_text(_with_parameters(routes), encoding="utf-8")
    (folder / "a.add.xml").write_text(ADDITIONAL, encoding="utf-8")
    (folder / "a.sumocfg").write_text(CONFIG.format(net="a.net.xml"), encoding="utf-8")
    (folder / "gz.sumocfg").write_text(CONFIG.format(net="a.net.xml.gz"), encoding="utf-8")
    (folder / "a.toml").write_text(SCENARIO, encoding="utf-8")
    (folder / "experiment.toml").write_text(EXPERIMENT, encoding="utf-8")
    others = [word for name in ("ego", "west_east.0") for word in ("--ego", name)]
    _run(folder, "run", "a.sumocfg", "--ego", "ego", "--until", "30", "--out", "record")
    _run(folder, "run", "a.sumocfg", *others, "--until", "15", "--out", "fleet")
    _run(folder, "batch", "experiment.toml", "--workers", "1")


def copy(material: Path, folder: Path) -> None:
    """Give a case its own material; the store, which is large, only where it is asked for."""
    shutil.copytree(material, folder, ignore=shutil.ignore_patterns(STORE))


def _with_parameters(routes: str) -> str:
    """Return routes whose first vehicle type has parameters of this driver."""
    head, mark, tail = routes.partition("<vType ")
    inside, end, rest = tail.partition("/>")
    return f"{head}{mark}{inside}>{_PARAMETERS}</vType>{rest}" if end else routes


def _run(folder: Path, *arguments: str) -> None:
    command = [sys.executable, "-m", "sumo_reactive", *arguments]
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    if answer.returncode not in (0, 1):
        raise RuntimeError(f"{arguments}: {answer.returncode}\n{answer.stdout}{answer.stderr}")
