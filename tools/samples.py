#!/usr/bin/env python3
"""Write the samples of the pages from runs of the code beside them, or compare them.

    python tools/samples.py [NAME…] [--check] [--timings MACHINE] [--pages FOLDER]

A sample stands in README.md or a page of docs/, between `<!-- sample: NAME -->` and `<!-- /sample -->`. What the same
versions do not give again, wall-clock figures, is left out of it; `--timings` writes those apart, from the benchmarks, with
commit, date and the MACHINE in words. Commands run in a copy of scenarios, networks and experiments, as if from the
repository. Exit codes: 0 written or up to date, 1 out of date, 2 wrong usage.
"""

from __future__ import annotations

import argparse
import contextlib
import difflib
import io
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from unittest.mock import patch

from compare_profiles import PROFILES, drive_once, known_names, table

from sumo_reactive.cli.main import main as sumo_reactive
from sumo_reactive.lab.metric_names import METRICS, NETWORK, OTHERS, TIMINGS, Metric

ROOT = Path(__file__).resolve().parent.parent
COPIED = ("scenarios", "networks", "experiments")
LONGEST = 230
"""Characters of a line; what is longer is cut off."""

IN_A_HURRY = """[scenario]
config = "../networks/four_way_priority/four_way_priority.sumocfg"
ego = "ego"

[expect.metrics]
duration_s = { max = 30 }
"""

FEW_SHARES = """[experiment]
scenarios = ["../scenarios/right_before_left.toml"]
seeds = [1, 2, 3]
until_s = 120.0
store = "../runs/few_shares.duckdb"

[egos]
share = [0.0, 1.0]
"""

DIAGRAM_BY_SHARE = """
SELECT parameters->>'share' AS share, edges, begin_s, round(avg(flow_per_h), 1) AS flow_per_h,
round(avg(density_per_km), 2) AS density_per_km, round(sum(flow_per_h) / sum(density_per_km) / 3.6, 2) AS speed_m_s
FROM diagram JOIN trials USING (key) GROUP BY ALL ORDER BY ALL
"""

SHORT_RUN = ("--scenario", str(ROOT / "scenarios" / "multi_lane_road.toml"), "--scale", "3", "--repeats", "3")
"""About 60 vehicles; the cases with more take minutes."""

_BEHAVIOUR = re.compile(r"(Normal driving|Cautious driving|Overtaking|Stopping at a location|Crossing the intersection):")
_NUMBER = re.compile(r"\d+(?:\.\d+)?")
_NO_DIFFERENCE = re.compile(r" 0 +0 … 0$")


def main() -> None:
    """Write or compare what is asked for."""
    asked = _arguments()
    pages = {page: page.read_text(encoding="utf-8") for page in pages_in(asked.pages)}
    fresh = dict(pages)
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for name in COPIED:
            shutil.copytree(ROOT / name, name)
        for name in asked.names or (() if asked.timings else SAMPLES):
            place = place_of(pages, name)
            fresh[place] = replaced(fresh[place], name, SAMPLES[name]())
    if asked.timings:
        place = place_of(pages, "timings")
        fresh[place] = replaced(fresh[place], "timings", timings(asked.timings))
    stale = [name for name in (*SAMPLES, "timings") if _is_stale(pages, fresh, name)]
    for page, text in fresh.items():
        if asked.check:
            before, after = pages[page].splitlines(keepends=True), text.splitlines(keepends=True)
            print("".join(difflib.unified_diff(before, after, page.name, "as it should be", n=1)) if stale else "", end="")
        elif text != pages[page]:
            page.write_text(text, encoding="utf-8")
    print(f"{'out of date' if asked.check else 'written'}: {', '.join(stale)}" if stale else "up to date")
    raise SystemExit(int(asked.check and bool(stale)))


def pages_in(folder: Path) -> list[Path]:
    """Return the pages that may hold samples."""
    return [folder / "README.md", *sorted((folder / "docs").glob("*.md"))]


