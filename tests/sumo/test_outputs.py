"""What SUMO's output files say, element by element."""

import pytest

from sumo_reactive.errors import SimulationError
from sumo_reactive.sumo.outputs import (
    NOWHERE,
    Contact,
    TripInfo,
    read_contacts,
    read_teleports,
    read_trips,
    silenced,
    trip_of,
)

TRIPS = """<tripinfos>
  <tripinfo id="a" depart="1.50" departDelay="0.50" arrival="61.50" duration="60.00" routeLength="500.25" waitingTime="7.00"
    waitingCount="2" stopTime="3.00" timeLoss="11.20" vaporized="">
    <emissions CO2_abs="123.5" fuel_abs="40.25" NOx_abs="0.75" CO_abs="9"/></tripinfo>
  <personinfo id="p" depart="0"/>
  <tripinfo id="b" depart="0.00" arrival="-1.00" duration="90.00" routeLength="700.00" vaporized="end"/>
  <tripinfo id="c" depart="-1.00" departDelay="30.00" arrival="-1"/>
</tripinfos>"""


@pytest.fixture
def trips(tmp_path):
    path = tmp_path / "t.xml"
    path.write_text(TRIPS, encoding="utf-8")
    return path


def test_a_trip_is_read_with_every_figure(trips):
    first = TripInfo("a", 1.5, 0.5, 61.5, 60.0, 500.25, 7.0, 2, 11.2, False, 123.5, 40.25, 0.75)
    assert next(read_trips(trips)) == first


def test_who_is_still_on_the_road_has_not_arrived_and_who_is_not_has_not_departed(trips):
    _, there, waiting = read_trips(trips)
    assert there == TripInfo("b", 0.0, 0.0, None, 90.0, 700.0, 0.0, 0, 0.0, True)
    assert waiting == TripInfo("c", None, 30.0, None, 0.0, 0.0, 0.0, 0, 0.0)


def test_one_trip_is_found_by_its_vehicle(trips):
    found = trip_of(trips, "b")
    assert found is not None and found.length_m == 700.0
    assert trip_of(trips, "nobody") is None


def test_collisions_are_read_in_order(tmp_path):
    path = tmp_path / "c.xml"
    path.write_text(
        '<collisions><collision time="3.10" collider="a" victim="b"/><other/><collision time="4" collider="c" victim="a"/>'
        "</collisions>",
        encoding="utf-8",
    )
    assert list(read_contacts(path)) == [Contact(3.1, "a", "b"), Contact(4.0, "c", "a")]


def test_teleports_are_counted(tmp_path):
    path = tmp_path / "s.xml"
    path.write_text('<statistics><vehicles total="9"/><teleports total="3" jam="1"/></statistics>', encoding="utf-8")
    assert read_teleports(path) == 3


@pytest.mark.parametrize(("content", "said"), [(None, "No such file"), ("<tripinfos><tripinfo", "unclosed token")])
def test_a_file_that_cannot_be_read_is_told_with_its_name(tmp_path, content, said):
    path = tmp_path / "t.xml"
    if content is not None:
        path.write_text(content, encoding="utf-8")
    with pytest.raises(SimulationError, match=said) as told:
        list(read_trips(path))
    assert str(told.value).startswith(f"{path}: SUMO's output cannot be read: ")


def test_every_output_file_but_a_saved_state_goes_to_nowhere():
    options = {"tripinfo-output": "a.xml", "summary-output": "b.xml", "save-state.files": "c", "seed": "3"}
    assert silenced(options) == {"tripinfo-output": NOWHERE, "summary-output": NOWHERE}
