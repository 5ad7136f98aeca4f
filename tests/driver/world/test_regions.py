"""Conflict regions of hand-made junctions; each number is worked out from a swept width of 2.2 m."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from world_pieces import connection, junction, only

from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.world.regions import SWEPT_WIDTH_M, ConflictKind, conflict_regions, hold_back

HALF = 0.5 * SWEPT_WIDTH_M
EAST = connection("w_0->e_0", [(-8, 0), (8, 0)], 0)
NORTH = connection("s_0->n_0", [(1, -8), (1, 8)], 1)


def regions_of(own, *others, foes=()):
    return conflict_regions([own], junction(own, *others, foes=foes))[own.id]


def test_two_paths_at_right_angles_share_a_square_as_wide_as_the_bodies():
    region = only(regions_of(EAST, NORTH, foes=[(0, 1)]))
    assert region.kind is ConflictKind.CROSSING
    assert (region.own.start, region.own.end) == pytest.approx((9.0 - HALF, 9.0 + HALF))
    assert (region.other.start, region.other.end) == pytest.approx((8.0 - HALF, 8.0 + HALF))
    assert shapely.Polygon(region.polygon).area == pytest.approx(SWEPT_WIDTH_M**2)


def test_the_post_conflict_region_starts_where_the_conflict_region_ends():
    region = only(regions_of(EAST, NORTH, foes=[(0, 1)]))
    assert region.post.start == region.own.end
    assert region.post.connection_id == EAST.id


def test_an_overlap_that_the_network_does_not_declare_counts_if_it_is_substantial():
    assert regions_of(EAST, NORTH)


HAIRPIN = (
    (785.8104281572747, 1710.488223768607), (788.25, 1704.84), (796.18, 1686.19), (798.51, 1679.84), (795.27, 1685.79),
    (786.44, 1704.05), (781.2813877269748, 1714.8846074878877),
)  # fmt: skip
"""A bicycle's turn on a real map; its band crosses itself."""


def test_a_hairpin_whose_band_crosses_itself_is_met_on_both_legs():
    turning = connection("v_0->f_0", [*HAIRPIN], 1)
    across = connection("w_0->e_0", [(780, 1692), (805, 1697)], 0)
    region = only(regions_of(across, turning))
    bands = [shapely.LineString(leg).buffer(HALF, cap_style="flat") for leg in (HAIRPIN[:4], HAIRPIN[3:])]
    own = shapely.LineString(across.path.points).buffer(HALF, cap_style="flat")
    assert shapely.Polygon(region.polygon).area == pytest.approx(shapely.union_all(bands).intersection(own).area, rel=0.01)


def test_a_hairpin_that_reaches_over_the_stop_line_keeps_the_body_back():
    approach = Polyline(np.array([(775.0, 1692.0), (800.0, 1697.0)]))
    assert hold_back(approach, [np.array(HAIRPIN)])[0] > 5.0


def test_a_slight_overlap_that_the_network_does_not_declare_is_no_conflict():
    beside = connection("v_0->f_0", [(-8, 2.19), (8, 2.19)], 1)
    assert not regions_of(EAST, beside)


def test_a_slight_overlap_that_the_network_declares_is_a_conflict():
    beside = connection("v_0->f_0", [(-8, 2.19), (8, 2.19)], 1)
    assert regions_of(EAST, beside, foes=[(0, 1)])


def test_declared_foes_whose_bodies_never_meet_have_no_region():
    apart = connection("v_0->f_0", [(-8, 3.2), (8, 3.2)], 1)
    assert not regions_of(EAST, apart, foes=[(0, 1)])


def test_a_merging_region_begins_where_the_bodies_meet_and_lasts_to_the_end_of_both_paths():
    beside = connection("v_0->e_0", [(-8, 4), (-4, 4), (0, 0), (8, 0)], 1)
    region = only(regions_of(EAST, beside, foes=[(0, 1)]))
    assert region.kind is ConflictKind.MERGING
    # the border x + y = -1.1·√2 of the slanting piece meets the border y = 1.1 of the straight path; s = x + 8
    assert region.own.start == pytest.approx(8.0 - HALF - HALF * math.sqrt(2.0), abs=1e-6)
    assert region.own.end == EAST.path.length
    assert region.other.end == beside.path.length


def test_a_diverging_region_lasts_from_the_stop_line_until_the_bodies_part():
    turning = connection("w_0->n_0", [(-8, 0), (0, 0), (0, 8)], 1)
    region = only(regions_of(EAST, turning))
    assert region.kind is ConflictKind.DIVERGING
    assert (region.own.start, region.own.end) == pytest.approx((0.0, 8.0 + HALF), abs=0.01)
    assert (region.other.start, region.other.end) == pytest.approx((0.0, 8.0 + HALF), abs=0.01)


