"""How SUMO's own vehicles answer to a placed ego."""

import math

import libsumo
import pytest
from contract_driving import (
    KEEP_ROUTE_EXACTLY,
    NO_LANE_CHANGES,
    SPEED_AS_SET,
    another,
    depart,
    drive,
    lane_path,
    overlapping,
    place,
    take_over,
)

MINOR_FLOW = "".join(
    f'<flow id="{a}" type="other" begin="0" end="100" period="exp(0.25)" from="{a}c" to="c{b}" departSpeed="max"/>'
    for a, b in ("ns", "sn")
)
STRAIGHT = ["wc_1", ":c_11_1", "ce_1"]


@pytest.mark.parametrize("seed", range(1, 6))
def test_others_yield_when_the_route_runs_on(simulate, priority_cross, seed):
    simulate(priority_cross, depart("wc ce") + MINOR_FLOW, seed=seed)
    take_over()
    hits: set[str] = set()
    drive(lane_path(STRAIGHT), 20.0, 10.0, until=300.0, after_step=lambda: hits.update(overlapping()))
    assert not hits


def minor_cars_arrived(announce_standing: bool) -> int:
    """Arrivals in 60 s while the ego stands frozen 4 m before the junction on the priority road."""
    take_over()
    arrived = 0
    for _ in range(600):
        if announce_standing:
            libsumo.vehicle.setSpeed("ego", 0.0)
        libsumo.vehicle.moveToXY("ego", "", -1, 188.8, 198.4, 90, KEEP_ROUTE_EXACTLY)
        libsumo.simulationStep()
        arrived += libsumo.simulation.getArrivedNumber()
    return arrived


