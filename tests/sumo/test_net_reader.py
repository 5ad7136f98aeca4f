"""Reading a network written by hand: every value is plain in the text."""

import gzip
import math

import numpy as np
import pytest
from net_recipes import MINIMAL

from sumo_reactive.driver.view.attention import lanes_around
from sumo_reactive.driver.world.junction import Control, LightLink, Turn
from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_reader import NetFile, read_net

STRAIGHT, LEFT, SIDE = "w_0->e_0", "w_0->n_0", "s_0->n_0"


@pytest.fixture
def written(tmp_path):
    def write(text: str = MINIMAL) -> NetFile:
        path = tmp_path / "some.net.xml"
        path.write_text(text)
        return read_net(path)

    return write


def test_a_route_builds_its_lanes_and_those_of_the_junctions_at_its_ends(written):
    graph = written().build(["w", "e"])
    assert set(graph.lanes) == {"w_0", "e_0", "n_0", "s_0", ":j_0_0", ":j_1_0", ":j_2_0", ":j_3_0"}
    assert set(graph.junctions) == {"j", "b"}
    assert [connection.id for connection in graph.junctions["j"].connections] == [STRAIGHT, LEFT, SIDE]
    assert [connection.id for connection in graph.ways_from("w_0")] == [STRAIGHT, LEFT]
    assert [connection.id for connection in graph.ways_into("n_0")] == [LEFT, SIDE]
    assert graph.connection_of[":j_3_0"].id == LEFT
    assert not graph.left_hand


def test_a_lane_without_permissions_is_for_all_and_others_for_those_that_they_name(written):
    net = written()
    assert net.lane("n_0").allows("ship")
    assert net.lane("w_0").allows("passenger")
    assert not net.lane("w_0").allows("tram")
    assert net.lane("w_0").allows("ignoring")  # SUMO's class for who heeds no permission
    assert net.lane("e_0").allowed == {"passenger", "bus"}
    assert net.lane("e_0").change_left == {"bus"}
    assert net.lane("e_0").allows_change_right("passenger")


def test_a_lane_may_state_a_length_that_differs_from_its_shape(written):
    lane = written().lane("w_0")
    assert (lane.length, lane.spine.length, lane.scale) == pytest.approx((50.0, 96.0, 1.92))


def test_lanes_are_3_2_m_wide_unless_they_say_otherwise(written):
    net = written()
    assert net.lane("w_0").width == 3.2
    assert net.lane(":j_1_0").width == 3.0


def test_a_lanes_index_is_its_place_whatever_the_file_says(written):
    second = '<lane id="s_1" index="0" speed="13.9" length="96.00" shape="96.8,-100 96.8,-4"/></edge>'
    before, after = MINIMAL.split('<edge id="s"')
    net = written(before + '<edge id="s"' + after.replace("</edge>", second, 1))
    assert (net.lane("s_0").index, net.lane("s_1").index) == (0, 1)


def test_a_turn_that_may_wait_inside_has_two_parts_and_a_waiting_place_between_them(written):
    left = written().build(["w", "n"]).connections[LEFT]
    assert left.parts == (":j_1_0", ":j_3_0")
    assert left.wait_at == pytest.approx(5.0)
    assert left.path.length == pytest.approx(10.6)
    assert (left.width, left.speed_limit, left.approach_limit) == (3.0, 7.0, 13.9)
    assert (left.turn, left.control, left.keep_clear) == (Turn.LEFT, Control.MINOR, False)


def test_a_stated_waiting_place_is_taken_as_stated(written):
    net = written(MINIMAL.replace('keepClear="0"', 'contPos="3.5"'))
    assert net.junction("j").connections[1].wait_at == 3.5


def test_a_connection_with_a_signal_obeys_the_light(written):
    side = written().junction("j").connections[2]
    assert (side.control, side.light) == (Control.LIGHT, LightLink("lamp", 3))


def test_rails_at_a_rail_crossing_have_no_signal(written):
    side = written(MINIMAL.replace('linkIndex="3"', 'linkIndex="-1"')).junction("j").connections[2]
    assert (side.control, side.light) == (Control.MINOR, None)


@pytest.mark.parametrize(
    ("state", "control"),
    [
        ("M", Control.MAJOR),
        ("=", Control.EQUAL),
        ("s", Control.STOP),
        ("w", Control.ALL_WAY_STOP),
        ("Z", Control.ZIPPER),
        ("-", Control.DEAD_END),
        ("O", Control.OFF),
    ],
)
def test_each_state_letter_names_a_control(written, state, control):
    text = MINIMAL.replace('via=":j_0_0" dir="s" state="M"', f'via=":j_0_0" dir="s" state="{state}"')
    assert written(text).junction("j").connections[0].control is control


