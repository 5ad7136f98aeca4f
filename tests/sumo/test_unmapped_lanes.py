"""Ways that SUMO does not look at for a moved vehicle."""

from net_recipes import converted

from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.routes import unmapped_lanes

NODES = (
    '<nodes><node id="a" x="0" y="0"/><node id="b" x="100" y="0"/>'
    '<node id="c" x="200" y="30"/><node id="d" x="200" y="-30"/></nodes>'
)
EDGES = (
    '<edges><edge id="ab" from="a" to="b" numLanes="2"/><edge id="bc" from="b" to="c" numLanes="2"/>'
    '<edge id="bd" from="b" to="d" numLanes="2"/></edges>'
)
WAYS = [(0, "bc", 0), (0, "bd", 0), (1, "bc", 1), (1, "bd", 1)]


def test_where_two_lanes_fork_to_both_sides_one_way_of_each_pair_is_overlooked(tmp_path):
    links = "".join(f'<connection from="ab" to="{to}" fromLane="{a}" toLane="{b}"/>' for a, to, b in WAYS)
    rules = tmp_path / "fork.con.xml"
    rules.write_text(f"<connections>{links}</connections>")
    graph = read_net(converted(tmp_path, NODES, EDGES, "-x", str(rules))).build(("ab", "bc"))
    to_c = {part for lane in ("ab_0", "ab_1") for c in graph.ways_from(lane) if c.to_lane[:2] == "bc" for part in c.parts}
    assert len(unmapped_lanes(graph, ("ab", "bc"))) == 1
    assert unmapped_lanes(graph, ("ab", "bc")) < to_c


def test_on_edges_that_one_way_joins_or_none_nothing_is_overlooked(tmp_path):
    graph = read_net(converted(tmp_path, NODES, EDGES)).build(("ab", "bc"))
    joined = [c for lane in graph.edge_lanes["ab"] for c in graph.ways_from(lane.id) if c.to_lane.startswith("bc")]
    assert joined
    for edges in (("bc", "bd"), ("ab", "nowhere"), ("ab",)):
        assert unmapped_lanes(graph, edges) == frozenset()
