"""Small SUMO worlds, built once per test run with netconvert, and one libsumo simulation per test."""

import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import libsumo
import pytest
import sumo

NETCONVERT = Path(sumo.SUMO_HOME) / "bin" / "netconvert"
EGO_TYPE = '<vType id="ego" length="4.5" width="1.8" sigma="0" speedDev="0"/>'
OTHER_TYPE = '<vType id="other" length="4.5" width="1.8"/>'
CRAWLING_TYPE = '<vType id="crawling" length="4.5" width="1.8" maxSpeed="0.1"/>'

CROSS_NODES = """<nodes>
  <node id="w" x="-200" y="0"/> <node id="e" x="200" y="0"/> <node id="n" x="0" y="200"/> <node id="s" x="0" y="-200"/>
  <node id="c" x="0" y="0" type="{kind}"/>
</nodes>"""
CROSS_EDGES = "<edges>{}</edges>".format(
    "".join(
        f'<edge id="{a}{b}" from="{a}" to="{b}" numLanes="{lanes}" priority="{10 * lanes}" speed="13.9"/>'
        for arm, lanes in (("w", 2), ("e", 2), ("n", 1), ("s", 1))
        for a, b in ((arm, "c"), ("c", arm))
    )
)
LOOP_NODES = """<nodes>
  <node id="w" x="-100" y="0"/> <node id="e" x="100" y="0"/> <node id="ne" x="100" y="100"/> <node id="n" x="0" y="100"/>
  <node id="s" x="0" y="-100"/> <node id="c" x="0" y="0" type="priority"/>
</nodes>"""
LOOP_EDGES = "<edges>{}</edges>".format(
    "".join(
        f'<edge id="{a}_{b}" from="{a}" to="{b}" numLanes="1" speed="13.9"/>'
        for a, b in (("w", "c"), ("c", "e"), ("e", "ne"), ("ne", "n"), ("n", "c"), ("c", "s"))
    )
)
DETOUR_NODES = """<nodes>
  <node id="a" x="0" y="0"/> <node id="b" x="200" y="0"/> <node id="u" x="400" y="150"/> <node id="l" x="400" y="-100"/>
  <node id="z" x="600" y="0"/> <node id="q" x="800" y="0"/>
</nodes>"""
DETOUR_EDGES = "<edges>{}</edges>".format(
    "".join(f'<edge id="{a}{b}" from="{a}" to="{b}" speed="13.9"/>' for a, b in ("ab", "bu", "bl", "uz", "lz", "zq"))
)


def build_net(folder: Path, nodes: str, edges: str, *options: str) -> Path:
    """Run netconvert on plain XML text; the net's offset puts its south-west corner at (0, 0)."""
    (folder / "net.nod.xml").write_text(nodes)
    (folder / "net.edg.xml").write_text(edges)
    net = folder / "net.net.xml"
    command = [NETCONVERT, "-n", folder / "net.nod.xml", "-e", folder / "net.edg.xml", "-o", net, "--no-turnarounds"]
    subprocess.run([*map(str, command), *options], check=True, capture_output=True)
    return net


@pytest.fixture(scope="session")
def priority_cross(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A two-lane priority road west-east (y = 195.2 and 198.4 eastbound) crossed by a one-lane minor road at x = 200."""
    return build_net(tmp_path_factory.mktemp("priority"), CROSS_NODES.format(kind="priority"), CROSS_EDGES)


@pytest.fixture(scope="session")
def light_cross(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same crossing under traffic lights, with sidewalks and pedestrian crossings."""
    options = ("--sidewalks.guess", "--crossings.guess", "--sidewalks.guess.max-speed", "20", "--walkingareas")
    return build_net(tmp_path_factory.mktemp("light"), CROSS_NODES.format(kind="traffic_light"), CROSS_EDGES, *options)


@pytest.fixture(scope="session")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A one-way loop on which the route w_c c_e e_ne ne_n n_c c_s crosses its own path in junction c."""
    return build_net(tmp_path_factory.mktemp("loop"), LOOP_NODES, LOOP_EDGES)


@pytest.fixture(scope="session")
def detour(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two ways from b to z: the lower one is the shorter."""
    return build_net(tmp_path_factory.mktemp("detour"), DETOUR_NODES, DETOUR_EDGES)


@pytest.fixture
def simulate(tmp_path: Path) -> Iterator[Callable[..., None]]:
    """Start libsumo on a net and the body of a route file; the simulation closes when the test ends or starts another."""

    def start(net: Path, routes: str, *options: str, step: float = 0.1, seed: int = 1, collision: str = "warn") -> None:
        libsumo.close()
        route_file = tmp_path / "test.rou.xml"
        route_file.write_text(f"<routes>{EGO_TYPE}{OTHER_TYPE}{CRAWLING_TYPE}{routes}</routes>")
        files = ["-n", str(net), "-r", str(route_file)]
        run = ["--step-length", str(step), "--seed", str(seed), "--random", "false"]
        collisions = ["--collision.action", collision, "--collision.check-junctions", "--collision.mingap-factor", "0"]
        libsumo.start(["sumo", *files, *run, *collisions, "--no-step-log", "--no-warnings", *options])

    yield start
    libsumo.close()