def test_right_of_way_rows_are_read_from_right_to_left(written):
    table = written().junction("j").right_of_way
    assert table.must_yield(2, 0)
    assert not table.must_yield(0, 2)
    assert table.must_yield(1, 2)
    assert not table.in_conflict(0, 1)
    assert table.in_conflict(0, 2)


def owners(graph):
    """Return the connections that conflict regions are known on."""
    return {region.own_id for region in graph.regions.values()}


def test_only_connections_along_the_route_have_conflict_regions(written):
    net = written()
    assert owners(net.build(["w", "e"])) == {STRAIGHT}
    assert owners(net.build(["w", "n"])) == {LEFT}


def test_approaches_say_how_far_the_stop_line_is(written):
    graph = written().build(["w", "n"])
    (found,) = graph.approaches[SIDE]
    assert (found.lane_id, found.distance, found.edges) == ("s_0", pytest.approx(93.0), ("s", "n"))


def test_a_lane_with_a_slip_in_its_shape_is_refused(written):
    with pytest.raises(NetworkError, match=r"some.net.xml: lane 'w_0': lane w_0 is longer than 1e\+06 m"):
        written(MINIMAL.replace("96.00,-1.60", "96.00,-1.60 1e12,0")).lane("w_0")


def test_a_shape_of_two_equal_points_becomes_a_short_stub(written):
    side = written().junction("j").connections[2]
    assert side.path.length == pytest.approx(0.1)
    assert np.isfinite(side.path.points).all()


def test_a_connection_without_internal_lane_leads_straight_from_lane_to_lane(written):
    straight = written(MINIMAL.replace('via=":j_0_0" ', "")).junction("j").connections[0]
    assert straight.parts == ()
    np.testing.assert_allclose(straight.path.points, [[96, -1.6], [104, -1.6]])


def test_a_connection_without_room_leads_on_in_the_direction_of_its_lane(written):
    text = MINIMAL.replace('via=":j_2_0" ', "").replace('shape="101,-96 101,-3"', 'shape="101,-96 101,4"')
    path = written(text).junction("j").connections[2].path
    assert path.length == pytest.approx(0.1)
    assert path.heading_at(0.0) == pytest.approx(math.pi / 2)


def test_heights_are_kept_and_flat_networks_have_none(written):
    assert written().junction("j").connections[0].heights is None
    raised = MINIMAL.replace('shape="96.00,-1.60 104.00,-1.60"', 'shape="96,-1.6,7 104,-1.6,9"')
    np.testing.assert_allclose(written(raised).junction("j").connections[0].heights, [7, 9])


def test_building_again_reuses_what_was_built(written):
    net = written()
    first, second = net.build(["w", "e"]), net.build(["w", "e"])
    assert first.lanes["w_0"] is second.lanes["w_0"]
    assert [*first.regions.values()] == [*second.regions.values()] != []


def test_a_route_may_pass_the_same_edges_twice(written):
    assert owners(written().build(["w", "e", "w", "e"])) == {STRAIGHT}


def test_a_compressed_network_reads_the_same(tmp_path):
    path = tmp_path / "some.net.xml.gz"
    path.write_bytes(gzip.compress(MINIMAL.encode()))
    assert owners(read_net(path).build(["w", "e"])) == {STRAIGHT}


def test_a_left_hand_network_says_so(written):
    assert written(MINIMAL.replace("<net ", '<net lefthand="true" ')).build(["w"]).left_hand


def test_short_exits_are_followed_as_far_as_long_bodies_reach_back(written):
    """Who has left the junction by a lane of 3 m is on the next one; 96 m behind a junction nobody reaches back."""
    short = MINIMAL.replace('shape="101.00,4.00 101.00,100.00"', 'shape="101.00,4.00 101.00,7.00"')
    more = (
        '<edge id="m" from="c" to="f"><lane id="m_0" index="0" speed="8" length="90" shape="101,8 101,98"/></edge>'
        '<edge id=":c_0" function="internal"><lane id=":c_0_0" index="0" speed="8" length="1" shape="101,7 101,8"/></edge>'
        '<connection from="n" to="m" fromLane="0" toLane="0" via=":c_0_0" dir="s" state="M"/>'
    )
    graph = written(short.replace("</net>", f"{more}</net>")).build(["w", "e"])
    assert graph.beyond == {"n_0": (":c_0_0", "m_0")}
    assert {":c_0_0", "m_0"} < set(graph.lanes)
    assert {":c_0_0", "m_0"} < set(lanes_around(graph, STRAIGHT))
    assert written().build(["w", "e"]).beyond == {}
