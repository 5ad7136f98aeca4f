"""What a network's elements mean where they leave something out or say something odd; written by hand."""

import numpy as np
import pytest
from net_recipes import MINIMAL

from sumo_reactive.driver.world.junction import Control, LightLink, Turn
from sumo_reactive.driver.world.lane import VEHICLE_CLASSES
from sumo_reactive.errors import NetworkError
from sumo_reactive.sumo.net_file import coordinates, edge_id_of, heights_of, parse, permitted
from sumo_reactive.sumo.net_reader import NetUpstream, read_net

STRAIGHT = 'via=":j_0_0" dir="s" state="M"'
"""The way from w to e."""


@pytest.fixture
def net(tmp_path):
    """Read the written network, with some of its words replaced by others."""

    def written(*changes: tuple[str, str]):
        text = MINIMAL
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "some.net.xml").write_text(text)
        return read_net(tmp_path / "some.net.xml")

    return written


def straight(net, said):
    return net((STRAIGHT, said)).junction("j").connections[0]


@pytest.mark.parametrize(
    ("letter", "turn"),
    [("s", Turn.STRAIGHT), ("l", Turn.LEFT), ("L", Turn.LEFT), ("r", Turn.RIGHT), ("R", Turn.RIGHT), ("t", Turn.AROUND),
     ("T", Turn.AROUND), ("invalid", Turn.STRAIGHT)],
)  # fmt: skip
def test_each_direction_is_a_turn(net, letter, turn):
    assert straight(net, f'via=":j_0_0" dir="{letter}" state="M"').turn is turn


@pytest.mark.parametrize(
    ("said", "light", "control"),
    [
        ('tl="a" linkIndex="0" dir="s" state="o"', LightLink("a", 0), Control.LIGHT),
        ('tl="a" linkIndex="12" state="M"', LightLink("a", 12), Control.LIGHT),
        ('tl="a" state="m"', None, Control.MINOR),
        ('linkIndex="3" state="m"', None, Control.MINOR),
        ('tl="a" linkIndex="-1" state="?"', None, Control.OFF),
    ],
)
def test_a_light_has_a_name_and_an_index(net, said, light, control):
    found = straight(net, f'via=":j_0_0" {said}')
    assert (found.light, found.control, found.turn) == (light, control, Turn.STRAIGHT)


@pytest.mark.parametrize(
    ("text", "is_kept"), [("0", False), ("false", False), ("False", False), ("1", True), ("true", True)]
)
def test_a_junction_is_kept_clear_unless_said_otherwise(net, text, is_kept):
    assert straight(net, f'{STRAIGHT} keepClear="{text}"').keep_clear is is_kept
    assert straight(net, STRAIGHT).keep_clear


@pytest.mark.parametrize(
    ("place", "wait_at"), [("0.5", 0.5), ("0", 5.0), ("-1", 5.0), ("10.5", 10.5), ("10.7", 5.0), ("3.5", 3.5)]
)
def test_a_waiting_place_is_one_inside_the_junction_or_the_end_of_the_first_part(net, place, wait_at):
    """The way from w to n is 10.6 m long, its first part 5 m."""
    left = net(('keepClear="0"', f'contPos="{place}"')).junction("j").connections[1]
    assert left.wait_at == pytest.approx(wait_at)


def test_a_way_of_one_part_has_no_waiting_place_and_the_narrowest_and_slowest_part_counts(net):
    ways = net().junction("j").connections
    assert [way.wait_at for way in ways] == [None, 5.0, None]
    assert [(way.width, way.speed_limit) for way in ways] == [(3.2, 13.9), (3.0, 7.0), (3.2, 13.9)]
    assert [(way.from_lane, way.to_lane, way.junction_id, way.index) for way in ways] == [
        ("w_0", "e_0", "j", 0), ("w_0", "n_0", "j", 1), ("s_0", "n_0", "j", 2),
    ]  # fmt: skip


def test_without_a_way_inside_the_roads_own_width_and_speed_count(net):
    found = net((f"{STRAIGHT}", 'state="M"'), ('<lane id="e_0"', '<lane id="e_0" width="2.5"')).junction("j").connections[0]
    assert (found.width, found.speed_limit, found.parts, found.heights) == (2.5, 13.9, (), None)


def test_parts_that_lead_in_a_circle_are_taken_once(net):
    onward = '<connection from=":j_3" to="n" fromLane="0" toLane="0"'
    assert net((onward, f'{onward} via=":j_1_0"')).junction("j").connections[1].parts == (":j_1_0", ":j_3_0")


