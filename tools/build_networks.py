#!/usr/bin/env python3
"""Build every network under `networks/` from its plain-XML sources with netconvert.

    python tools/build_networks.py [NAME…] [--check]

`networks/<name>/<name>.net.xml` comes from the `.nod.xml`, `.edg.xml`, `.con.xml`, `.tll.xml` and `.typ.xml` beside it.
The sources of `city_grid` are regular, so they are written from the few parameters below and not kept; its traffic is kept.
`--check` builds into a temporary folder and compares. Exit codes: 0 done or up to date, 1 out of date, 2 cannot build.
"""

from __future__ import annotations

import argparse
import gzip
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path

from sumolib import checkBinary

ROOT = Path(__file__).resolve().parent.parent
NETWORKS = ROOT / "networks"

SOURCE_OPTIONS = {
    ".nod.xml": "--node-files",
    ".edg.xml": "--edge-files",
    ".con.xml": "--connection-files",
    ".tll.xml": "--tllogic-files",
    ".typ.xml": "--type-files",
}
NETCONVERT_OPTIONS = (
    "--junctions.corner-detail", "5",
    "--junctions.limit-turn-speed", "5.5",
    "--no-turnarounds", "true",
    "--offset.disable-normalization", "true",
    "--xml-validation", "never",
)  # fmt: skip
GENERATED_COMMENT = re.compile(r"<!-- generated on .*?-->\s*", re.DOTALL)  # holds the date and absolute paths
OWN_COMMENT = "<!-- built by tools/build_networks.py: do not edit -->\n\n"

# --- city_grid: a regular city, so described by a few numbers --------------------------------------------------------
CITY = "city_grid"
CITY_SIZE = 6
CITY_BLOCK_M = 150.0
CITY_ARTERIALS = (1, 4)
"""Rows and columns with two lanes and priority."""
CITY_LIT_CROSSINGS = (1, 2, 3, 4)
"""An arterial has lights where it meets one of these rows or columns."""
CITY_FLOW_STEPS = (5, 12, 17)
"""A flow runs from each entry to the exits this many arms further round the city."""
CITY_ARTERIAL_PERIOD_S = 20.0
CITY_MINOR_PERIOD_S = 60.0
"""Time between the cars of one flow that starts on an arterial, and on a minor street."""
CITY_EGO_ROUTE = "left2A2 A2B2 B2B1 B1C1 C1D1 D1D2 D2D3 D3E3 E3E4"
CITY_EGO_DEPART_S = 25.0


