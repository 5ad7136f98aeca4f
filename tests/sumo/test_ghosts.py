"""Ghosts in a real simulation: they appear at once, whatever the ego's vehicle type says."""

import subprocess
import sys

from net_recipes import converted

NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="500" y="0"/></nodes>'
EDGES = '<edges><edge id="ab" from="a" to="b" numLanes="2" speed="13.9"/></edges>'
ROUTES = """<routes><vType id="scattered" speedFactor="normc(1,0.1,0.2,2)"/>
<vehicle id="ego" type="scattered" depart="0" departPos="50"><route edges="ab"/></vehicle></routes>"""

SHOW = """
import sys, libsumo
from sumo_reactive.sumo.ghosts import Ghosts
from sumo_reactive.sumo.net_reader import read_net
libsumo.start(["sumo", "-n", sys.argv[1], "-r", sys.argv[2], "--no-step-log"])
libsumo.simulationStep()
ghosts = Ghosts("ego")
lane = read_net(__import__("pathlib").Path(sys.argv[1])).lane("ab_1")
for _ in range(2):
    ghosts.show(lane, 60.0, -4.8, 20.0, ("ab",))
    libsumo.simulationStep()
print(len([name for name in libsumo.vehicle.getIDList() if name.startswith("reactive.ghost")]))
"""


def test_a_ghost_of_a_car_whose_speed_factor_is_drawn_at_random_appears(tmp_path):
    """In a process of its own: SUMO would never return from the call if it had to draw a factor out of its bounds."""
    routes = tmp_path / "ego.rou.xml"
    routes.write_text(ROUTES)
    command = [sys.executable, "-c", SHOW, str(converted(tmp_path, NODES, EDGES)), str(routes)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=60)
    assert done.stdout.split()[-1] == "1"
