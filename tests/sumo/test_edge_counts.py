"""What SUMO is asked to count on edges, and what its files say of that."""

from pathlib import Path
from xml.etree.ElementTree import parse as parsed

import libsumo
import pytest

from sumo_reactive.errors import SimulationError
from sumo_reactive.sumo.config import option_words, read_config
from sumo_reactive.sumo.edge_counts import (
    EdgeCounts,
    EdgeTime,
    edges_for_cars,
    read_edge_times,
    read_passages,
    vehicle_types,
)
from sumo_reactive.sumo.launch import sumo_arguments
from sumo_reactive.sumo.net_file import parse
from sumo_reactive.sumo.outputs import AS_READ
from sumo_reactive.sumo.session import Session

NETWORKS = Path(__file__).parents[2] / "networks"
CONFIG = NETWORKS / "four_way_priority" / "four_way_priority.sumocfg"


def config_beside(folder, routes, more=""):
    """A configuration with routes of its own on a network of this repository."""
    (folder / "r.rou.xml").write_text(f"<routes>{routes}</routes>", encoding="utf-8")
    net = NETWORKS / "four_way_priority" / "four_way_priority.net.xml"
    config = folder / "a.sumocfg"
    config.write_text(
        f'<configuration><net-file value="{net}"/><route-files value="r.rou.xml"/>{more}</configuration>', encoding="utf-8"
    )
    return read_config(config)


def test_roads_are_the_normal_edges_by_class_with_the_lanes_that_cars_may_use():
    roads = edges_for_cars(parse(read_config(CONFIG).net_file))
    assert set(roads) == {f"{way}_{side}" for way in ("from", "to") for side in ("north", "east", "south", "west")}
    assert all(length > 10.0 for road in roads.values() for length in road.lanes.values())


def test_a_road_without_a_type_is_of_the_class_of_its_priority_and_a_pavement_is_no_lane(tmp_path):
    net = tmp_path / "n.net.xml"
    net.write_text(
        '<net><edge id="a" from="1" to="2" priority="3"><lane id="a_0" length="50" allow="pedestrian"/>'
        '<lane id="a_1" length="50" disallow="bicycle"/></edge><edge id="b" from="2" to="1" type="path">'
        '<lane id="b_0" length="50" allow="bicycle pedestrian"/></edge></net>',
        encoding="utf-8",
    )
    (road,) = edges_for_cars(parse(net)).values()
    assert (road.edge_id, road.road_class, dict(road.lanes)) == ("a", "priority 3", {"a_1": 50.0})


def test_types_are_found_in_every_file_that_sumo_reads(tmp_path):
    (tmp_path / "more.xml").write_text("<additional><vType accel='1' id='b'/></additional>", encoding="utf-8")
    (tmp_path / "in.xml").write_text('<routes><vType id="c&amp;d"/></routes>', encoding="utf-8")
    routes = '<vTypeDistribution id="all"><vType id="a"/></vTypeDistribution><include href="in.xml"/>'
    config = config_beside(tmp_path, routes, '<additional-files value="more.xml"/>')
    found = vehicle_types(config)
    assert "DEFAULT_VEHTYPE" in found and {"a", "b", "c&d"} <= set(found)


def test_the_additional_file_stands_behind_those_of_the_scenario(tmp_path):
    (tmp_path / "more.xml").write_text("<additional/>", encoding="utf-8")
    config = config_beside(tmp_path, '<vType id="a&amp;b"/>', '<additional-files value="more.xml"/>')
    counts = EdgeCounts(tmp_path, 30.0, {"from_west_0": 80.0})
    theirs, ours = counts.options(config, ())["additional-files"].split(",")
    assert Path(theirs) == tmp_path / "more.xml"
    edges, loop = parsed(ours).getroot()
    assert (edges.tag, edges.get("period"), edges.get("file")) == ("edgeData", "30.000", str(counts.times))
    assert (loop.get("lane"), loop.get("pos"), loop.get("file")) == ("from_west_0", "40.00", str(counts.passages))
    assert all("a&b" in one.get("vTypes").split() for one in (edges, loop))


def test_additional_files_of_the_command_line_stand_in_place_of_the_configurations(tmp_path):
    (tmp_path / "more.xml").write_text("<additional/>", encoding="utf-8")
    config = config_beside(tmp_path, "", '<additional-files value="more.xml"/>')
    named = EdgeCounts(tmp_path, 30.0, {}).options(config, ("--additional-files", "other.xml"))["additional-files"]
    assert named.split(",")[0] == "other.xml" and "more.xml" not in named


def test_times_on_edges_are_read_interval_by_interval(tmp_path):
    path = tmp_path / "e.xml"
    path.write_text(
        '<meandata><interval begin="0.00" end="60.00"><edge id="a" sampledSeconds="12.50" speed="4.00"/><edge id="b"/>'
        '</interval><interval begin="60.00" end="90.00"/></meandata>',
        encoding="utf-8",
    )
    assert list(read_edge_times(path)) == [EdgeTime(0.0, 60.0, "a", 12.5, 4.0), EdgeTime(0.0, 60.0, "b", 0.0, 0.0)]


def test_passages_are_summed_over_the_intervals(tmp_path):
    path = tmp_path / "l.xml"
    path.write_text(
        "<detector>" + "".join(
            f'<interval begin="{k}" end="{k + 1}" id="reactive.cut.a_0" nVehContrib="{k}"/>' for k in (1, 2)
        ) + "</detector>",
        encoding="utf-8",
    )
    assert read_passages(path) == {"a_0": 3}


def test_a_file_that_is_not_there_is_told():
    with pytest.raises(SimulationError, match=r"nowhere\.xml: SUMO's output cannot be read"):
        read_passages(Path("nowhere.xml"))


def counted(folder, more):
    """What SUMO counts of one car on its way through a junction, and of what `more` makes of it."""
    config = config_beside(folder, '<vType id="car"/><trip id="a" type="car" depart="0" from="from_west" to="to_east"/>')
    counts = EdgeCounts(folder, 20.0, edges_for_cars(parse(config.net_file))["from_west"].lanes)
    arguments, _ = sumo_arguments(
        config, config.path, seed=1, step_length_s=0.1,
        sumo_options=option_words({**AS_READ, **counts.options(config, ())}),
    )  # fmt: skip
    with Session(arguments) as session:
        session.step()
        more()
        while session.time < 60.0:
            session.step()
    return list(read_edge_times(counts.times)), read_passages(counts.passages)


def test_a_vehicle_counts_also_when_its_type_has_been_changed_and_a_type_made_on_the_way_does_not(tmp_path):
    def as_stand_ins_are_made():
        libsumo.vehicletype.copy("car", "reactive.ghost.type.a")
        libsumo.route.add("way", ["from_south", "to_north"])
        libsumo.vehicle.add("reactive.ghost.a", "way", "reactive.ghost.type.a")

    alone = counted(tmp_path, lambda: None)
    assert alone[1] == {"from_west_0": 1} and {one.edge_id for one in alone[0]} == {"from_west", "to_east"}
    assert counted(tmp_path, lambda: libsumo.vehicle.setActionStepLength("a", 0.1)) == alone
    assert counted(tmp_path, as_stand_ins_are_made) == alone