class BuildError(Exception):
    """A network that cannot be built; the text is one line."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Build or check the named networks, by default all; return the exit code."""
    parser = argparse.ArgumentParser(description="Build networks/<name>/<name>.net.xml from the plain sources.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="networks to build (default: all)")
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if a built file is out of date")
    options = parser.parse_args(arguments)
    try:
        names = chosen_names(options.names)
        netconvert = find_netconvert()
        stale = [name for name in names if not settle(name, netconvert, options.check)]
    except BuildError as error:
        print(f"build_networks: {error}", file=sys.stderr)
        return 2
    if stale:
        print(f"out of date: {' '.join(stale)}; run: python tools/build_networks.py {' '.join(stale)}", file=sys.stderr)
    return 1 if stale else 0


def find_netconvert() -> str:
    """Path of netconvert, where SUMO's own tools look for it: $SUMO_HOME, the package eclipse-sumo, $PATH."""
    found = shutil.which(checkBinary("netconvert"))
    if found is None:
        raise BuildError("netconvert not found; install eclipse-sumo")
    return found


def chosen_names(names: Sequence[str]) -> list[str]:
    """The names asked for, all of them if none is."""
    known = sorted({folder.name for folder in NETWORKS.iterdir() if folder.is_dir()})
    unknown = [name for name in names if name not in known]
    if unknown:
        raise BuildError(f"no network {', '.join(unknown)} in networks/; there are {', '.join(known)}")
    return list(names) or known


def settle(name: str, netconvert: str, check: bool) -> bool:
    """Build one network; with `check` only compare it. Returns whether the files kept are (now) up to date."""
    with tempfile.TemporaryDirectory() as scratch:
        built = build(name, netconvert, Path(scratch))
    kept = {path: read_text(NETWORKS / name / path) for path in built}
    changed = [path for path in built if built[path] != kept[path]]
    if not check:
        for path in changed:
            write_text(NETWORKS / name / path, built[path])
    verdict = ("out of date" if check else "built") if changed else "up to date"
    print(f"{name:<24} {verdict}{': ' if changed else ''}{', '.join(changed)}", flush=True)
    return not (check and changed)


def build(name: str, netconvert: str, scratch: Path) -> dict[str, str]:
    """Text of each built file by its file name; `scratch` is an empty folder to work in."""
    if name == CITY:
        write_city_sources(scratch)
        net = converted(name, scratch, netconvert, scratch)
        return {f"{CITY}.net.xml.gz": net, f"{CITY}.rou.xml": city_traffic()}
    return {f"{name}.net.xml": converted(name, NETWORKS / name, netconvert, scratch)}


def converted(name: str, sources: Path, netconvert: str, scratch: Path) -> str:
    """Run netconvert on `sources`; the network's text, without date and paths."""
    command = [netconvert, *NETCONVERT_OPTIONS, "--output-file", str(scratch / "built.net.xml")]
    for suffix, option in SOURCE_OPTIONS.items():
        path = sources / f"{name}{suffix}"
        if path.exists():
            command += [option, str(path)]
        elif suffix in (".nod.xml", ".edg.xml"):
            raise BuildError(f"networks/{name}/{path.name} is missing")
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    for line in run.stderr.splitlines():
        print(f"{name:<24} {line}", file=sys.stderr)
    if run.returncode != 0:
        raise BuildError(f"{name}: netconvert failed with exit code {run.returncode}")
    return GENERATED_COMMENT.sub(OWN_COMMENT, (scratch / "built.net.xml").read_text(encoding="utf-8"), count=1)


def read_text(path: Path) -> str | None:
    """Text of a plain or gzipped file, None if there is none."""
    if not path.exists():
        return None
    content = path.read_bytes()
    return (gzip.decompress(content) if path.suffix == ".gz" else content).decode("utf-8")


def write_text(path: Path, text: str) -> None:
    """Write a plain or gzipped file whole or not at all; equal text gives equal bytes."""
    content = text.encode("utf-8")
    part = path.with_name(path.name + ".part")
    part.write_bytes(gzip.compress(content, mtime=0) if path.suffix == ".gz" else content)
    part.replace(path)


def write_city_sources(folder: Path) -> None:
    """Nodes, edges and types of the city, named like netgenerate's: columns A, B, …, rows 0, 1, …."""
    (folder / f"{CITY}.nod.xml").write_text(document("nodes", city_nodes()), encoding="utf-8")
    (folder / f"{CITY}.edg.xml").write_text(document("edges", city_edges()), encoding="utf-8")
    (folder / f"{CITY}.typ.xml").write_text(document("types", city_types()), encoding="utf-8")


def document(root: str, lines: Iterator[str]) -> str:
    """An XML document with one element per line."""
    body = "".join(f"    {line}\n" for line in lines)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{OWN_COMMENT}<{root}>\n{body}</{root}>\n'


def city_types() -> Iterator[str]:
    """The two kinds of street."""
    yield '<type id="arterial" numLanes="2" speed="13.89" priority="5"/>'
    yield '<type id="minor" numLanes="1" speed="11.11" priority="2"/>'


def city_nodes() -> Iterator[str]:
    """Crossings of the grid, and the outer ends of its arms."""
    for column, row in product(range(CITY_SIZE), repeat=2):
        x, y = (column + 1) * CITY_BLOCK_M, (row + 1) * CITY_BLOCK_M
        yield f'<node id="{crossing(column, row)}" x="{x:.0f}" y="{y:.0f}" type="{city_junction_type(column, row)}"/>'
    far = (CITY_SIZE + 1) * CITY_BLOCK_M
    for line in range(CITY_SIZE):
        along = (line + 1) * CITY_BLOCK_M
        places = {"bottom": (along, 0.0), "right": (far, along), "top": (along, far), "left": (0.0, along)}
        for side, (x, y) in places.items():
            yield f'<node id="{side}{line}" x="{x:.0f}" y="{y:.0f}" type="dead_end"/>'


def city_junction_type(column: int, row: int) -> str:
    """Lights or priority on arterials; among minor streets all-way stops and right before left in turn."""
    on_arterial = (column in CITY_ARTERIALS, row in CITY_ARTERIALS)
    if not any(on_arterial):
        return "right_before_left" if (column + row) % 2 == 0 else "allway_stop"
    lit = column in CITY_LIT_CROSSINGS and row in CITY_LIT_CROSSINGS
    return "traffic_light" if all(on_arterial) or lit else "priority"


def crossing(column: int, row: int) -> str:
    """Id of a crossing, e.g. C4."""
    return f"{chr(ord('A') + column)}{row}"


def city_edges() -> Iterator[str]:
    """Both directions of every block and arm."""
    last = CITY_SIZE - 1
    for line in range(CITY_SIZE):
        kind = "arterial" if line in CITY_ARTERIALS else "minor"
        horizontal = [f"left{line}", *(crossing(column, line) for column in range(CITY_SIZE)), f"right{line}"]
        vertical = [f"bottom{line}", *(crossing(line, row) for row in range(CITY_SIZE)), f"top{line}"]
        for street, position in product((horizontal, vertical), range(last + 2)):
            start, end = street[position], street[position + 1]
            yield f'<edge id="{start}{end}" from="{start}" to="{end}" type="{kind}"/>'
            yield f'<edge id="{end}{start}" from="{end}" to="{start}" type="{kind}"/>'


def city_arms() -> list[tuple[str, str, int]]:
    """Outer end, its crossing and its line number, counter-clockwise from the lower left."""
    last, lines = CITY_SIZE - 1, range(CITY_SIZE)
    return [
        *((f"bottom{line}", crossing(line, 0), line) for line in lines),
        *((f"right{line}", crossing(last, line), line) for line in lines),
        *((f"top{line}", crossing(line, last), line) for line in reversed(lines)),
        *((f"left{line}", crossing(0, line), line) for line in reversed(lines)),
    ]


def city_traffic() -> str:
    """Flows between the arms, and the ego."""
    return document("routes", city_traffic_lines())


def city_traffic_lines() -> Iterator[str]:
    """The car, then flows and ego by their first departure, the order SUMO demands."""
    yield (
        '<vType id="car" length="4.7" width="1.8" accel="2.6" decel="4.5" emergencyDecel="8.0" sigma="0.3" '
        'speedFactor="normc(1,0.08,0.85,1.15)"/>'
    )
    departures = [*city_flows(), (CITY_EGO_DEPART_S, city_ego())]
    for _, lines in sorted(departures):
        yield from lines


def city_ego() -> list[str]:
    """The ego's departure and route."""
    return [
        f'<vehicle id="ego" type="car" depart="{CITY_EGO_DEPART_S:.0f}" departLane="best" departSpeed="desired" '
        'speedFactor="1">',
        f'    <route edges="{CITY_EGO_ROUTE}"/>',
        "</vehicle>",
    ]


def city_flows() -> Iterator[tuple[float, list[str]]]:
    """First departure (s) and element of every flow; the flows of one arm start one after the other."""
    arms = city_arms()
    for (number, (outer, inner, line)), (order, step) in product(enumerate(arms), enumerate(CITY_FLOW_STEPS)):
        goal, last, _ = arms[(number + step) % len(arms)]
        period = CITY_ARTERIAL_PERIOD_S if line in CITY_ARTERIALS else CITY_MINOR_PERIOD_S
        begin = order * period / len(CITY_FLOW_STEPS)
        element = (
            f'<flow id="{outer}-{goal}" type="car" from="{outer}{inner}" to="{last}{goal}" begin="{begin:.1f}" end="3600" '
            f'period="{period:.0f}" departLane="best" departSpeed="desired"/>'
        )
        yield begin, [element]


if __name__ == "__main__":
    sys.exit(main())