def test_merging_paths_too_short_to_overlap_still_share_their_end():
    short = connection("a_0->e_0", [(8.0, 5.0), (8.0, 4.9)], 1)
    region = only(regions_of(EAST, short))
    assert region.own.end == EAST.path.length
    assert region.other.end == pytest.approx(0.1)


def test_a_pedestrian_crossing_is_as_wide_as_its_own_lane():
    crossing = connection(":j_w0_0->:j_w1_0", [(4, -5), (4, 5)], 1, width=4.0, is_crossing=True)
    region = only(regions_of(EAST, crossing, foes=[(0, 1)]))
    assert (region.own.start, region.own.end) == pytest.approx((10.0, 14.0))
    assert (region.other.start, region.other.end) == pytest.approx((5.0 - HALF, 5.0 + HALF))


def test_a_bridge_over_a_path_is_no_conflict():
    low = connection("w_0->e_0", [(-8, 0), (8, 0)], 0, heights=(0, 0))
    high = connection("s_0->n_0", [(1, -8), (1, 8)], 1, heights=(5, 5))
    ramp = connection("s_0->n_0", [(1, -8), (1, 8)], 1, heights=(5, -5))
    assert not regions_of(low, high, foes=[(0, 1)])
    assert regions_of(low, ramp, foes=[(0, 1)])


def test_regions_come_in_order_of_their_start():
    later = connection("t_0->m_0", [(5, -8), (5, 8)], 1)
    first = connection("u_0->o_0", [(-4, 8), (-4, -8)], 2)
    regions = regions_of(EAST, later, first, foes=[(0, 1), (0, 2)])
    assert [region.other_id for region in regions] == [first.id, later.id]


def test_a_connection_alone_at_its_junction_has_no_regions():
    assert regions_of(EAST) == ()


@given(st.floats(0.35, math.pi - 0.35))
def test_both_connections_see_the_same_conflict_from_their_own_side(angle):
    dx, dy = 10.0 * math.cos(angle), 10.0 * math.sin(angle)
    slant = connection("s_0->n_0", [(-dx, -dy), (dx, dy)], 1)
    found = conflict_regions([EAST, slant], junction(EAST, slant, foes=[(0, 1)]))
    mine, theirs = only(found[EAST.id]), only(found[slant.id])
    assert (mine.own.start, mine.own.end) == pytest.approx((theirs.other.start, theirs.other.end))
    # half the stretch along a straight path: a rhombus of two bands, (w/2)·(1 + |cos|)/sin
    half = HALF * (1.0 + abs(math.cos(angle))) / math.sin(angle)
    assert mine.own.end - mine.own.start == pytest.approx(min(2.0 * half, 16.0), abs=0.01)


@given(st.floats(0.3, 2.8), st.floats(2.0, 12.0))
def test_every_region_lies_on_both_paths(angle, radius):
    bend = [(radius * math.sin(a) - 8.0, radius * (1.0 - math.cos(a))) for a in np.linspace(0.0, angle, 12)]
    turning = connection("w_1->n_0", bend, 1)
    for region in regions_of(EAST, turning, foes=[(0, 1)]):
        assert 0.0 <= region.own.start <= region.own.end <= EAST.path.length + 1e-9
        assert 0.0 <= region.other.start <= region.other.end <= turning.path.length + 1e-9


APPROACH = Polyline(np.array([(-40.0, 0.0), (0.0, 0.0)]))
BACK = np.array([(4.0, 0.5), (-7.0, 0.5), (-10.0, 6.0)])
"""A way out that lies over the last 7 m of the approach."""


def test_a_way_that_reaches_over_an_approach_lane_is_named_and_leaves_no_room_there():
    room, reaching = hold_back(APPROACH, [np.array([(4.0, 9.0), (-12.0, 9.0)]), BACK])
    assert 7.0 < room < 10.0
    assert reaching == (1,)


def test_an_approach_that_nobody_reaches_over_is_used_up_to_its_line():
    assert hold_back(APPROACH, [np.array([(4.0, 9.0), (-12.0, 9.0)])]) == (0.0, ())


