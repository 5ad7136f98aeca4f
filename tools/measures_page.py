#!/usr/bin/env python3
"""Write the tables of docs/measures.md: the safety measures with their equations, and how they equal SUMO's own.

    python tools/measures_page.py [--check] [--page FILE]

Equations come from the functions that compute them. For the second table an ego that SUMO itself drives carries SUMO's SSM
device: where both take one for following another, each value of SUMO's is set against ours of the same pair and time.
Exit codes: 0 written or up to date, 1 out of date, 2 wrong usage.
"""

from __future__ import annotations

import argparse
import inspect
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from samples import is_alike, replaced, sample_in

from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.lab.driving_score import driving_score
from sumo_reactive.lab.metric_names import METRICS
from sumo_reactive.lab.metrics.encounters import PostEncroachment, TimeToCollision
from sumo_reactive.lab.metrics.moment import Neighbourhood
from sumo_reactive.lab.metrics.safety import deceleration, following, rss
from sumo_reactive.lab.metrics.safety.pairs import PairLog
from sumo_reactive.lab.metrics.safety.series import encounter_columns
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_sumo_driver

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "measures.md"

EQUATIONS: Mapping[str, object] = {
    "min_time_to_collision_s": TimeToCollision, "min_post_encroachment_s": PostEncroachment,
    "min_modified_ttc_s": following.modified_ttc, "max_drac_m_s2": deceleration.drac, "max_mdrac_m_s2": deceleration.mdrac,
    "max_dst_m_s2": deceleration.safety_time_deceleration, "max_drac_of_follower_m_s2": deceleration.drac,
    "min_time_headway_s": following.headways, "short_headway_share": following.short_share,
    "time_exposed_ttc_s": following.time_exposed, "time_integrated_ttc_s2": following.time_integrated,
    "min_rss_longitudinal_margin_m": rss.longitudinal_distance, "min_rss_lateral_margin_m": rss.lateral_distance,
    "driving_score": driving_score,
}  # fmt: skip
"""By key: what computes a measure and says how."""

SCENARIOS = ("on_ramp_merge", "multi_lane_road", "right_before_left", "roundabout", "city_grid")
"""A straight road, lane changes, junctions, bends, a city."""

COMPARED = {"TTCSpan": "ttc_along_s", "DRACSpan": "drac_m_s2", "MDRACSpan": "mdrac_m_s2"}
"""SUMO's element of each measure, and our column."""

FOLLOWING = (2.0, 3.0)
"""SUMO's types of encounters in which one follows the other on a lane: the ego, the other."""

REACH_M, LONGEST_S = 80.0, 60.0
"""How far SUMO's device looks; a longer time to collision is none to speak of."""

EXACT, LAST_DIGIT = 1e-5, 1e-6
"""A relative difference below this is none, nor is one in the last digit that SUMO writes."""


class Equality(NamedTuple):
    """How far one measure agrees: differences relative to SUMO's, of `n` values that both have; `alone` has SUMO alone."""

    scenario: str
    measure: str
    differences: NDArray[np.float64]
    alone: int

    @property
    def row(self) -> str:
        """A row of the table."""
        found = np.sort(self.differences)
        exact = f"{100.0 * float(np.mean(found < EXACT)):.0f} %"
        within = f"{100.0 * float(np.mean(found < 0.01)):.0f} %"
        return f"| {self.scenario} | {self.measure} | {len(found)} | {exact} | {within} | {self.alone} |"


