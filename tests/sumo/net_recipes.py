"""Networks for the tests: one written by hand, others made by netconvert from nodes and edges."""

import subprocess
from pathlib import Path

from sumolib import checkBinary

MINIMAL = """<net version="1.20">
  <edge id=":j_0" function="internal">
    <lane id=":j_0_0" index="0" speed="13.9" length="8.00" shape="96.00,-1.60 104.00,-1.60"/>
  </edge>
  <edge id=":j_1" function="internal">
    <lane id=":j_1_0" index="0" speed="9.0" length="5.00" width="3.0" shape="96.00,-1.60 101.00,-1.60"/>
  </edge>
  <edge id=":j_3" function="internal">
    <lane id=":j_3_0" index="0" speed="7.0" length="6.00" shape="101.00,-1.60 101.00,4.00"/>
  </edge>
  <edge id=":j_2" function="internal">
    <lane id=":j_2_0" index="0" speed="13.9" length="0.10" shape="101.00,4.00 101.00,4.00"/>
  </edge>
  <edge id="w" from="a" to="j">
    <lane id="w_0" index="0" disallow="tram rail" speed="13.9" length="50.00" shape="0.00,-1.60 96.00,-1.60"/>
  </edge>
  <edge id="e" from="j" to="b">
    <lane id="e_0" index="0" allow="passenger bus" speed="13.9" length="96.00" changeLeft="bus" shape="104,-1.6 200,-1.6"/>
  </edge>
  <edge id="n" from="j" to="c"><lane id="n_0" index="0" speed="8" length="96" shape="101.00,4.00 101.00,100.00"/></edge>
  <edge id="s" from="d" to="j"><lane id="s_0" index="0" speed="8" length="96" shape="101,-96 101,-3"/></edge>
  <junction id="j" type="priority" x="100" y="0" incLanes="w_0 s_0" intLanes=":j_0_0 :j_3_0 :j_2_0">
    <request index="0" response="000" foes="100" cont="0"/>
    <request index="1" response="100" foes="100" cont="1"/>
    <request index="2" response="001" foes="011" cont="0"/>
  </junction>
  <junction id="b" type="dead_end" x="200" y="0" incLanes="e_0" intLanes="" shape="200,0 200,-3.2"/>
  <junction id="c" type="dead_end" x="100" y="100" incLanes="n_0" intLanes="" shape="100,100 103,100"/>
  <connection from="w" to="e" fromLane="0" toLane="0" via=":j_0_0" dir="s" state="M"/>
  <connection from="w" to="n" fromLane="0" toLane="0" via=":j_1_0" dir="l" state="m" keepClear="0"/>
  <connection from="s" to="n" fromLane="0" toLane="0" via=":j_2_0" dir="s" state="m" tl="lamp" linkIndex="3"/>
  <connection from=":j_0" to="e" fromLane="0" toLane="0" dir="s" state="M"/>
  <connection from=":j_1" to="n" fromLane="0" toLane="0" via=":j_3_0" dir="l" state="m"/>
  <connection from=":j_3" to="n" fromLane="0" toLane="0" dir="l" state="M"/>
  <connection from=":j_2" to="n" fromLane="0" toLane="0" dir="s" state="M"/>
</net>
"""

CROSS_NODES = """<nodes>
  <node id="w" x="-150" y="0"/> <node id="e" x="150" y="0"/> <node id="n" x="0" y="150"/> <node id="s" x="0" y="-150"/>
  <node id="c" x="0" y="0" type="{kind}"/>
</nodes>"""


def cross_edges(lanes: int = 1) -> str:
    """Return the edges wc, cw, ec, ce of a main road and nc, cn, sc, cs of a side road."""
    edges = [
        f'<edge id="{a}{b}" from="{a}" to="{b}" numLanes="{lanes}" priority="{priority}" speed="13.9"/>'
        for arm, priority in (("w", 9), ("e", 9), ("n", 1), ("s", 1))
        for a, b in ((arm, "c"), ("c", arm))
    ]
    return f"<edges>{''.join(edges)}</edges>"


def converted(folder: Path, nodes: str, edges: str, *options: str) -> Path:
    """Return the network that netconvert makes of the nodes and edges."""
    (folder / "n.nod.xml").write_text(nodes)
    (folder / "n.edg.xml").write_text(edges)
    net = folder / "n.net.xml"
    inputs = ["-n", str(folder / "n.nod.xml"), "-e", str(folder / "n.edg.xml"), "-o", str(net)]
    command = [checkBinary("netconvert"), *inputs, "--offset.disable-normalization", *options]
    subprocess.run(command, check=True, capture_output=True)
    return net