def place_of(pages: Mapping[Path, str], name: str) -> Path:
    """Return the page that holds a sample; ends with exit code 2 if there is none."""
    found = next((page for page, text in pages.items() if f"<!-- sample: {name} -->" in text), None)
    if found is None:
        print(f"samples: no place for the sample {name}", file=sys.stderr)
        raise SystemExit(2)
    return found


def _is_stale(pages: Mapping[Path, str], fresh: Mapping[Path, str], name: str) -> bool:
    place = place_of(pages, name)
    return not is_alike(sample_in(pages[place], name), sample_in(fresh[place], name))


def _arguments() -> argparse.Namespace:
    """Read the command line; wrong usage ends with exit code 2."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(SAMPLES)}; all without one")
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if a sample is out of date")
    parser.add_argument("--timings", metavar="MACHINE", help="write the timings, too; without a NAME only them")
    parser.add_argument("--pages", type=Path, default=ROOT, metavar="FOLDER", help="of README.md and docs/")
    asked = parser.parse_args()
    if unknown := [name for name in asked.names if name not in SAMPLES]:
        parser.error(f"no sample named {', '.join(unknown)}; there are {', '.join(SAMPLES)}")
    return asked


def is_alike(one: str, other: str) -> bool:
    """Whether two samples say the same but for their columns' widths and two in the last digit of numbers, as machines with
    other vector instructions have them."""
    words, others = one.split(), other.split()
    return len(words) == len(others) and all(map(_is_alike, words, others))


def _is_alike(one: str, other: str) -> bool:
    if one == other or set(one + other) == {"─"}:
        return True
    if _NUMBER.sub("#", one) != _NUMBER.sub("#", other):
        return False
    pairs = zip(_NUMBER.findall(one), _NUMBER.findall(other), strict=True)
    return all(abs(float(a) - float(b)) <= 2.01 * 10.0 ** -max(_digits(a), _digits(b)) for a, b in pairs if a != b)


def _digits(number: str) -> int:
    """Return how many digits of a number stand behind its point; with none, no other number is like it."""
    return len(number.partition(".")[2]) or 9


def sample_in(text: str, name: str) -> str:
    """Return what stands at a sample's place."""
    found = re.search(rf"<!-- sample: {name} -->\n(.*?)<!-- /sample -->", text, re.DOTALL)
    assert found is not None, name
    return found[1]


def replaced(text: str, name: str, sample: str) -> str:
    """Return the text with another sample."""
    before = sample_in(text, name)
    return text.replace(f"<!-- sample: {name} -->\n{before}", f"<!-- sample: {name} -->\n{sample}\n")


def fenced(*lines: str) -> str:
    """Return lines as a block of text, cut where they are too long."""
    cut = (line if len(line) <= LONGEST else f"{line[:LONGEST].rsplit(' ', 1)[0]} …" for line in lines)
    return "\n".join(("```text", *(line.rstrip() for line in cut), "```"))


def said_by(*words: str) -> list[str]:
    """Return the lines that `sumo-reactive` prints."""
    output, errors = io.StringIO(), io.StringIO()
    called = patch.object(sys, "argv", ["sumo-reactive", *words])
    with called, contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        try:
            sumo_reactive()
        except SystemExit as end:
            if end.code not in (0, 1, None):
                raise SystemExit(f"sumo-reactive {' '.join(words)}: {errors.getvalue()}") from end
    return output.getvalue().splitlines()


def run() -> str:
    """The first command's result."""
    labels = tuple(metric.label for metric in TIMINGS.values())
    return fenced(*(line for line in said_by("run", "scenarios/four_way_priority.toml") if not line.startswith(labels)))


def explain() -> str:
    """The story of a run: where the behaviour changes, and every stage of the overtaking."""
    said_by("run", "scenarios/figure4.toml", "--out", "figure4", "--quiet")
    head, *lines, foot = said_by("explain", "figure4")
    kept, before = [], ""
    for line in lines:
        behaviour = (_BEHAVIOUR.findall(line) or [before])[-1]
        if behaviour != before or behaviour == "Overtaking":
            kept.append(line)
        before = behaviour
    return fenced(head, *kept, foot)