def test_a_region_on_the_approach_begins_before_the_stop_line():
    """Both see the same area: one before its line, the other behind its junction."""
    head, tail = np.array([(-8.0, 0.0), (0.0, 0.0)]), np.array([(0.0, 0.5), (-7.0, 0.5)])
    own = connection("w_0->e_0", [(0, 0), (4, 0)], 0, hold_back=8.0, head=head)
    other = connection("e_1->w_1", [(4, 0.5), (0, 0.5)], 1, tail=tail)
    region = only(regions_of(own, other))
    assert region.own.start == pytest.approx(-7.0, abs=0.01)
    assert region.own.end == pytest.approx(4.0, abs=0.01)
    assert (region.other.start, region.other.end) == pytest.approx((0.0, 11.0), abs=0.01)


@pytest.mark.parametrize(
    ("points", "foes", "is_one"),
    [
        ([(4, 1.5), (0, 1.5)], (), False),
        ([(4, 1.5), (0, 1.5)], [(0, 1)], True),  # the network calls them conflicting
        ([(4, 1.1), (0, 1.1)], (), True),  # drawn over each other
        ([(4, 2.1), (2.5, 2.1), (1.5, 1.2), (0, 1.2)], (), True),  # it swerves
        ([(0, 1.5), (4, 1.5)], (), True),  # the same way
        ([(4, 1.3), (0, 2.0)], (), False),
    ],
)
def test_straight_ways_towards_each_other_are_no_conflict_however_narrow_the_road(points, foes, is_one):
    own, other = connection("w_0->e_0", [(0, 0), (4, 0)], 0), connection("e_1->w_1", points, 1)
    found = conflict_regions([own], junction(own, other, foes=foes))["w_0->e_0"]
    assert bool(found) is is_one


def loop(gap):
    """A way that crosses the x axis northwards at x = −3 and comes back southwards, `gap` m farther on."""
    return connection("s_0->s_1", [(-3, -8), (-3, gap), (-3 + gap, gap), (-3 + gap, -8)], 1)


@pytest.mark.parametrize(("gap", "regions"), [(8.0, 1), (11.0, 1), (12.0, 2), (30.0, 2)])
def test_ways_that_cross_twice_have_two_regions_where_a_car_can_stand_in_between(gap, regions):
    own = connection("w_0->e_0", [(-20, 0), (40, 0)], 0)
    found = regions_of(own, loop(gap), foes=[(0, 1)])
    assert len(found) == len({region.id for region in found}) == regions
    assert all(region.post.region_id == region.id and region.kind is ConflictKind.CROSSING for region in found)
    first, last = found[0], found[-1]
    assert (first.own.start, last.own.end) == pytest.approx((17.0 - HALF, 17.0 + gap + HALF))
    assert (first.other.start, last.other.end) == pytest.approx((8.0 - HALF, 8.0 + 3.0 * gap + HALF))
    if regions == 2:
        assert (first.own.end, last.own.start) == pytest.approx((17.0 + HALF, 17.0 + gap - HALF))
        assert (first.other.end, last.other.start) == pytest.approx((8.0 + HALF, 8.0 + 3.0 * gap - HALF))


def test_ways_that_cross_and_then_merge_cross_in_one_region_and_merge_in_the_other():
    own = connection("w_0->e_0", [(-20, 0), (40, 0)], 0)
    other = connection("s_0->e_0", [(-3, -8), (-3, 12), (25, 12), (25, 0), (40, 0)], 1)
    crossing, merging = regions_of(own, other, foes=[(0, 1)])
    assert (crossing.kind, merging.kind) == (ConflictKind.CROSSING, ConflictKind.MERGING)
    assert (crossing.own.end, merging.own.end) == pytest.approx((17.0 + HALF, 60.0))


def test_ways_from_one_lane_part_in_one_region_and_cross_in_the_next():
    """A turn to the left, and the way around that leads out over it first and comes back across it."""
    own = connection("w_0->n_0", [(0, 0), (12, 0), (20, 8), (20, 30)], 0)
    around = connection("w_0->w_1", [(0, 0), (6, -6), (30, -6), (30, 14), (0, 14)], 1)
    parting, crossing = regions_of(own, around)
    assert (parting.kind, crossing.kind) == (ConflictKind.DIVERGING, ConflictKind.CROSSING)
    assert parting.own.start == 0.0
    before = own.path.arc_lengths[2] + 6.0
    assert (crossing.own.start, crossing.own.end) == pytest.approx((before - HALF, before + HALF))
    assert [region.kind for region in regions_of(around, own)] == [ConflictKind.DIVERGING, ConflictKind.CROSSING]
    aside = connection("w_0->s_0", [(0, 0), (4, 0), (8, -8), (8, -20)], 1)
    assert only(regions_of(own, aside)).kind is ConflictKind.DIVERGING
