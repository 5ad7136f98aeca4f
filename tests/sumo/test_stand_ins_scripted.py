"""What SUMO is told of a stand-in, to the word; SUMO's answers are scripted."""

from pathlib import Path

import libsumo
import pytest
from net_recipes import MINIMAL
from scripted import Domain, script

from sumo_reactive.sumo.net_reader import read_net
from sumo_reactive.sumo.stand_ins import OccupiedLane, StandIns
from sumo_reactive.sumo.vehicle_type import KEEP_ROUTE_EXACT

NAME, TYPE = "reactive.ghost.ego.x.1", "reactive.ghost.type.ego.x"


@pytest.fixture
def net(tmp_path: Path):
    """The written network: w_0 from x = 0 to 96 at y = −1.6, whose 96 m SUMO counts as 50, e_0, and n_0 to the north."""
    (tmp_path / "some.net.xml").write_text(MINIMAL)
    return read_net(tmp_path / "some.net.xml")


def scripted(monkeypatch, there=(), **vehicle):
    """Script SUMO; `there`: front and length of who is on the lane, by id."""
    others = dict(there)
    script(
        monkeypatch,
        vehicle=Domain(
            getMinGap=2.5,
            getLength=lambda name: {one: size for one, (_, size) in others.items()}.get(name, 5.0),
            getLanePosition=lambda name: others[name][0], getTypeID={"ego": "car"}, **vehicle,
        ),
        vehicletype=Domain(), route=Domain(), lane=Domain(getLastStepVehicleIDs={"w_0": tuple(others)}),
    )  # fmt: skip
    return libsumo.vehicle.told


def test_a_stand_in_departs_at_once_where_it_is_to_be_driven_by_nobody(monkeypatch, net):
    told = scripted(monkeypatch)
    stand_ins = StandIns("ego", ".x")
    stand_ins.show(OccupiedLane(net.lane("w_0"), 48.0123, 3.0, 5.125, ("w", "e")))
    departure = {"depart": "now", "departLane": "0", "departPos": "25.01", "departSpeed": "5.12"}
    assert told == [
        ("add", NAME, NAME, TYPE, departure),
        ("setSpeedMode", NAME, 32),
        ("setLaneChangeMode", NAME, 0),
        ("setSpeed", NAME, 5.125),
        ("moveToXY", NAME, "", -1, pytest.approx(48.0123), pytest.approx(-1.6), pytest.approx(90.0), KEEP_ROUTE_EXACT),
    ]
    assert libsumo.route.told == [("add", NAME, ("w", "e"))]
    assert stand_ins.made == 1


def test_its_type_is_the_egos_without_limits_and_without_devices_that_tell_of_it(monkeypatch, net):
    scripted(monkeypatch)
    stand_ins = StandIns("ego", ".x")
    for _ in range(2):
        stand_ins.show(OccupiedLane(net.lane("w_0"), 48.0, 3.0, 5.0, ("w",)))
        stand_ins.hide()
    silent = [f"has.{name}.device" for name in ("tripinfo", "fcd", "vehroute", "ssm", "emissions", "battery")]
    assert libsumo.vehicletype.told == [
        ("copy", "car", TYPE),
        ("setMaxSpeed", TYPE, 100.0),
        ("setSpeedDeviation", TYPE, 0.0),
        ("setSpeedFactor", TYPE, 2.0),
        *(("setParameter", TYPE, name, "false") for name in silent),
    ]


def test_inside_a_junction_it_departs_on_the_road_before_and_is_moved_there(monkeypatch, net):
    told = scripted(monkeypatch)
    StandIns("ego", ".x").show(OccupiedLane(net.lane(":j_0_0"), 99.0, -1.0, 5.0, ("w", "e")))
    assert told[0][-1] == {"depart": "now", "departLane": "best", "departPos": "0.0", "departSpeed": "5.0"}
    assert told[-1][4:6] == pytest.approx((99.0, -1.6))


def orders(told):
    """The kinds of orders since, which are forgotten."""
    found = [order[0] for order in told]
    told.clear()
    return found