def main() -> None:
    """Write or compare the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if a table is out of date")
    parser.add_argument("--page", type=Path, default=PAGE, metavar="FILE", help="default docs/measures.md")
    asked = parser.parse_args()
    text = asked.page.read_text(encoding="utf-8")
    fresh = replaced(replaced(text, "measures", measures_table()), "equality", equality_table())
    stale = [name for name in ("measures", "equality") if not is_alike(sample_in(text, name), sample_in(fresh, name))]
    if stale and not asked.check:
        asked.page.write_text(fresh, encoding="utf-8")
    print(f"{'out of date' if asked.check else 'written'}: {', '.join(stale)}" if stale else "up to date")
    raise SystemExit(int(asked.check and bool(stale)))


def measures_table() -> str:
    """Return a row a measure: key, unit, what of the trip it tells, and the equation with its source."""
    rows = []
    for key, maker in EQUATIONS.items():
        first = (inspect.getdoc(maker) or "").partition("\n\n")[0].replace("\n", " ").replace("|", "\\|")
        metric = METRICS[key]
        rows.append(f"| `{key}` | {metric.unit} | {metric.label}: {metric.meaning} | {first.removeprefix('Return ')} |")
    return "\n".join(("| key | unit | of a trip | equation and source |", "|---|---|---|---|", *rows))


def equality_table() -> str:
    """Return a row a scenario and measure, and the smallest post-encroachment times beside each other."""
    rows, times = [], []
    for name in SCENARIOS:
        with tempfile.TemporaryDirectory() as folder:
            log, ours, columns = _driven(name, Path(folder) / "ssm.xml")
        rows += [one.row for one in _equalities(name, log, columns)]
        theirs = [float(found.get("value", "")) for found in log.iter("PET") if found.get("value") not in (None, "NA")]
        times.append(f"| {name} | {_told(min(theirs, default=None))} | {_told(ours)} |")
    head = ("| scenario | measure | values | equal | within 1 % | SUMO alone |", "|---|---|---|---|---|---|")
    beside = ("| scenario | SUMO's smallest PET (s) | ours (s) |", "|---|---|---|")
    return "\n".join((*head, *rows, "", *beside, *times))


def _told(value: float | None) -> str:
    return "none" if value is None else f"{value:.1f}"


def _driven(name: str, file: Path) -> tuple[ElementTree.Element, float | None, Mapping[str, NDArray[Any]]]:
    """Return what SUMO's device has logged of a scenario's ego, our smallest PET (s), and our columns."""
    scenario = load_scenario(ROOT / "scenarios" / f"{name}.toml")
    options = {
        "explicit": scenario.ego, "measures": "TTC DRAC PET MDRAC", "thresholds": "1000 -1 1000 -1", "trajectories": "true",
        "range": f"{REACH_M:g}", "file": str(file),
    }  # fmt: skip
    words = [word for option, value in options.items() for word in (f"--device.ssm.{option}", str(value))]
    log, neighbourhood = PairLog(), Neighbourhood()

    def see(scene: Scene) -> None:
        log.see(neighbourhood.look(scene))

    result = run_sumo_driver(replace(scenario, sumo_options=(*words, "--precision", "6")), observer=see)
    columns = encounter_columns(log, result.length_m, result.width_m)
    return ElementTree.parse(file).getroot(), result.figures["min_post_encroachment_s"], columns


def _equalities(name: str, log: ElementTree.Element, columns: Mapping[str, NDArray[Any]]) -> Iterator[Equality]:
    """Yield how each measure agrees; SUMO's time is the begin of a step, ours its end."""
    step = float(np.min(np.diff(np.unique(columns["time_s"]))))
    follows = np.isfinite(columns["ttc_along_s"])
    begins = np.round(columns["time_s"] - step, 3)
    places = {(float(begins[k]), columns["user_id"][k]): int(k) for k in np.flatnonzero(follows)}
    for element, column in COMPARED.items():
        differences, alone = [], 0
        for time, foe, value in _logged(log, element):
            k = places.get((time, foe))
            if k is None:
                alone += 1
            else:
                differences.append(max(abs(float(columns[column][k]) - value) - LAST_DIGIT, 0.0) / value)
        yield Equality(name, element.removesuffix("Span"), np.array(differences), alone)


def _logged(log: ElementTree.Element, element: str) -> Iterator[tuple[float, str, float]]:
    """Yield time (s), the other and SUMO's value wherever one follows the other and comes nearer."""
    for conflict in log.iter("conflict"):
        spans = [_values(conflict, name) for name in ("timeSpan", "typeSpan", "TTCSpan", element)]
        for time, kind, ttc, value in zip(*spans, strict=True):
            if kind in FOLLOWING and ttc < LONGEST_S and value > 0.0:
                yield round(time, 3), conflict.get("foe", ""), value


def _values(conflict: ElementTree.Element, name: str) -> list[float]:
    words = conflict.find(name).get("values", "").split()  # type: ignore[union-attr]
    return [float("nan") if word == "NA" else float(word) for word in words]


if __name__ == "__main__":
    main()
