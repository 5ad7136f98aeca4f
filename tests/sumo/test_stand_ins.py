"""Ghosts in a real simulation: they appear at once, whatever the ego's vehicle type says."""

import subprocess
import sys
from contextlib import contextmanager

import libsumo
import pytest
from net_recipes import converted
from simulations import running, simulated, vehicle

from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.outputs import read_trips
from sumo_reactive.sumo.stand_ins import OccupiedLane, StandIns, is_stand_in

NODES = '<nodes><node id="a" x="0" y="0"/><node id="b" x="500" y="0"/></nodes>'
EDGES = '<edges><edge id="ab" from="a" to="b" numLanes="2" speed="13.9"/></edges>'
ROUTES = """<routes><vType id="scattered" speedFactor="normc(1,0.1,0.2,2)"/>
<vehicle id="ego" type="scattered" depart="0" departPos="50"><route edges="ab"/></vehicle></routes>"""

SHOW = """
import sys, libsumo
from sumo_reactive.sumo.stand_ins import OccupiedLane, StandIns
from sumo_reactive.sumo.net_reader import read_net
libsumo.start(["sumo", "-n", sys.argv[1], "-r", sys.argv[2], "--no-step-log"])
libsumo.simulationStep()
ghosts = StandIns("ego")
lane = read_net(__import__("pathlib").Path(sys.argv[1])).lane("ab_1")
for _ in range(2):
    ghosts.show(OccupiedLane(lane, 60.0, -4.8, 20.0, ("ab",)))
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


@contextmanager
def haunted(folder, *options, others="", label=""):
    """Run a simulation with an ego on lane ab_0 and its ghosts; yield these and the lane beside."""
    net = converted(folder, NODES, EDGES)
    content = '<vType id="plain" speedDev="0" sigma="0"/>' + vehicle("ego", "ab", type="plain", departPos=50, departLane=0)
    with running(net, folder, content + others, *options, step=1.0):
        simulated()
        yield StandIns("ego", label), read_net(net).lane("ab_1")


def present() -> dict[str, str]:
    """The lane of each ghost on the road."""
    vehicle = libsumo.vehicle
    return {name: vehicle.getLaneID(name) for name in vehicle.getIDList() if is_stand_in(name)}


def test_a_ghost_is_beside_the_ego_as_fast_as_it_and_in_the_middle_of_the_lane(tmp_path):
    with haunted(tmp_path) as (ghosts, lane):
        for x in (60.0, 65.0):
            ghosts.show(OccupiedLane(lane, x, -4.0, 5.0, ("ab",)))
            simulated()
            (name,) = present()
            assert libsumo.vehicle.getPosition(name) == pytest.approx((x, lane.spine.at(x)[1]))
            assert (libsumo.vehicle.getSpeed(name), libsumo.vehicle.getAngle(name)) == pytest.approx((5.0, 90.0))
            assert libsumo.vehicle.getLength(name) == libsumo.vehicle.getLength("ego")
        assert (present(), ghosts.made) == ({"reactive.ghost.ego.1": "ab_1"}, 1)


def test_a_ghost_that_is_not_needed_is_gone(tmp_path):
    with haunted(tmp_path) as (ghosts, lane):
        ghosts.show(OccupiedLane(lane, 60.0, -4.0, 5.0, ("ab",)))
        simulated()
        assert len(present()) == 1
        ghosts.show(None)
        simulated()
        assert present() == {}
        ghosts.hide()
        simulated()
        ghosts.show(OccupiedLane(lane, 80.0, -4.0, 5.0, ("ab",)))
        simulated()
        assert (list(present()), ghosts.made) == (["reactive.ghost.ego.2"], 2)


def test_a_ghost_that_sumo_has_taken_off_the_road_is_made_anew(tmp_path):
    with haunted(tmp_path) as (ghosts, lane):
        ghosts.show(OccupiedLane(lane, 60.0, -4.0, 5.0, ("ab",)))
        simulated()
        libsumo.vehicle.remove("reactive.ghost.ego.1")
        simulated()
        for x in (65.0, 70.0):
            ghosts.show(OccupiedLane(lane, x, -4.0, 5.0, ("ab",)))
            simulated()
        assert list(present()) == ["reactive.ghost.ego.2"]
        libsumo.vehicle.remove("reactive.ghost.ego.2")
        simulated()
        ghosts.hide()
        assert present() == {}


def shows(folder, other_at: float, speed: float, **how: bool) -> bool:
    """Whether a ghost with its front at 60 m appears, somebody being on its lane at `other_at` m and so fast."""
    other = vehicle("other", "ab", departPos=other_at, departLane=1, departSpeed=speed, type="plain")
    with haunted(folder, others=other) as (ghosts, lane):
        at = libsumo.vehicle.getLanePosition("other") - (other_at - 60.0)
        ghosts.show(OccupiedLane(lane, at, -4.0, 5.0, ("ab",), **how))
        return ghosts.made == 1


@pytest.mark.parametrize(
    ("other_at", "waits", "appears"), [(60, True, False), (60, False, True), (63.9, True, False), (70, True, True)]
)
def test_one_that_waits_does_not_appear_where_somebody_is(tmp_path, other_at, waits, appears):
    """The ghost's front would be at 60 m, its rear at 55 m; the other is 5 m long."""
    assert shows(tmp_path, other_at, 0, waits=waits) is appears


@pytest.mark.parametrize(
    ("other_at", "is_early", "appears"), [(20, True, True), (49, True, False), (49, False, True), (75, True, True)]
)
def test_an_early_one_does_not_appear_before_somebody_who_would_brake_hard(tmp_path, other_at, is_early, appears):
    """The ghost would drive at 5 m/s with its rear at 55 m; the other, at 10 m/s, is behind it or ahead."""
    assert shows(tmp_path, other_at, 10, waits=True, is_early=is_early) is appears


def test_two_ghosts_of_one_ego_are_told_apart_by_their_label(tmp_path):
    with haunted(tmp_path, label=".turning") as (ghosts, lane):
        ghosts.show(OccupiedLane(lane, 60.0, -4.0, 5.0, ("ab",)))
        simulated()
        assert list(present()) == ["reactive.ghost.ego.turning.1"]


def test_a_ghost_is_in_no_output(tmp_path):
    trips = tmp_path / "trips.xml"
    with haunted(tmp_path, "--tripinfo-output", str(trips), "--tripinfo-output.write-unfinished", "true") as (ghosts, lane):
        ghosts.show(OccupiedLane(lane, 60.0, -4.0, 5.0, ("ab",)))
        simulated()
        ghosts.hide()
        simulated()
    assert [trip.vehicle_id for trip in read_trips(trips)] == ["ego"]


def test_a_ghost_comes_to_the_next_road_as_a_new_one(tmp_path):
    nodes = NODES.replace("</nodes>", '<node id="c" x="900" y="0"/></nodes>')
    edges = EDGES.replace("</edges>", '<edge id="bc" from="b" to="c" numLanes="2" speed="13.9"/></edges>')
    net = converted(tmp_path, nodes, edges)
    with running(net, tmp_path, vehicle("ego", "ab bc", departPos=50), step=1.0):
        simulated()
        ghosts, network = StandIns("ego"), read_net(net)
        for name, x, way in (("ab_1", 490.0, ("ab",)), ("bc_1", 510.0, ("bc",))):
            ghosts.show(OccupiedLane(network.lane(name), x, -1.6, 5.0, way))
            simulated()
        assert present() == {"reactive.ghost.ego.2": "bc_1"}