def test_it_is_moved_on_its_roads_and_through_junctions_and_made_anew_elsewhere(monkeypatch, net):
    told = scripted(monkeypatch)
    stand_ins, kinds = StandIns("ego"), []
    for name, x, y, edges in (
        ("w_0", 50.0, -1.6, ("w", "e")), (":j_0_0", 99.0, -1.6, ()), ("e_0", 120.0, -1.6, ()), ("n_0", 101.0, 50.0, ("n",)),
        ("n_0", 101.0, 51.0, ()),
    ):  # fmt: skip
        stand_ins.show(OccupiedLane(net.lane(name), x, y, 5.0, edges))
        kinds.append((stand_ins.made, *orders(told)))
    on, new = ("setSpeed", "moveToXY"), ("add", "setSpeedMode", "setLaneChangeMode", "setSpeed", "moveToXY")
    assert kinds == [(1, *new), (1, *on), (1, *on), (2, "remove", *new), (2, *on)]


def test_it_is_removed_once_as_one_that_has_vanished(monkeypatch, net):
    told = scripted(monkeypatch)
    stand_ins = StandIns("ego")
    stand_ins.hide()
    assert told == []
    stand_ins.show(OccupiedLane(net.lane("w_0"), 50.0, -1.6, 5.0, ("w",)))
    told.clear()
    stand_ins.hide()
    stand_ins.hide()
    assert told == [("remove", "reactive.ghost.ego.1", 3)]


@pytest.mark.parametrize("order", ["setSpeed", "moveToXY", "add"])
def test_one_that_sumo_does_not_take_is_given_up_until_the_next_step(monkeypatch, net, order):
    scripted(monkeypatch, **{order: libsumo.TraCIException("not known")})
    stand_ins = StandIns("ego")
    for made in (1, 2):
        stand_ins.show(OccupiedLane(net.lane("w_0"), 50.0, -1.6, 5.0, ("w",)))
        assert stand_ins.made == made
    libsumo.vehicle.told.clear()
    stand_ins.hide()
    assert libsumo.vehicle.told == []


@pytest.mark.parametrize(
    ("front", "length", "is_taken"),
    [(20.1, 4.0, True), (19.9, 4.0, False), (20.0, 4.0, False), (28.9, 4.0, True), (29.1, 4.0, False), (29.0, 4.0, False),
     (30.9, 6.0, True), (31.1, 6.0, False)],
)  # fmt: skip
@pytest.mark.parametrize("far", [(), (("far", (45.0, 4.0)),)])
def test_one_that_waits_appears_where_its_body_of_5_m_touches_nobodys(monkeypatch, net, front, length, is_taken, far):
    """On w_0, whose 96 m SUMO counts as 50: its front is at 48 m, which are 25."""
    scripted(monkeypatch, (*far, ("other", (front, length))))
    stand_ins = StandIns("ego")
    stand_ins.show(OccupiedLane(net.lane("w_0"), 48.0, -1.6, 5.0, ("w",), waits=True))
    assert stand_ins.made == (0 if is_taken else 1)
    stand_ins.show(OccupiedLane(net.lane("w_0"), 48.0, -1.6, 5.0, ("w",)))
    assert stand_ins.made == 1
    libsumo.vehicle.told.clear()
    # there is one: it stays, whoever else is there
    stand_ins.show(OccupiedLane(net.lane("w_0"), 49.0, -1.6, 5.0, ("w",), waits=True))
    assert orders(libsumo.vehicle.told) == ["setSpeed", "moveToXY"]


def test_past_the_end_of_its_lane_it_stays_on_it(monkeypatch, net):
    """SUMO has what is put on the end itself in the junction, and crashes when it is moved from there."""
    told = scripted(monkeypatch)
    StandIns("ego", ".x").show(OccupiedLane(net.lane("w_0"), 97.0, -1.6, 5.0, ("w", "e")))
    assert told[-1][4] == pytest.approx(95.99)