def fleet() -> str:
    """Several egos at once."""
    words = ("run", "scenarios/city_grid.toml", "--ego-probability", "0.05", "--until", "60")
    return fenced(f"$ sumo-reactive {' '.join(words)}", *said_by(*words)[:-1])


def check() -> str:
    """A scenario that fails and two that do not."""
    Path("scenarios/in_a_hurry.toml").write_text(IN_A_HURRY, encoding="utf-8")
    lines = said_by("check", "scenarios/in_a_hurry.toml", "scenarios/roundabout.toml", "--jobs", "2")
    return fenced(*(re.sub(r"driven in [\d.]+ s$", "driven in … s", line) for line in lines))


def compare() -> str:
    """A comparison; figures that do not differ are left out."""
    words = ("compare", "scenarios/four_way_priority.toml", "--ego", "ego", "--seed", "1-3", "--jobs", "2")
    return fenced(*(line for line in said_by(*words) if not _NO_DIFFERENCE.search(line)))


def batch() -> str:
    """What the store of a batch says."""
    said_by("batch", "experiments/grid.toml", "--workers", "1")
    words = ("results", "runs/grid.duckdb", "--metric", "duration_s", "--metric", "rms_jerk_m_s3")
    return fenced(*(line for line in said_by(*words) if line.strip()))


def diagram() -> str:
    """Points of the fundamental diagram as the store of a batch with shares of egos has them, means over its seeds."""
    Path("experiments", "few_shares.toml").write_text(FEW_SHARES, encoding="utf-8")
    said_by("batch", "experiments/few_shares.toml", "--workers", "1")
    said = said_by("results", "runs/few_shares.duckdb", "--sql", DIAGRAM_BY_SHARE)
    return fenced(*(line for line in said if line.strip()))


def profiles() -> str:
    """The table of both profiles."""
    return table({name: tuple(drive_once(name, profile) for profile in PROFILES) for name in known_names()})


def metrics() -> str:
    """The tables of all metrics."""
    own = {key: metric for key, metric in METRICS.items() if not key.startswith("events_")}
    events = len(METRICS) - len(own)
    last = f"| `events_…` | event: … |  | how often each of the {events} kinds of event activated the pilot |"
    others = f"A comparison adds, of all others:\n\n{_metric_table(OTHERS)}"
    return f"{_metric_table(own)}\n{last}\n\n{others}\n\nA run with a share of egos has:\n\n{_metric_table(NETWORK)}"


def _metric_table(metrics: Mapping[str, Metric]) -> str:
    rows = (f"| `{one.key}` | {one.label} | {one.unit} | {one.meaning} |" for one in metrics.values())
    return "\n".join(("| key | shown as | unit | what it is |", "|---|---|---|---|", *rows))


def measured_on(machine: str) -> str:
    """Return commit, date and machine in words."""
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True)
    return f"Commit {commit.stdout.strip()}, {datetime.now(UTC):%Y-%m-%d}, {machine}"


def timings(machine: str) -> str:
    """What the benchmarks print, with commit, date and machine."""
    lines = [f"{measured_on(machine)}."]
    for words in (["benchmark_step", "--repeats", "1000"], ["benchmark_run", *SHORT_RUN], ["compare_profiles"]):
        command = [sys.executable, str(ROOT / "tools" / f"{words[0]}.py"), *words[1:]]
        said = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=True).stdout
        if words[0] == "compare_profiles":
            times = said.partition("processor's time:")[2].strip()
            lines.append(f"`tools/compare_profiles.py`, control step, processor's time:\n\n{times}")
        else:
            lines.append(f"`tools/{words[0]}.py`:\n\n{fenced(*said.strip().splitlines())}")
    return "\n\n".join(lines)


SAMPLES: dict[str, Callable[[], str]] = {
    "run": run, "explain": explain, "fleet": fleet, "check": check, "metrics": metrics, "compare": compare, "batch": batch,
    "diagram": diagram, "profiles": profiles,
}  # fmt: skip

if __name__ == "__main__":
    main()