def test_the_part_that_leads_on_to_the_same_lane_follows(net):
    """From inside the turn there is also a way elsewhere."""
    onward = '<connection from=":j_1" to="n" fromLane="0" toLane="0" via=":j_3_0"'
    other = '<connection from=":j_1" to="{}" fromLane="0" toLane="{}" via=":j_0_0" dir="l" state="m"/>'
    for to, lane in (("e", 0), ("n", 1)):
        found = net((onward, other.format(to, lane) + onward)).junction("j").connections[1]
        assert found.parts == (":j_1_0", ":j_3_0")


def test_heights_run_on_from_part_to_part_and_one_flat_part_makes_a_flat_way(net):
    first = ('shape="96.00,-1.60 101.00,-1.60"', 'shape="96,-1.6,1 101,-1.6,2"')
    second = ('shape="101.00,-1.60 101.00,4.00"', 'shape="101,-1.6,2 101,1.2,5 101,4,8"')
    np.testing.assert_allclose(net(first, second).junction("j").connections[1].heights, [1, 2, 5, 8])
    assert net(first).junction("j").connections[1].heights is None
    assert net(second).junction("j").connections[1].heights is None


@pytest.mark.parametrize(
    ("shape", "points"),
    [("0,1", [(0.0, 1.0)]), ("0,1 2,3,4", [(0.0, 1.0), (2.0, 3.0, 4.0)]), (" 1e1,-2.5\n3,4 ", [(10.0, -2.5), (3.0, 4.0)])],
)
def test_a_shape_is_its_points(shape, points):
    assert coordinates(shape) == points


@pytest.mark.parametrize("shape", ["", "1", "1,2,3,4", "1,nan", "inf,1", "1,2 3", "1,2 3,4,inf"])
def test_what_is_no_shape_is_told_in_its_beginning(shape):
    with pytest.raises(ValueError, match=r"^shape '.*' is not a list of x,y or x,y,z$") as told:
        coordinates(shape)
    assert f"'{shape[:40]}'" in str(told.value)


def test_of_a_long_shape_the_beginning_is_told():
    with pytest.raises(ValueError, match=rf"^shape '{'1,2 ' * 10}' is not"):
        coordinates("1,2 " * 20 + "3")


@pytest.mark.parametrize(
    ("shape", "heights"),
    [
        ("0,0,1 0,0,2 3,0,4", [1, 4]),
        ("0,0,1 0,0,9", [1, 1]),  # one point becomes a stub
        ("0,0,1 0.000002,0,2", [1, 2]),
        ("0,0,1 3,0", None),
        ("0,0 3,0", None),
    ],
)
def test_heights_are_those_of_the_points_that_differ(shape, heights):
    found = heights_of(shape)
    assert (None if found is None else found.tolist()) == heights


@pytest.mark.parametrize(
    ("allow", "disallow", "wanted"),
    [
        (None, None, VEHICLE_CLASSES),
        (None, "", VEHICLE_CLASSES),
        ("all", "bus", VEHICLE_CLASSES),
        ("bus tram", None, {"bus", "tram"}),
        ("bus,tram unheard", "bus", {"bus", "tram"}),
        ("", None, set()),
        (None, "bus", VEHICLE_CLASSES - {"bus"}),
        (None, "all", set()),
    ],
)
def test_classes_are_named_or_excluded(allow, disallow, wanted):
    assert permitted(allow, disallow) == wanted


def test_a_lane_says_what_it_is_or_what_all_are(net):
    read = net(('disallow="tram rail"', 'allow="" disallow="tram rail" changeRight="taxi"'), ('length="8.00"', 'length="0"'))
    lane = read.lane("w_0")
    assert (lane.id, lane.edge_id, lane.index, lane.length, lane.speed_limit, lane.width) == ("w_0", "w", 0, 50.0, 13.9, 3.2)
    assert lane.allowed == VEHICLE_CLASSES - {"tram", "rail"} and not lane.is_internal
    assert (lane.change_right, lane.change_left) == ({"taxi"}, VEHICLE_CLASSES)
    inside = read.lane(":j_0_0")
    assert inside.is_internal and inside.length == pytest.approx(0.1)
    assert read.lane(":j_0_0") is inside and read.junction("j") is read.junction("j")


