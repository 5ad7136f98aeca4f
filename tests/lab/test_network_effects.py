"""What SUMO's outputs tell of the others: who counts, and which sums."""

from __future__ import annotations

from pathlib import Path

import pytest

from sumo_reactive.errors import SimulationError
from sumo_reactive.lab.comparison.network_effects import Outputs, effects_of, means_over_both, network_figures
from sumo_reactive.sumo.config import read_config
from sumo_reactive.sumo.outputs import read_trips

ROOT = Path(__file__).resolve().parents[2]
CONFIG = ROOT / "networks" / "four_way_priority" / "four_way_priority.sumocfg"
TELEPORTS = 3


def trip(name: str, depart: float, arrival: float, vaporized: str = "", loss: float = 1.0, duration: float = 20.0) -> str:
    """A vehicle of 1 km, two stops of together 3 s, 200 g of CO₂."""
    return (
        f'<tripinfo id="{name}" depart="{depart}" departDelay="0.50" arrival="{arrival}" duration="{duration}" '
        f'routeLength="1000.00" waitingTime="3.00" waitingCount="2" timeLoss="{loss}" vaporized="{vaporized}">'
        '<emissions CO2_abs="200000.0" fuel_abs="60000.0" NOx_abs="100.0"/></tripinfo>'
    )


def written(folder: Path, *trips: str, contacts: str = "") -> Outputs:
    """Files as SUMO writes them."""
    outputs = Outputs(folder)
    outputs.trips.write_text(f"<tripinfos>{''.join(trips)}</tripinfos>", encoding="utf-8")
    outputs.contacts.write_text(f"<collisions>{contacts}</collisions>", encoding="utf-8")
    outputs.totals.write_text(f'<statistics><teleports total="{TELEPORTS}"/></statistics>', encoding="utf-8")
    return outputs


EGO = trip("ego", 100.0, 130.0, loss=50.0)


def test_the_ego_its_ghosts_and_whoever_had_arrived_before_are_left_out(tmp_path):
    ghost = trip("reactive.ghost.ego.1", 110.0, 112.0)
    others = trip("before", 10.0, 99.9), trip("beside", 90.0, 120.0), trip("later", 110.0, 150.0)
    outputs = written(tmp_path, EGO, ghost, *others)
    effects = effects_of(outputs, "ego", 0)
    assert effects.figures["others_vehicles"] == effects.figures["others_arrived"] == 2
    assert effects.figures["others_time_loss_s"] == 2.0
    assert effects.figures["others_stops"] == 4
    assert set(effects.arrivals) == {"beside", "later"}


def test_emissions_come_in_kg_and_g_and_by_the_way_driven(tmp_path):
    figures = effects_of(written(tmp_path, EGO, trip("a", 101.0, 150.0), trip("b", 101.0, 150.0)), "ego", 0).figures
    assert (figures["others_co2_kg"], figures["others_fuel_kg"], figures["others_nox_g"]) == (0.4, 0.12, 0.2)
    assert (figures["others_distance_km"], figures["others_co2_g_per_km"]) == (2.0, 200.0)


def test_who_is_under_way_at_the_end_counts_with_what_it_has_done_but_has_not_arrived(tmp_path):
    outputs = written(tmp_path, EGO, trip("under way", 110.0, -1.0, "end"), trip("gone", 110.0, 140.0, "teleport"))
    effects = effects_of(outputs, "ego", 0)
    assert (effects.figures["others_vehicles"], effects.figures["others_arrived"]) == (2, 0)
    assert effects.figures["others_time_loss_s"] == 2.0


def test_who_could_not_depart_counts_with_its_delay_alone(tmp_path):
    figures = effects_of(written(tmp_path, EGO, trip("kept out", -1.0, -1.0, "end")), "ego", 0).figures
    assert (figures["others_insertion_delay_s"], figures["others_vehicles"]) == (0.5, 0)
    assert figures["others_distance_km"] == 0.0 and "others_co2_g_per_km" not in figures


def test_collisions_and_teleports_of_the_ego_and_before_its_departure_are_left_out(tmp_path):
    contacts = "".join(
        f'<collision time="{time}" collider="{one}" victim="{other}"/>'
        for time, one, other in (
            (99.0, "a", "b"), (101.0, "a", "b"), (102.0, "a", "ego"), (103.0, "ego", "b"),
            (104.0, "a", "reactive.ghost.ego.1"),
        )
    )  # fmt: skip
    figures = effects_of(written(tmp_path, EGO, contacts=contacts), "ego", 1).figures
    assert (figures["others_collisions"], figures["others_teleports"]) == (1, TELEPORTS - 1)


def test_means_are_over_those_who_arrived_in_both_runs(tmp_path):
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
    one = effects_of(written(tmp_path / "one", EGO, trip("a", 101.0, 150.0), trip("b", 101.0, 140.0)), "ego", 0)
    other = effects_of(written(tmp_path / "other", EGO, trip("a", 101.0, 160.0, duration=30.0)), "ego", 0)
    theirs, ours = means_over_both(one, other)
    assert (theirs["others_mean_duration_s"], ours["others_mean_duration_s"]) == (20.0, 30.0)
    assert theirs["others_mean_waiting_s"] == 3.0


def test_a_trip_is_read_whatever_other_trips_state_and_whatever_its_id_holds(tmp_path):
    first = '<tripinfo id="a&amp;&quot;b" depart="1.00"/>'
    trips = list(read_trips(written(tmp_path, first, trip("ego", 100.0, 130.0, "end")).trips))
    assert (trips[0].vehicle_id, trips[0].departure, trips[0].arrival, trips[0].carbon_dioxide_mg) == ('a&"b', 1.0, 0.0, 0.0)
    assert (trips[1].vaporized, trips[1].length_m, trips[1].stops) == (True, 1000.0, 2)
    assert (trips[1].carbon_dioxide_mg, trips[1].fuel_mg, trips[1].nitrogen_oxides_mg) == (200000.0, 60000.0, 100.0)


def test_an_output_without_the_ego_or_cut_short_is_an_error_that_names_the_file(tmp_path):
    with pytest.raises(SimulationError, match=r"trips\.xml: SUMO tells no trip of ego 'ego'"):
        effects_of(written(tmp_path, trip("a", 1.0, 2.0)), "ego", 0)
    (tmp_path / "trips.xml").write_text("<tripinfos><tripinfo", encoding="utf-8")
    with pytest.raises(SimulationError, match=r"trips\.xml: SUMO's output cannot be read"):
        list(read_trips(tmp_path / "trips.xml"))


def test_outputs_that_the_scenario_names_go_nowhere(tmp_path):
    config = tmp_path / "a.sumocfg"
    text = CONFIG.read_text(encoding="utf-8").replace("four_way_priority.", f"{CONFIG.parent}/four_way_priority.")
    config.write_text(text.replace("</configuration>", '<summary value="s.xml"/></configuration>'), encoding="utf-8")
    options = Outputs(tmp_path).options(read_config(config))
    assert options["summary-output"] == "NUL"
    assert options["tripinfo-output"] == str(tmp_path / "trips.xml")


def test_a_contact_with_a_stand_in_is_none_of_the_network(tmp_path):
    told = "".join(
        f'<collision time="105.00" type="frontback" lane="a_0" pos="1.00" collider="{one}" victim="{other}"/>'
        for one, other in (("a", "b"), ("ego", "reactive.ghost.ego.1"), ("reactive.ghost.ego.1", "a"))
    )
    assert network_figures(written(tmp_path, EGO, contacts=told), 600.0)["network_collisions"] == 1
