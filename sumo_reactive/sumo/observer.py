"""What an ego can see: road users on the lanes that matter, and the lights before it."""

from __future__ import annotations

import math
from itertools import chain

from sumo_reactive.driver.caching import kept
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.traffic import NO_SWITCHES, Traffic, packed_boxes
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.attention import in_sight, lanes_in_sight
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.sumo.net_file import edge_id_of
from sumo_reactive.sumo.sensor import SeenCrossing, SeenLane, Sensor
from sumo_reactive.sumo.static_obstacles import LANES_REFRESH_M, NOTHING, StaticView


class EgoObserver:
    """Directs the sensor's look to what matters for one ego with these `limits`."""

    def __init__(self, ego_id: str, sensor: Sensor, limits: VehicleLimits) -> None:
        self._ego_id = ego_id
        self._sensor = sensor
        self._limits = limits
        self._static = StaticView(sensor.static, ego_id)
        self._view: tuple[object, int, float] = (None, 0, 0.0)
        self._in_view: tuple[str, ...] = ()
        self._lanes: dict[str, SeenLane] = {}
        self._crossings: tuple[SeenCrossing, ...] = ()
        self._lights: tuple[str, ...] = ()

    def observe(self, graph: RoadGraph, plan: NominalPlan, front: float, speed: float, sight: float) -> Traffic:
        """Return everything on the lanes in sight with the front bumper at `front` m of C and `speed` m/s.

        `sight` (m): how far the pilot wants to look along the road.
        """
        view = (plan, int(front / LANES_REFRESH_M), sight)
        if view[0] is not self._view[0] or view[1:] != self._view[1:]:
            self._look(graph, plan, front, speed, sight)
            self._view = view
        sensor = self._sensor
        now = sensor.look()
        lights = {light: sensor.letters(light) for light in self._lights}
        horizon = self._limits.parameters.foreseen_lights_s
        switches = {light: sensor.switches(light, horizon) for light in self._lights} if horizon else NO_SWITCHES
        static = NOTHING if self._static.is_empty else self._static.near(*plan.curve.at(front)[:2])
        on_lanes = sensor.vehicles(self._lanes, self._ego_id)
        walking = (user for crossing in self._crossings for user in sensor.on_crossing(crossing))
        users, others = tuple(chain.from_iterable([one.users for one in on_lanes])), (*walking, *static.users)
        boxes = bytearray().join([one.boxes for one in on_lanes])
        if others:
            users, boxes = users + others, boxes + packed_boxes(others)
        beside = tuple(user for crossing in self._crossings for user in sensor.about_to_cross(crossing))
        return Traffic(
            time=now, users=users, lights=lights, sight=sight, static=static.points, beside=beside, switches=switches,
            yellow_until=sensor.yellow_until(lights), asker=sensor.asker_of(self._ego_id, self._lanes), as_packed=boxes,
        )  # fmt: skip

    def _look(self, graph: RoadGraph, plan: NominalPlan, front: float, speed: float, sight: float) -> None:
        """Choose lanes, crossings and lights for the next metres."""
        in_view = lanes_in_sight(graph, plan, self._limits, front, speed, sight)
        if in_view is not self._in_view:
            self._in_view, seen = in_view, [_seen(graph, lane_id) for lane_id in in_view]
            self._lanes = {one.lane_id: one for one in seen if isinstance(one, SeenLane)}
            self._crossings = tuple(one for one in seen if isinstance(one, SeenCrossing))
        ahead = [graph.junctions[plan.passages[index].junction_id] for index in in_sight(plan, front, speed)]
        self._lights = tuple(dict.fromkeys(c.light.light_id for one in ahead for c in one.connections if c.light))


@kept(16384)
def _seen(graph: RoadGraph, lane_id: str) -> SeenLane | SeenCrossing:
    """Return what to look at for a lane of the graph."""
    lane, connection = graph.lanes[lane_id], graph.connection_of.get(lane_id)
    if connection is None or not connection.is_crossing:
        return SeenLane(lane_id, lane.edge_id, lane.scale, lane.is_internal)
    spine = lane.spine
    walks = dict.fromkeys(edge_id_of(end) for end in (connection.from_lane, connection.to_lane))
    first, last = spine.at(0.0), spine.at(spine.length)
    onto, back = spine.heading_at(0.0), spine.heading_at(spine.length) + math.pi
    return SeenCrossing(
        lane.edge_id, lane.id, tuple(walk for walk in walks if walk != lane.edge_id),
        ((*first, 0.0, onto), (*last, spine.length, back)),
    )  # fmt: skip