def test_a_standing_ego_with_speed_zero_lets_the_minor_flow_go(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce", position=188, speed=0) + MINOR_FLOW)
    going = minor_cars_arrived(announce_standing=True)
    simulate(priority_cross, depart("wc ce", position=188, speed=0) + MINOR_FLOW)
    blocked = minor_cars_arrived(announce_standing=False)
    assert going >= 5
    assert blocked == 0


def test_followers_stop_behind_an_ego_inside_a_junction(simulate, priority_cross):
    followers = "".join(another(f"f{k}", 1, 0, speed=10, at=2 + 2 * k) for k in range(3))
    simulate(priority_cross, depart("wc ce", position=180) + followers)
    take_over()
    for _ in range(300):
        for vehicle in libsumo.simulation.getDepartedIDList():
            libsumo.vehicle.setLaneChangeMode(vehicle, NO_LANE_CHANGES)
        place(203.0, 198.4, 0.0)
        assert not overlapping()
    assert all(libsumo.vehicle.getSpeed(v) < 0.1 for v in libsumo.vehicle.getIDList())
    assert libsumo.vehicle.getIDCount() == 4


def test_side_overlap_is_not_reported_by_sumo(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce", lane=0, speed=5) + another("n", 1, 25, speed=5))
    take_over()
    libsumo.vehicle.setLaneChangeMode("n", NO_LANE_CHANGES)
    libsumo.vehicle.setSpeed("n", 5.0)
    overlaps = 0
    for _ in range(100):
        x = libsumo.vehicle.getPosition("n")[0] + 0.5
        place(x, 196.75, 5.0)
        overlaps += bool(overlapping())
        assert libsumo.simulation.getCollisions() == ()
    assert overlaps > 90


@pytest.mark.parametrize("action, reported", [("warn", True), ("teleport", False)])
def test_collision_action_teleport_hides_a_rear_end_hit_by_the_ego(simulate, priority_cross, action, reported):
    simulate(priority_cross, depart("wc ce") + another("leader", 1, 100, kind="crawling"), collision=action)
    take_over()
    collisions = []
    for k in range(20):
        place(90.0 + 0.5 * k, 198.4, 5.0)
        collisions += libsumo.simulation.getCollisions()
    assert bool(collisions) is reported


def follower_gap_behind_a_straddling_ego(ghost: bool) -> float:
    """Smallest bumper gap of a follower on lane 1 while the ego drives half-way between lanes 0 and 1."""
    take_over()
    smallest = math.inf
    for k in range(140):
        x = 62.0 + 0.5 * k
        if ghost:
            if k == 0:
                add_ghost(speed=5.0)
            libsumo.vehicle.setSpeed("ghost", 5.0)
            libsumo.vehicle.moveToXY("ghost", "", -1, x, 198.4, 90, KEEP_ROUTE_EXACTLY)
        place(x, 196.7, 5.0)
        if "follower" in libsumo.vehicle.getIDList():
            smallest = min(smallest, x - 4.5 - libsumo.vehicle.getPosition("follower")[0])
    return smallest


def add_ghost(speed: float) -> None:
    """A vehicle of a copied type without output devices, thrown in at the next step wherever moveToXY puts it."""
    libsumo.vehicletype.copy("ego", "ghost_type")
    for device in ("tripinfo", "fcd", "vehroute", "ssm", "rerouting", "emissions"):
        libsumo.vehicletype.setParameter("ghost_type", f"has.{device}.device", "false")
    libsumo.route.add("ghost_route", ["wc", "ce"])
    libsumo.vehicle.add("ghost", "ghost_route", "ghost_type", depart="now", departLane="1", departSpeed=str(speed))
    libsumo.vehicle.setSpeedMode("ghost", SPEED_AS_SET)
    libsumo.vehicle.setLaneChangeMode("ghost", NO_LANE_CHANGES)


FOLLOWER = another("follower", 1, 0, speed=13, at=2)


@pytest.mark.parametrize("option", [(), ("--lateral-resolution", "0.5")], ids=str)
def test_a_ghost_on_the_neighbour_lane_makes_followers_brake(simulate, priority_cross, option):
    simulate(priority_cross, depart("wc ce", lane=0, speed=5, position=60) + FOLLOWER, *option)
    assert follower_gap_behind_a_straddling_ego(ghost=True) > 1.0
    assert libsumo.simulation.getCollisions() == ()


def test_a_follower_does_not_see_a_body_that_straddles_into_its_lane(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce", lane=0, speed=5, position=60) + FOLLOWER)
    assert follower_gap_behind_a_straddling_ego(ghost=False) < 0.0


def test_a_ghost_is_placed_where_it_is_told_even_on_an_occupied_departure(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce", lane=0, speed=5, position=60) + another("blocker", 1, 2, kind="crawling"))
    take_over()
    add_ghost(speed=5.0)
    libsumo.vehicle.setSpeed("ghost", 5.0)
    libsumo.vehicle.moveToXY("ghost", "", -1, 62.0, 198.4, 90, KEEP_ROUTE_EXACTLY)
    place(62.0, 196.7, 5.0)
    assert libsumo.vehicle.getPosition("ghost") == pytest.approx((62.0, 198.4))
    assert libsumo.vehicle.getSpeed("ghost") == pytest.approx(5.0)
    assert libsumo.vehicle.getLaneID("ghost") == "wc_1"


def test_ghost_leaves_no_tripinfo(simulate, priority_cross, tmp_path):
    outputs = {name: tmp_path / f"{name}.xml" for name in ("tripinfo", "fcd", "vehroute")}
    options = [word for name, path in outputs.items() for word in (f"--{name}-output", str(path))]
    simulate(priority_cross, depart("wc ce", lane=0, speed=5, position=60), *options, "--device.fcd.probability", "1")
    follower_gap_behind_a_straddling_ego(ghost=True)
    libsumo.vehicle.remove("ghost", libsumo.constants.REMOVE_VAPORIZED)
    libsumo.vehicle.remove("ego", libsumo.constants.REMOVE_ARRIVED)
    libsumo.close()
    for path in outputs.values():
        recorded = path.read_text().split("-->")[-1]
        assert 'id="ego"' in recorded
        assert "ghost" not in recorded
