"""Cases by number: which files are spoilt, and which command then reads them."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from random import Random

from fuzzing.material import STORE
from fuzzing.mutations import WORDS, spoil

UNTIL = ("--until", "15")
RECORD = ("summary.json", "trajectory.parquet", "decisions.jsonl", "regions.json")
OPTIONS = (
    "--ego", "--ego-type", "--ego-probability", "--seed", "--step-length", "--profile", "--delays", "--until", "--until-end",
    "--quiet", "--overwrite", "--at", "--metric", "--sql", "--jobs", "--time-limit", "--horizon", "--help", "--bogus", "-q",
)  # fmt: skip
SUMO_OPTIONS = (
    "--help", "-V", "--remote-port", "--seed", "--step-length", "--begin", "--end", "--time-to-teleport", "--scale", "-a",
    "--collision.action", "--net-file", "--route-files", "--tripinfo-output", "--device.rerouting.probability", "--mesosim",
    "--threads", "--load-state", "--save-state.times", "--max-num-vehicles", "--xml-validation", "--lateral-resolution",
)  # fmt: skip

Made = tuple[list[str], str]
"""A command line, and what was done to what it reads."""


def _scenario(folder: Path, material: Path, random: Random) -> Made:
    told = spoil(folder / "a.toml", random)
    return random.choice((["run", "a.toml", *UNTIL], ["run", "a.toml"], ["batch", "experiment.toml", "--dry-run"])), told


def _configuration(folder: Path, material: Path, random: Random) -> Made:
    return ["run", "a.sumocfg", *UNTIL], spoil(folder / "a.sumocfg", random)


def _network(folder: Path, material: Path, random: Random) -> Made:
    name = random.choice(("a", "a", "gz"))
    told = spoil(folder / ("a.net.xml" if name == "a" else "a.net.xml.gz"), random)
    return ["run", f"{name}.sumocfg", *random.choice(((), ("--ego", "ego"))), *UNTIL], told


def _traffic(folder: Path, material: Path, random: Random) -> Made:
    told = spoil(folder / random.choice(("a.rou.xml", "a.rou.xml", "a.add.xml")), random)
    several = random.choice(((), (), ("--ego-probability", "0.5"), ("--ego", "ego")))
    return ["run", "a.sumocfg", *UNTIL, *several, *random.choice(((), ("--out", "out")))], told


def _experiment(folder: Path, material: Path, random: Random) -> Made:
    return ["batch", "experiment.toml", "--dry-run"], spoil(folder / "experiment.toml", random)


def _record(folder: Path, material: Path, random: Random) -> Made:
    told = "; ".join(spoil(folder / "record" / random.choice(RECORD), random) for _ in range(random.choice((1, 1, 2))))
    return random.choice((["explain", "record"], ["explain", "record", "--at", "20"], ["report", "record"])), told


def _fleet(folder: Path, material: Path, random: Random) -> Made:
    return ["report", "fleet"], spoil(folder / "fleet" / "fleet.json", random)


def _store(folder: Path, material: Path, random: Random) -> Made:
    shutil.copy(material / STORE, folder)
    told = spoil(folder / STORE, random)
    commands = ["results", "store.duckdb"], ["report", "store.duckdb", "--out", "page.html"], ["table", "store.duckdb"]
    return random.choice(commands), told


def _command_line(folder: Path, material: Path, random: Random) -> Made:
    words = random.choice((
        ["run", "a.toml", *UNTIL], ["run", "a.sumocfg", *UNTIL], ["explain", "record"], ["report", "fleet"],
        ["results", "store.duckdb"], ["batch", "experiment.toml", "--dry-run"],
    ))  # fmt: skip
    for _ in range(random.choice((1, 2, 3))):
        words.append(random.choice(OPTIONS))
        if random.random() < 0.8:
            words.append(random.choice(WORDS))
    if random.random() < 0.2:
        words[random.randrange(len(words))] = random.choice(WORDS)
    if words[0] == "run" and random.random() < 0.4:
        words += ["--", random.choice(SUMO_OPTIONS), *random.choice(((), (random.choice(WORDS),)))]
    return [word.replace("\0", "") for word in words], "words"


def _in_processes(folder: Path, material: Path, random: Random) -> Made:
    told = spoil(folder / random.choice(("a.toml", "a.sumocfg", "a.net.xml", "a.rou.xml", "a.add.xml")), random)
    compared = ["compare", "a.toml", "--until", "15", "--jobs", "2", "--out", "out"]
    return random.choice((["check", "a.toml", "--junit", "j.xml", "--time-limit", "40"], compared)), told


MAKERS: dict[str, tuple[float, Callable[[Path, Path, Random], Made]]] = {
    "scenario": (12, _scenario), "configuration": (10, _configuration), "network": (20, _network), "traffic": (20, _traffic),
    "experiment": (8, _experiment), "record": (14, _record), "fleet": (3, _fleet), "store": (4, _store),
    "command line": (9, _command_line), "in processes": (0.5, _in_processes),
}  # fmt: skip
"""How often a kind of input comes, and who makes it."""


def kind_of(number: int, kinds: tuple[str, ...] = tuple(MAKERS)) -> str:
    """Return the kind of a case."""
    return Random(f"kind {number}").choices(kinds, [MAKERS[kind][0] for kind in kinds])[0]


def make_case(number: int, kind: str, folder: Path, material: Path) -> Made:
    """Spoil what `folder` holds of the material for a case; return its command line and what was done."""
    return MAKERS[kind][1](folder, material, Random(f"case {number}"))