@pytest.mark.parametrize("text", ["true", "1", "yes", "on", "True"])
def test_left_hand_traffic_has_many_words(net, text):
    assert net(("<net ", f'<net lefthand="{text}" ')).left_hand
    assert not net(("<net ", '<net lefthand="false" ')).left_hand


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (('id="w" from="a"', 'from="a"'), "an <edge>, <junction> or <connection> lacks attribute 'id'"),
        (('id="w" from="a" to="j"', 'id="w" from="a"'), "an <edge>, <junction> or <connection> lacks attribute 'to'"),
        (
            ('<connection from="w" to="e"', '<connection to="e"'),
            "an <edge>, <junction> or <connection> lacks attribute 'from'",
        ),
        (('<junction id="b"', "<junction"), "an <edge>, <junction> or <connection> lacks attribute 'id'"),
        (('function="internal"', ""), "no internal lanes; rebuild the network without netconvert's --no-internal-links"),
        (("<net ", "<network><net "), "not XML"),
    ],
)
def test_what_a_network_lacks_is_told_whole(net, tmp_path, change, complaint):
    with pytest.raises(NetworkError) as told:
        net(change)
    assert str(told.value).startswith(f"{tmp_path / 'some.net.xml'}: {complaint}")


def test_a_parsed_network_sorts_connections_and_edges_by_where_they_lead(net):
    raw = parse(net(('to="j">', 'to="j" function="connector">')).path)
    assert {lane: [way["to"] for way in ways] for lane, ways in raw.leaving.items()} == {
        "w_0": ["e", "n"], "s_0": ["n"], ":j_0_0": ["e"], ":j_1_0": ["n"], ":j_3_0": ["n"], ":j_2_0": ["n"],
    }  # fmt: skip
    assert {lane: [way["from"] for way in ways] for lane, ways in raw.arriving.items()} == {"e_0": ["w"], "n_0": ["w", "s"]}
    assert raw.joining == {("a", "j"): ["w"], ("j", "b"): ["e"], ("j", "c"): ["n"], ("d", "j"): ["s"]}
    assert [raw.function(edge) for edge in ("w", "e", ":j_0")] == ["connector", "normal", "internal"]
    assert (edge_id_of("a_b_0"), raw.lane_ids("w"), set(raw.junctions)) == ("a_b", ["w_0"], {"j", "b", "c"})


@pytest.mark.parametrize(
    ("response", "yields"),
    [("000", ()), ("001", (0,)), ("110", (1, 2)), ("1", (0,)), ("11000", ()), ("11101", (0, 2))],
)
def test_who_is_yielded_to_stands_from_right_to_left(net, response, yields):
    table = net(('response="001"', f'response="{response}"')).junction("j").right_of_way
    assert tuple(k for k in range(3) if table.must_yield(2, k)) == yields
    assert [tuple(k for k in range(3) if table.must_yield(row, k)) for row in (0, 1)] == [(), (2,)]
    assert [tuple(k for k in range(3) if table.in_conflict(row, k)) for row in range(3)] == [(2,), (2,), (0, 1)]


@pytest.mark.parametrize("index", ["-1", "3"])
def test_a_row_of_no_connection_says_nothing(net, index):
    table = net(('index="2" response="001"', f'index="{index}" response="001"')).junction("j").right_of_way
    assert not any(table.must_yield(2, k) or table.in_conflict(2, k) for k in range(3))


def test_a_junction_is_its_shape_or_its_centre_and_of_a_type_or_unknown(net):
    read = net(('type="priority"', ""), ('<junction id="b"', '<junction id="b" customShape="1"'))
    assert read.junction("j").outline.tolist() == [[100.0, 0.0]] and read.junction("j").kind == "unknown"
    assert read.junction("b").outline.tolist() == [[200.0, 0.0], [200.0, -3.2]] and read.junction("b").kind == "dead_end"
    assert read.junction("b").connections == ()


def test_upstream_tells_lengths_ends_and_ways_into_a_lane(net):
    beside = (
        '<lane id="s_1" index="1" speed="8" length="96" allow="{}" shape="97.8,-96 97.8,-3"/></edge>\n  <junction id="j"'
    )
    own, last = '<lane id="s_0"', '</edge>\n  <junction id="j"'
    for allow, found in (("all", ("s_1",)), ("bus", ("s_1",)), ("tram", ()), ("tram taxi", ("s_1",))):
        read = net((own, '<lane id="s_0" allow="bus taxi"'), (last, beside.format(allow)))
        upstream = NetUpstream(parse(read.path), read.lane)
        assert upstream.detours("s_0", "n") == upstream.detours("s_0", "n") == found
        assert upstream.detours("s_1", "n") == ()
        assert upstream.detours("s_0", "x") == found
    assert (upstream.edge_of("s_1"), upstream.ends_of("s")) == ("s", ("d", "j"))
    assert upstream.arrivals("n_0") == (("w_0", (":j_1_0", ":j_3_0")), ("s_0", (":j_2_0",)))
    assert upstream.arrivals("w_0") == ()
    assert [upstream.spine_length(lane) for lane in ("w_0", "s_0", "w_0")] == pytest.approx([96.0, 93.0, 96.0])
