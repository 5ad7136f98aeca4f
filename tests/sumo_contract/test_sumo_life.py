"""The ego's life under control: stops, waiting, rerouting, arrival."""

import xml.etree.ElementTree as ElementTree

import libsumo
import pytest
from contract_driving import depart, place, take_over


def test_move_to_xy_ego_never_arrives_by_itself(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce", extra='arrivalPos="50"'))
    take_over()
    for x in range(210, 399):
        place(float(x), 198.4, 10.0)
    assert "ego" in libsumo.vehicle.getIDList()


def test_remove_as_arrived_writes_tripinfo(simulate, priority_cross, tmp_path):
    tripinfo = tmp_path / "tripinfo.xml"
    simulate(priority_cross, depart("wc ce", position=100, extra='arrivalPos="50"'), "--tripinfo-output", str(tripinfo))
    take_over()
    for x in range(101, 259):
        place(float(x), 198.4, 10.0)
    libsumo.vehicle.remove("ego", libsumo.constants.REMOVE_ARRIVED)
    assert libsumo.simulation.getArrivedIDList() == ("ego",)
    libsumo.simulationStep()
    assert libsumo.simulation.getArrivedIDList() == ()
    libsumo.close()
    trip = ElementTree.parse(tripinfo).getroot().find("tripinfo")
    assert trip is not None
    assert trip.get("vaporized") == ""
    assert float(trip.get("duration")) == pytest.approx(15.9, abs=0.15)
    assert float(trip.get("routeLength")) == pytest.approx(157.2, abs=0.1)


def test_stops_are_readable_with_place_and_duration_and_can_all_be_removed(simulate, priority_cross):
    stops = '<stop lane="wc_1" startPos="100" endPos="110" duration="20"/><stop lane="ce_1" endPos="150" until="90"/>'
    simulate(priority_cross, depart("wc ce").replace("</vehicle>", f"{stops}</vehicle>"))
    take_over()
    first, second = libsumo.vehicle.getStops("ego")
    assert (first.lane, first.startPos, first.endPos, first.duration) == ("wc_1", 100.0, 110.0, 20.0)
    assert (second.lane, second.endPos, second.until) == ("ce_1", 150.0, 90.0)
    while libsumo.vehicle.getStops("ego"):
        libsumo.vehicle.replaceStop("ego", 0, "")
    place(105.0, 198.4, 5.0)
    assert not libsumo.vehicle.isStopped("ego")
    assert libsumo.vehicle.getRoute("ego") == ("wc", "ce")


def waiting_ego_teleports(pulse: bool) -> bool:
    """Whether SUMO teleports an ego that stands for 60 s; the pulse is one step at 0.2 m/s before the time is over."""
    take_over()
    for _ in range(600):
        nearly_over = libsumo.vehicle.getWaitingTime("ego") > 19.0
        place(100.0, 198.4, 0.2 if pulse and nearly_over else 0.0)
        if "ego" in libsumo.simulation.getStartingTeleportIDList():
            return True
    return False


@pytest.mark.parametrize("pulse", [False, True])
def test_a_one_step_speed_pulse_keeps_a_waiting_ego_from_being_teleported(simulate, priority_cross, pulse):
    simulate(priority_cross, depart("wc ce"), "--time-to-teleport", "20")
    assert waiting_ego_teleports(pulse) is not pulse


def test_time_to_teleport_is_readable_and_not_switchable_by_parameters(simulate, priority_cross):
    simulate(priority_cross, depart("wc ce"), "--time-to-teleport", "20")
    take_over()
    assert float(libsumo.simulation.getOption("time-to-teleport")) == 20.0
    libsumo.vehicle.setParameter("ego", "timeToTeleport", "-1")
    libsumo.vehicletype.setParameter("ego", "timeToTeleport", "-1")
    assert waiting_ego_teleports(pulse=False)


@pytest.mark.parametrize("period, rerouted", [("10", True), ("0", False)])
def test_a_rerouting_period_of_zero_stops_the_device_from_changing_the_route(simulate, detour, period, rerouted):
    device = [f"--device.rerouting.{key}={value}" for key, value in (("probability", 1), ("period", 10))]
    fresh_weights = ["--device.rerouting.adaptation-weight=0", "--device.rerouting.adaptation-interval=1"]
    simulate(detour, depart("ab bl lz zq", lane=0, speed=0), *device, *fresh_weights, step=0.5)
    take_over()
    libsumo.vehicle.setParameter("ego", "device.rerouting.period", period)
    libsumo.edge.setMaxSpeed("bl", 1.0)
    x, y = libsumo.vehicle.getPosition("ego")
    for _ in range(60):
        place(x, y, 0.0)
    assert (libsumo.vehicle.getRoute("ego") != ("ab", "bl", "lz", "zq")) is rerouted


def test_a_saved_state_tells_the_arrival_position(simulate, priority_cross, tmp_path):
    simulate(priority_cross, depart("wc ce", extra='arrivalPos="-20" arrivalLane="1"'))
    take_over()
    libsumo.simulation.saveState(str(tmp_path / "state.xml"))
    vehicle = ElementTree.parse(tmp_path / "state.xml").getroot().find("vehicle[@id='ego']")
    assert vehicle is not None
    assert float(vehicle.get("arrivalPos")) == -20.0
    assert vehicle.get("arrivalLane") == "1"
