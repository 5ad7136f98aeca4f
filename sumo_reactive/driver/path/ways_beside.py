"""Other lanes that lead on along the route as well as those of C: what the ego may change to when its own is held up."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping

from sumo_reactive.driver.nouns.plan import LaneSegment, WayBeside
from sumo_reactive.driver.path.lane_choice import LaneChoice, may_change


def ways_beside(choice: LaneChoice, segments: tuple[LaneSegment, ...]) -> Mapping[int, tuple[WayBeside, ...]]:
    """Return, by route index, the lanes beside C by which the route can be driven with no change back on that edge.

    Where C itself changes lanes on an edge, there are none: that change comes first.
    """
    lanes = [segment for segment in segments if not choice.graph.lanes[segment.lane_id].is_internal]
    times = Counter(segment.route_index for segment in lanes)
    found = {one.route_index: tuple(_beside(choice, one)) for one in lanes if times[one.route_index] == 1}
    return {index: ways for index, ways in found.items() if ways}


def _beside(choice: LaneChoice, segment: LaneSegment) -> Iterator[WayBeside]:
    own, left_hand = choice.graph.lanes[segment.lane_id], choice.graph.left_hand
    number = choice.stage_at(segment.route_index, segment.lane_offset / own.scale)
    lanes, onward = choice.stages[number].lanes, choice.onward[number]
    for index in (own.index + 1, own.index - 1):
        if not 0 <= index < len(lanes) or onward[index].cost == math.inf:
            continue
        if may_change(own, lanes[index], choice.vehicle_class, left_hand):
            side = -1 if (index > own.index) == left_hand else 1
            yield WayBeside(own.id, lanes[index].id, side, 1.0 + onward[index].cost - onward[own.index].cost)
