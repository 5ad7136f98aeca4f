#!/usr/bin/env python3
"""Draw the figures that explain the paper's formulas, with the code that drives the car.

    python tools/figures.py [NAME…] [--out FOLDER]

`model`: the car-like vehicle (F&L 1991, §3.1, figure 2). `shadow`: the shadow R_D and the potential U_D of a moving
obstacle (§3.3.2, figure 3). `valley`: U₁ of a curve C that the planner made (§3.3.1). `figure4`: four moments of
scenarios/figure4.toml (§4, figure 4). Without a name all are drawn. Nothing is sketched: poses come from `advance_pose`,
δ from `shadow_distance`, fields from `shadow_potential`, `Ground` and `valley_map`, moments from the record of a
run. Needs matplotlib. The same versions draw the same bytes.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap, LogNorm
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Arc, Patch, Polygon
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from sumo_reactive.driver.field.ground import Ground
from sumo_reactive.driver.field.shadow import shadow_distance, shadow_potential
from sumo_reactive.driver.field.valley_map import ValleyMap, map_potential, valley_map
from sumo_reactive.driver.geometry.curve import Curve, project_on_curve
from sumo_reactive.driver.geometry.footprint import Footprint
from sumo_reactive.driver.geometry.polyline import Polyline
from sumo_reactive.driver.nouns.completed_plan import Weights
from sumo_reactive.driver.nouns.decision import Instruction, Occupancy
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.driver.nouns.state import STANDING_SPEED, Pose, VehicleState
from sumo_reactive.driver.nouns.traffic import RoadUser
from sumo_reactive.driver.parameters import USUAL
from sumo_reactive.driver.path.planner import PlanStart, plan
from sumo_reactive.driver.pilot.instructions import TUNINGS
from sumo_reactive.driver.vehicle.bicycle import advance_pose
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.driver.view.static import static_within
from sumo_reactive.driver.world.road_graph import RoadGraph
from sumo_reactive.driver.world.route import Route
from sumo_reactive.lab import simulation
from sumo_reactive.lab.metrics.moment import GHOST
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.trip import Trip
from sumo_reactive.sumo.net_reader import read_net

Array = NDArray[np.float64]
Point = tuple[float, float]

ROOT = Path(__file__).resolve().parent.parent

CAR = VehicleLimits(
    length=4.7, width=1.8, wheelbase=2.8, front_overhang=0.9, max_speed=55.0, max_acceleration=2.6,
    comfort_deceleration=2.5, service_deceleration=4.5, emergency_deceleration=8.0, max_steering_angle=0.65,
    max_steering_rate=1.0, max_lateral_acceleration=4.0, comfort_lateral_acceleration=3.0,
)  # fmt: skip
"""M, and the size of every other car drawn."""

# --- style ------------------------------------------------------------------------------------------------------------
INK, OTHER, GREY, PALE = "#1f3b5c", "#b5482a", "#7d838c", "#d5d9de"
"""M and what belongs to it; obstacles; what helps to read; ground and contact."""
TINT = LinearSegmentedColormap.from_list("tint", ["#ffffff", "#cfdce8", "#86a6c4", "#456f9b", "#274b73"])
STYLE: dict[Any, Any] = {
    "font.size": 10.0, "axes.titlesize": 10.0, "axes.labelsize": 10.0, "axes.edgecolor": GREY, "axes.linewidth": 0.7,
    "xtick.color": GREY, "ytick.color": GREY, "xtick.labelsize": 9.0, "ytick.labelsize": 9.0,
    "mathtext.fontset": "dejavusans", "hatch.linewidth": 0.5, "savefig.dpi": 150.0, "figure.constrained_layout.use": True,
    "figure.constrained_layout.h_pad": 0.08,
}  # fmt: skip
SYMBOL_PT, WORDS_PT, LABEL_GAP_PT = 13.0, 10.5, 5.0
THIN, MEDIUM, BOLD = 0.8, 1.2, 2.0
"""Line widths, pt."""
BODY_ALPHA, GHOST_ALPHA, HATCH_ALPHA, BOX_ALPHA = 0.12, 0.05, 0.6, 0.75
BOX_PAD_PT = 1.0
TICK_STEPS = (1, 2, 5, 10)
BAR_PLACE = (1.04, 0.0, 0.035, 1.0)
"""A colour bar beside its axes, in shares of them."""
GROUND, ROAD, FIELD, LINES, BODIES, MARKS = range(6)
"""What is drawn over what."""
COMPASS = {
    "n": (0, 1), "ne": (1, 1), "e": (1, 0), "se": (1, -1), "s": (0, -1), "sw": (-1, -1), "w": (-1, 0), "nw": (-1, 1),
    "c": (0, 0),
}  # fmt: skip
"""On which side of its place a label stands."""
INK_LINE: dict[str, Any] = {"color": INK, "lw": BOLD}
GREY_LINE: dict[str, Any] = {"color": GREY, "lw": MEDIUM, "ls": "--"}

# --- model ------------------------------------------------------------------------------------------------------------
MODEL_STATE = VehicleState(Pose(1.6, 1.4, 0.35), speed=8.0, steering_angle=0.45)
MODEL_SIZE_IN, MODEL_WINDOW = (7.0, 6.5), (0.0, 8.6, 0.0, 7.4)
MODEL_ARROW_S = 0.26
"""A velocity is drawn as the way of this time, s."""
WHEEL_LENGTH_M, WHEEL_WIDTH_M, TRACK_M = 0.62, 0.2, 1.4
ARC_POSES = 41
MODEL_FORMULAS = (
    "\n"
    r"$\dot x=v\,\cos\varphi\,\cos\theta$,  $\dot y=v\,\cos\varphi\,\sin\theta$,  $\dot\theta=v\,\sin\varphi\,/\,L$"
)
HEADING_ARC_M, STEERING_ARC_M, AXIS_BEYOND_M, HORIZONTAL_M, DIMENSION_M = 1.5, 1.5, 2.1, 2.1, 1.45

# --- shadow -----------------------------------------------------------------------------------------------------------
OWN = Footprint(0.5 * CAR.length, 0.0, 0.0, CAR.length, CAR.width)
OWN_SPEED = 10.0
OBSTACLE_CENTRE, OBSTACLE_HEADING, OBSTACLE_SPEED = (14.2, -8.2), 1.75, 6.0
SHADOW_SIZE_IN, SHADOW_WINDOW = (12.0, 4.2), (-6.0, 25.0, -14.0, 7.0)
TRIANGLE_AT, SHADOW_NAME_M = (10.0, 5.0), 22.0
"""Where the triangle of velocities begins; how far from M the name of its shadow stands, m."""
SHADOW_ARROW_S = 0.6
SHADOW_CELL_M = 0.05
SHADOW_LEVELS = (0.3, 0.5, 1.0, 2.0, 5.0, 10.0)
SHADOW_LINES = {1.0: INK, 2.0: INK, 5.0: "white"}
"""Values of U_D that are drawn as lines, and their colours."""
FAR_M = 100.0
"""The shadow is drawn this long: beyond the window."""

# --- valley -----------------------------------------------------------------------------------------------------------
NETWORK = ROOT / "networks" / "right_before_left" / "right_before_left.net.xml"
ROUTE = Route(("from_south", "to_west"))
START_M, START_SPEED = 30.0, 8.0
"""Front bumper's place on the first lane where C begins, and speed there."""
MAP_AT_M, CAR_AT_M, NAME_AT_M, PARKED_AT_M = 60.0, 78.0, 90.0, 106.0
"""Arc lengths on C: the bitmap's middle, F of the car, the name of C, the middle of the parked car."""
PARKED_ROOM_M = 0.45
"""Room between the parked car and the side of a car on C, m."""
KERB_FROM_M, KERB_TO_M = 92.0, 112.8
"""Kerb line on the right of the first lane, in metres of its spine."""
STATIC_STEP_M = 0.1
SEAM_M = 0.01
"""Closes the seams between lanes and junctions, which the map rounds to 1 cm."""
VALLEY_SIZE_IN, VALLEY_WINDOW = (12.0, 5.4), (96.0, 130.0, 98.0, 130.0)
VALLEY_LEVELS = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 14.0)
SECTION_REACH_M, SECTION_SAMPLES, SECTION_TOP = 4.0, 801, 9.0

# --- figure 4 ---------------------------------------------------------------------------------------------------------
EXPERIMENT = ROOT / "scenarios" / "figure4.toml"
OUT_SHARE = 1.0 / 3.0
"""Snapshot 1: M has gone this share of its way aside."""
WINDOWS = ((-20.0, 40.0, -9.0, 7.0),) * 2 + ((-27.0, 33.0, -13.0, 23.0),) * 2
"""Ground shown around the middle of M's front, m: beside a road, and at an intersection."""
EXPERIMENT_SIZE_IN, Y_TICKS = (12.0, 12.4), 5
VELOCITY_S, TRACE_DOT_S = 0.6, 1.0
"""A velocity is drawn as the way of this time; the trace has a dot each so many seconds."""
FIELD_CELL_M, FIELD_GUESS_M, FIELD_STATIC_M = 0.1, 15.0, 100.0
"""Spacing of the places at which U is taken; how far around its guess the foot on C is sought; side of the window of O_S."""
FIELD_LEVELS = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
GOAL_ARROW_M, GOAL_INSET_M, GOAL_BESIDE_M, STOP_BAR_M = 5.0, 8.0, 4.5, 1.6
"""Length of the arrow to g, its place before the window's end and beside C; half the bar where M is to stop."""
STATE_STYLES: dict[Occupancy, dict[str, Any]] = {
    Occupancy.FREE: {"facecolor": "white", "edgecolor": GREY, "lw": THIN},
    Occupancy.OWN: {"facecolor": "#b9cadb", "edgecolor": INK, "lw": THIN},
    Occupancy.CLAIMED: {"facecolor": "white", "edgecolor": OTHER, "lw": THIN, "hatch": "////"},
    Occupancy.OCCUPIED: {"facecolor": "#dfa795", "edgecolor": OTHER, "lw": THIN},
}
"""How a conflict region looks in each state; later ones are drawn over earlier ones."""
STATE_NAMES = {
    Occupancy.FREE: "region free", Occupancy.OWN: "held by $M$", Occupancy.CLAIMED: "claimed by another",
    Occupancy.OCCUPIED: "occupied",
}  # fmt: skip


def main() -> None:
    """Draw the figures named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(FIGURES)}; all without one")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images", metavar="FOLDER", help="where the images go")
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.names if name not in FIGURES]:
        parser.error(f"no figure named {', '.join(unknown)}; there are {', '.join(FIGURES)}")
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name in arguments.names or FIGURES:
        with plt.rc_context(STYLE):
            print(FIGURES[name](arguments.out))


# --- figure 2 ---------------------------------------------------------------------------------------------------------
def model(out: Path) -> Path:
    """Draw the vehicle M with q, L, v and φ, and what it does in one δt (F&L 1991, §3.1, figure 2)."""
    figure, axes = plt.subplots(figsize=MODEL_SIZE_IN)
    _map_axes(axes, MODEL_WINDOW)
    poses = _poses_of_one_period(MODEL_STATE)
    _body(axes, _footprint(poses[-1]), GREY, ghost=True)
    _paths_of_axles(axes, poses)
    _body(axes, _footprint(MODEL_STATE.pose), INK)
    for corners in _wheels(MODEL_STATE):
        axes.add_patch(Polygon(corners, facecolor=INK, edgecolor=INK, zorder=BODIES))
    _configuration(axes, MODEL_STATE.pose)
    _velocity(axes, MODEL_STATE)
    _label(axes, _corner(_footprint(MODEL_STATE.pose), "se"), r"$M$", "se")
    axes.legend(loc="lower right", frameon=False)
    axes.set_title(
        rf"$L$ = {CAR.wheelbase:g} m,  $v$ = {MODEL_STATE.speed:g} m/s,  $\theta$ = {_degrees(MODEL_STATE.pose.heading)},  "
        rf"$\varphi$ = {_degrees(MODEL_STATE.steering_angle)},  $\delta t$ = {USUAL.paper_control_period_s:g} s"
        f"{MODEL_FORMULAS}"
    )
    return _save(figure, out / "figure2_model.png")


def _poses_of_one_period(state: VehicleState) -> list[Pose]:
    """Return q at even times of one δt during which v and φ hold."""
    p = state.pose
    times = np.linspace(0.0, USUAL.paper_control_period_s, ARC_POSES)
    return [
        Pose(*advance_pose(p.x, p.y, p.heading, state.speed, state.steering_angle, CAR.wheelbase, float(t))) for t in times
    ]


def _paths_of_axles(axes: Axes, poses: list[Pose]) -> None:
    """Draw what R and F trace, and the new configuration q'."""
    rear, front = np.array([(p.x, p.y) for p in poses]), np.array([_front_axle(p) for p in poses])
    axes.plot(*rear.T, color=OTHER, lw=BOLD, zorder=MARKS, label=r"path of $R$ in one $\delta t$")
    axes.plot(*front.T, color=OTHER, lw=MEDIUM, ls="--", zorder=MARKS, label=r"path of $F$ in one $\delta t$")
    axes.plot(*np.array([rear[-1], front[-1]]).T, color=GREY, lw=THIN, ls="-.", zorder=LINES)
    for x, y in (rear[-1], front[-1]):
        axes.plot(x, y, "o", color="white", mec=OTHER, zorder=MARKS)
    _label(axes, (rear[-1, 0], rear[-1, 1]), r"$q\,'$", "nw", OTHER)
    _label(axes, (front[-1, 0], front[-1, 1]), r"$F\,'$", "ne", OTHER)


def _wheels(state: VehicleState) -> list[Array]:
    """Return the outlines of the four wheels; each rolls around the centre on which R turns, so the front ones differ."""
    p = state.pose
    centre = CAR.wheelbase / math.tan(state.steering_angle)
    outlines = []
    for ahead in (0.0, CAR.wheelbase):
        for left in (-0.5 * TRACK_M, 0.5 * TRACK_M):
            heading = p.heading + math.atan(ahead / (centre - left))
            front = _in_world(Pose(*_in_world(p, ahead, left), heading), 0.5 * WHEEL_LENGTH_M, 0.0)
            outlines.append(Footprint(*front, heading, WHEEL_LENGTH_M, WHEEL_WIDTH_M).corners())
    return outlines


def _configuration(axes: Axes, pose: Pose) -> None:
    """Draw R, F, the main axis, θ and L."""
    rear, front = (pose.x, pose.y), _front_axle(pose)
    end = _in_world(pose, CAR.wheelbase + AXIS_BEYOND_M, 0.0)
    axes.plot(*zip(rear, end, strict=True), color=INK, lw=THIN, ls="-.", zorder=LINES)
    axes.plot(*zip(rear, (pose.x + HORIZONTAL_M, pose.y), strict=True), color=INK, lw=THIN, zorder=LINES)
    _angle(axes, rear, HEADING_ARC_M, 0.0, pose.heading, r"$\theta$")
    for place, name, side in ((rear, r"$R$", "nw"), (front, r"$F$", "s")):
        axes.plot(*place, "o", color=INK, zorder=MARKS)
        _label(axes, place, name, side)
    _label(axes, rear, r"$q=(x,y,\theta)$", "se")
    _dimension(axes, pose)


def _dimension(axes: Axes, pose: Pose) -> None:
    """Draw the wheelbase L as a measured line on the left of the body."""
    ends = [_in_world(pose, ahead, DIMENSION_M) for ahead in (0.0, CAR.wheelbase)]
    for ahead, end in zip((0.0, CAR.wheelbase), ends, strict=True):
        axes.plot(*zip(_in_world(pose, ahead, 0.0), end, strict=True), color=GREY, lw=THIN, ls=":", zorder=LINES)
    _measure(axes, ends[0], ends[1], GREY)
    _label(axes, _in_world(pose, 0.5 * CAR.wheelbase, DIMENSION_M), r"$L$", "nw")


def _velocity(axes: Axes, state: VehicleState) -> None:
    """Draw v at F and its angle φ to the main axis."""
    front, heading = _front_axle(state.pose), state.pose.heading
    direction = heading + state.steering_angle
    way = MODEL_ARROW_S * state.speed
    tip = _arrow(axes, front, (way * math.cos(direction), way * math.sin(direction)), INK)
    _label(axes, tip, r"$v$", "n")
    _angle(axes, front, STEERING_ARC_M, heading, direction, r"$\varphi$")


# --- figure 3 ---------------------------------------------------------------------------------------------------------
def shadow(out: Path) -> Path:
    """Draw the shadow R_D with δ, and U_D for every place of D (F&L 1991, §3.3.2, figure 3)."""
    figure, (left, right) = plt.subplots(1, 2, figsize=SHADOW_SIZE_IN)
    obstacle = _centred(OBSTACLE_CENTRE, OBSTACLE_HEADING)
    for axes in (left, right):
        _map_axes(axes, SHADOW_WINDOW)
    _shadow_scene(left, obstacle)
    _shadow_field(figure, right, obstacle)
    return _save(figure, out / "figure3_shadow.png")


def _velocities() -> tuple[Array, Array, Array, float]:
    """Return v, v_D, the unit vector along v − v_D, and ‖v − v_D‖."""
    own = OWN_SPEED * np.array([math.cos(OWN.heading), math.sin(OWN.heading)])
    other = OBSTACLE_SPEED * np.array([math.cos(OBSTACLE_HEADING), math.sin(OBSTACLE_HEADING)])
    relative = float(np.hypot(*(own - other)))
    return own, other, (own - other) / relative, relative


def _shadow_scene(axes: Axes, obstacle: Footprint) -> None:
    """Draw M, D, R_D, δ and the three velocities."""
    own, other, along, relative = _velocities()
    distance = shadow_distance(OWN.corners(), obstacle.corners(), *along)
    cast = _cast(OWN.corners(), along)
    _region(axes, cast, facecolor="none", edgecolor=INK, hatch="////", alpha=HATCH_ALPHA, lw=THIN, zorder=ROAD)
    met = shapely.intersection(cast, shapely.Polygon(obstacle.corners()))
    _body(axes, OWN, INK, opaque=True)
    _body(axes, obstacle, OTHER, opaque=True)
    _region(axes, met, facecolor="none", edgecolor=OTHER, hatch="////", lw=THIN, zorder=BODIES)
    _shortest_way(axes, obstacle, distance * along)
    _velocity_triangle(axes, own, other)
    _label(axes, _arrow(axes, OWN.corners().mean(axis=0), SHADOW_ARROW_S * own, INK), r"$v$", "n")
    _label(axes, _arrow(axes, obstacle.corners().mean(axis=0), SHADOW_ARROW_S * other, OTHER), r"$v_D$", "e", OTHER)
    _label(axes, _corner(OWN, "nw"), r"$M$", "nw")
    _label(axes, (SHADOW_NAME_M * along[0], SHADOW_NAME_M * along[1]), r"$R_D$", "c", boxed=True)
    _label(axes, _corner(obstacle, "se"), r"$D$", "se", OTHER, boxed=True)
    axes.set_title(
        rf"$\delta$ = {distance:.1f} m,  $\|v-v_D\|$ = {relative:.1f} m/s,"
        rf"  $\delta/\|v-v_D\|$ = {distance / relative:.2f} s to the collision"
    )


def _shortest_way(axes: Axes, obstacle: Footprint, way: Array) -> None:
    """Draw δ from the point of M that touches D first to the place where it does."""
    moved = shapely.Polygon(OWN.corners() + way)
    contact = np.array(shapely.shortest_line(moved, shapely.Polygon(obstacle.corners())).coords[-1])
    first = contact - way
    _measure(axes, (first[0], first[1]), (contact[0], contact[1]), OTHER)
    _label(axes, _between(first, contact), r"$\delta$", "ne", OTHER, boxed=True)


def _velocity_triangle(axes: Axes, own: Array, other: Array) -> None:
    """Draw v, −v_D from its tip, and their sum v − v_D."""
    tip = _arrow(axes, TRIANGLE_AT, SHADOW_ARROW_S * own, INK)
    end = _arrow(axes, tip, -SHADOW_ARROW_S * other, OTHER)
    _arrow(axes, TRIANGLE_AT, SHADOW_ARROW_S * (own - other), GREY)
    _label(axes, _between(TRIANGLE_AT, tip), r"$v$", "n")
    _label(axes, _between(tip, end), r"$-v_D$", "e", OTHER)
    _label(axes, _between(TRIANGLE_AT, end), r"$v-v_D$", "sw", GREY)


def _shadow_field(figure: Figure, axes: Axes, obstacle: Footprint) -> None:
    """Draw U_D in colour over the places of D's centre, contact in grey."""
    image = _potential_in_colour(axes)
    _body(axes, OWN, INK)
    _body(axes, obstacle, OTHER)
    axes.plot(*obstacle.corners().mean(axis=0), "+", color=OTHER, zorder=MARKS)
    _label(axes, OWN.corners().mean(axis=0), r"$M$", "c")
    _label(axes, _corner(obstacle, "se"), r"$D$", "se", OTHER)
    axes.set_title(r"$U_D=k_0\,\|v-v_D\|\,/\,\delta$ over the place of the centre of $D$ (grey: contact)")
    bar = figure.colorbar(image, cax=axes.inset_axes(BAR_PLACE), extend="both", ticks=SHADOW_LEVELS, format="%g")
    bar.set_label(rf"$U_D$  ($k_0$ = {USUAL.shadow_scale:g} s, no unit)")
    bar.minorticks_off()


def _potential_in_colour(axes: Axes) -> QuadMesh:
    """Draw U_D, lines of equal U_D with their values, and the outlines of where it is not 0."""
    x, y = _grid(SHADOW_WINDOW, SHADOW_CELL_M)
    contact, (_, _, along, relative) = _contact(), _velocities()
    outline = np.array(contact.exterior.coords)
    field = np.ma.masked_equal(_shadow_potentials(x, y), 0.0)
    free = np.ma.masked_where(shapely.contains_xy(contact, *np.meshgrid(x, y)), field)
    scale = LogNorm(SHADOW_LEVELS[0], SHADOW_LEVELS[-1])
    image = axes.pcolormesh(x, y, field, cmap=TINT, norm=scale, rasterized=True, zorder=GROUND)
    axes.contour(x, y, free, levels=[*SHADOW_LINES], colors=[*SHADOW_LINES.values()], linewidths=THIN, zorder=FIELD)
    _region(axes, _cast(outline, along), facecolor="none", edgecolor=GREY, lw=THIN, zorder=LINES)
    _region(axes, contact, facecolor=PALE, edgecolor=GREY, lw=THIN, zorder=LINES)
    left = outline[int(np.argmax(outline @ np.array((-along[1], along[0]))))]
    for value in SHADOW_LINES:
        place = left + USUAL.shadow_scale * relative / value * along
        _label(axes, (place[0], place[1]), f"{value:g}", "ne")
    return image


def _cast(outline: Array, along: Array) -> shapely.Polygon:
    """Return what a convex outline (n, 2) sweeps along a unit vector."""
    return shapely.MultiPoint(np.vstack((outline, outline + FAR_M * along))).convex_hull


def _contact() -> shapely.Geometry:
    """Return where D's centre is when it touches M: all sums of a corner of either body span it."""
    sums = OWN.corners()[:, None, :] + _centred((0.0, 0.0), OBSTACLE_HEADING).corners()
    return shapely.MultiPoint(sums.reshape(-1, 2)).convex_hull


def _shadow_potentials(x: Array, y: Array) -> Array:
    """Return U_D for D's centre at each place of the grid, shape (len(y), len(x))."""
    (own_x, own_y), (other_x, other_y), _, _ = _velocities()
    body = _centred((0.0, 0.0), OBSTACLE_HEADING).corners()
    mine = OWN.corners()
    field = np.empty((len(y), len(x)))
    for i, j in np.ndindex(field.shape):
        field[i, j] = shadow_potential(
            mine, own_x, own_y, body + np.array((x[j], y[i])), other_x, other_y, USUAL.shadow_scale
        )
    return field


# --- valley -----------------------------------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class ValleyScene:
    """A road with C, static obstacles beside it, and U₁ of F with and without them."""

    graph: RoadGraph
    curve: Curve
    parked: Footprint
    kerb: Array
    with_static: ValleyMap
    without: ValleyMap


def valley(out: Path) -> Path:
    """Draw U₁ around C with static obstacles, and a section across the lane (F&L 1991, §3.3.1)."""
    scene = _valley_scene()
    figure, (left, right) = plt.subplots(1, 2, figsize=VALLEY_SIZE_IN, width_ratios=(1.2, 1.0))
    _valley_map(figure, left, scene)
    _valley_section(right, scene)
    return _save(figure, out / "valley.png")


def _valley_scene() -> ValleyScene:
    """Plan C through the junction, park a car beside it, and compute the bitmaps of U₁."""
    graph = read_net(NETWORK).build(ROUTE.edges)
    lane = graph.lanes[f"{ROUTE.edges[0]}_0"]
    heading = lane.spine.heading_at(START_M)
    pose = _behind(lane.spine.at(START_M), heading, CAR.front_to_rear_axle)
    start = PlanStart(pose, START_SPEED, 0.0, 0.0, lane.id, START_M / lane.scale, 0)
    curve = plan(graph, ROUTE, CAR, start).curve
    centre = _beside(curve, PARKED_AT_M, -(CAR.width + PARKED_ROOM_M))
    parked = _centred(centre, curve.at(PARKED_AT_M)[2])
    kerb = _right_border(lane.spine, lane.width)
    static = np.vstack((_filled(parked), kerb))
    none = np.empty((0, 2))
    maps = [valley_map(curve, MAP_AT_M, heading, CAR.wheelbase, points, USUAL) for points in (static, none)]
    return ValleyScene(graph, curve, parked, kerb, *maps)


def _beside(curve: Curve, s: float, d: float) -> Point:
    """Return the place `d` m to the left of C at arc length `s`."""
    x, y, heading = curve.at(s)
    return x - d * math.sin(heading), y + d * math.cos(heading)


def _right_border(spine: Polyline, width: float) -> Array:
    """Return points along the right border of a lane, shape (k, 2), m."""
    places = np.arange(KERB_FROM_M, KERB_TO_M, STATIC_STEP_M)
    headings = [spine.heading_at(float(s)) - 0.5 * math.pi for s in places]
    points = np.array([spine.at(float(s)) for s in places])
    return points + 0.5 * width * np.column_stack((np.cos(headings), np.sin(headings)))


def _filled(body: Footprint) -> Array:
    """Return points all over a body, shape (k, 2), m."""
    front_left, rear_left, _, front_right = body.corners()
    along, across = (np.linspace(0.0, 1.0, round(size / STATIC_STEP_M) + 1) for size in (body.length, body.width))
    u, w = (share.reshape(-1, 1) for share in np.meshgrid(along, across))
    return np.asarray(front_left + u * (rear_left - front_left) + w * (front_right - front_left))


def _valley_map(figure: Figure, axes: Axes, scene: ValleyScene) -> None:
    """Draw U₁ of F as filled contours with C on the floor, the obstacles, the roads and the car."""
    _map_axes(axes, VALLEY_WINDOW)
    bitmap = scene.with_static
    side = np.arange(bitmap.bitmaps.shape[1]) * bitmap.cell
    x, y = bitmap.x0 + side, bitmap.y0 + side
    image = axes.contourf(x, y, bitmap.bitmaps[0], levels=VALLEY_LEVELS, cmap=TINT, extend="max", zorder=GROUND)
    axes.contour(x, y, bitmap.bitmaps[0], levels=VALLEY_LEVELS[1:], colors="white", linewidths=0.5 * THIN, zorder=ROAD)
    axes.plot(scene.curve.x, scene.curve.y, color=INK, lw=MEDIUM, ls="-.", zorder=LINES)
    _roads(axes, scene.graph)
    axes.plot(*scene.kerb.T, color=OTHER, lw=BOLD, zorder=BODIES)
    _body(axes, scene.parked, OTHER, opaque=True)
    _car_on_curve(axes, scene.curve)
    _valley_names(axes, scene)
    axes.set_title(r"$U_1$ of the control point $F$: the floor lies on $C$")
    bar = figure.colorbar(image, cax=axes.inset_axes(BAR_PLACE), ticks=VALLEY_LEVELS, format="%g")
    bar.set_label(r"$U_1=\alpha\,d_1(F,C)+\beta\,d_1(F,C)\,/\,\min_{o\in O_S}\,d_1(F,o)$")


def _car_on_curve(axes: Axes, curve: Curve) -> None:
    """Draw M with its front axle on C."""
    x, y, heading = curve.at(CAR_AT_M)
    _body(axes, _footprint(_behind((x, y), heading, CAR.wheelbase)), INK, opaque=True)
    axes.plot(x, y, "o", color=INK, zorder=MARKS)
    _label(axes, (x, y), r"$F$", "s")
    _label(axes, _beside(curve, CAR_AT_M - 0.5 * CAR.wheelbase, 0.5 * CAR.width), r"$M$", "w", boxed=True)


def _valley_names(axes: Axes, scene: ValleyScene) -> None:
    """Write what is what, and draw the line of the section."""
    ends = np.array([_beside(scene.curve, PARKED_AT_M, d) for d in (-SECTION_REACH_M, SECTION_REACH_M)])
    axes.plot(*ends.T, color=INK, lw=BOLD, ls=":", zorder=MARKS)
    _label(axes, _corner(scene.parked, "ne"), r"parked car, $O_S$", "ne", OTHER, boxed=True)
    _label(axes, (scene.kerb[0, 0], float(scene.kerb[:, 1].mean())), r"kerb, $O_S$", "e", OTHER, boxed=True)
    _label(axes, (ends[1, 0], ends[1, 1]), "section", "s", boxed=True)
    _label(axes, scene.curve.at(NAME_AT_M)[:2], r"$C$", "ne", boxed=True)


def _roads(axes: Axes, graph: RoadGraph) -> None:
    """Draw the outline of all roads together."""
    _region(axes, _ground(graph), facecolor="none", edgecolor=GREY, lw=MEDIUM, zorder=FIELD)


def _ground(graph: RoadGraph) -> shapely.Geometry:
    """Return the area of all roads together."""
    spines = [(shapely.LineString(lane.spine.points), 0.5 * lane.width) for lane in graph.lanes.values()]
    bands = [spine.buffer(half, cap_style="flat") for spine, half in spines]
    junctions = [shapely.Polygon(junction.outline) for junction in graph.junctions.values()]
    return shapely.union_all([shape.buffer(SEAM_M) for shape in (*bands, *junctions)])


def _valley_section(axes: Axes, scene: ValleyScene) -> None:
    """Draw U₁ of F across the lane beside the parked car, with and without O_S."""
    across = np.linspace(-SECTION_REACH_M, SECTION_REACH_M, SECTION_SAMPLES)
    places = [_beside(scene.curve, PARKED_AT_M, float(d)) for d in across]
    for bitmap, style, name in ((scene.with_static, INK_LINE, r"with $O_S$"), (scene.without, GREY_LINE, r"without $O_S$")):
        u = [map_potential(bitmap.bitmaps[0], x, y, bitmap.x0, bitmap.y0, bitmap.cell) for x, y in places]
        axes.plot(across, u, label=name, zorder=LINES, **style)
    nearest = -(0.5 * CAR.width + PARKED_ROOM_M)
    axes.axvspan(nearest - CAR.width, nearest, color=OTHER, alpha=BODY_ALPHA, lw=0.0, zorder=GROUND)
    axes.axvspan(-0.5 * CAR.width, 0.5 * CAR.width, color=INK, alpha=GHOST_ALPHA, lw=0.0, zorder=GROUND)
    axes.axvline(0.0, color=INK, lw=THIN, ls="-.", zorder=ROAD)
    axes.set(xlim=(SECTION_REACH_M, -SECTION_REACH_M), ylim=(0.0, SECTION_TOP), ylabel="$U_1$")
    axes.set_xlabel("distance of $F$ from $C$, left positive (m)")
    axes.set_title("section beside the parked car, seen along $C$")
    _label(axes, (0.0, SECTION_TOP), "$M$ on $C$", "s", boxed=True)
    _label(axes, (nearest - 0.5 * CAR.width, 0.0), "parked car", "n", OTHER)
    axes.legend(loc="center left", frameon=False)


# --- figure 4 ---------------------------------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Shot:
    """A step of the experiment: what was recorded, P as it then was, and the size of M."""

    scene: Scene
    plan: NominalPlan
    limits: VehicleLimits

    @property
    def step(self) -> StepRecord:
        """The ego's record."""
        return self.scene.step

    @property
    def body(self) -> Footprint:
        """The ground under M."""
        return Footprint(self.step.x, self.step.y, self.step.heading, self.limits.length, self.limits.width)

    @property
    def front_axle(self) -> Point:
        """F."""
        back = self.limits.front_overhang
        return self.step.x - back * math.cos(self.step.heading), self.step.y - back * math.sin(self.step.heading)

    @property
    def others(self) -> tuple[RoadUser, ...]:
        """Everybody else; a stand-in of M is nobody."""
        return tuple(user for user in self.scene.users if not user.id.startswith(GHOST))

    @property
    def weights(self) -> Weights:
        """w₁, w₂, w₃ of the instruction in force."""
        return TUNINGS[Instruction(self.step.instruction)].weights

    def window(self, around: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
        """Return the ground shown (x from, x to, y from, y to, m)."""
        x, y = self.step.x, self.step.y
        return x + around[0], x + around[1], y + around[2], y + around[3]


def figure4(out: Path) -> Path:
    """Draw four moments of the paper's experiment, and U beneath each (F&L 1991, §4, figure 4)."""
    shots, graph = _experiment()
    passed, moments = _moments(shots, graph)
    heights = [window[3] - window[2] for window in WINDOWS[::2] for _ in (0, 1)]
    figure, grid = plt.subplots(4, 2, figsize=EXPERIMENT_SIZE_IN, height_ratios=heights, layout="compressed")
    for k, (index, around) in enumerate(zip(moments, WINDOWS, strict=True)):
        above, below = grid[2 * (k // 2) : 2 * (k // 2) + 2, k % 2]
        for axes in (above, below):
            _map_axes(axes, shots[index].window(around))
            axes.yaxis.set_major_locator(MaxNLocator(Y_TICKS, integer=True, steps=TICK_STEPS))
        above.set_xlabel("")
        _snapshot(above, shots[: index + 1], graph, passed)
        above.set_title(_headline(k + 1, shots[index].step))
        image = _field(below, shots[index], graph, passed)
    _experiment_keys(figure, grid, image, {state.occupancy for k in moments for state in shots[k].step.regions})
    return _save(figure, out / "figure4.png")


def _experiment() -> tuple[list[Shot], RoadGraph]:
    """Drive the scenario; return every step with the plan then in force, and the world."""
    shots: list[Shot] = []

    class ShownTrip(Trip):
        """A trip that shows its plan, which no record holds."""

        def scene(self) -> Scene:
            scene = super().scene()
            shots.append(Shot(scene, self._driving.drive.plan, self.limits))
            return scene

    with patch.object(simulation, "Trip", ShownTrip):
        result = simulation.run_trial(load_scenario(EXPERIMENT))
    if result.exit_code:
        raise SystemExit(f"{EXPERIMENT.name}: {result.verdict}; no figure of that")
    world = shots[0].scene.world
    assert world is not None
    return shots, world


def _moments(shots: list[Shot], graph: RoadGraph) -> tuple[str, list[int]]:
    """Return who is overtaken, and the steps: pulling out, past him, waiting for priority, inside the intersection."""
    overtaking = [k for k, shot in enumerate(shots) if shot.step.instruction == Instruction.OVERTAKE.value]
    first = _first(overtaking, "overtakes", lambda k: shots[k].plan.aside is not None)
    aside = shots[first].plan.aside
    assert aside is not None
    spine = graph.lanes[shots[first].plan.segments[0].lane_id].spine
    out = _first(overtaking, "pulls out", lambda k: spine.project(*shots[k].front_axle)[1] >= OUT_SHARE * aside.lateral)
    past = _first(overtaking, "passes", lambda k: _lead(shots[k], aside.user_id) >= 0.5 * shots[k].limits.length)
    later = range(past, len(shots))
    waits = _first(
        later, "waits", lambda k: shots[k].step.speed < STANDING_SPEED and _count(shots[k], Occupancy.OCCUPIED) > 0
    )
    crosses = max(range(waits, len(shots)), key=lambda k: _count(shots[k], Occupancy.OWN))
    return aside.user_id, [out, past, waits, crosses]


def _first(steps: Iterable[int], what: str, holds: Callable[[int], bool]) -> int:
    """Return the first of `steps` of which this holds."""
    found = next((k for k in steps if holds(k)), None)
    if found is None:
        raise SystemExit(f"{EXPERIMENT.name}: the ego never {what}")
    return found


def _lead(shot: Shot, user_id: str) -> float:
    """Return how far the front of M is ahead of that of another, m; −∞ if he is not in sight."""
    x, y = shot.step.x, shot.step.y
    users = [user for user in shot.others if user.id == user_id]
    return max(((x - u.x) * math.cos(u.heading) + (y - u.y) * math.sin(u.heading) for u in users), default=-math.inf)


def _count(shot: Shot, occupancy: Occupancy) -> int:
    """Return how many conflict regions on the way are in this state."""
    return sum(state.occupancy is occupancy for state in shot.step.regions)


def _headline(number: int, step: StepRecord) -> str:
    """Return the title of a snapshot."""
    return rf"$\mathbf{{\#{number}}}$  at {step.time:.1f} s,  $v$ = {step.speed:.1f} m/s" + (
        f"\n{step.behaviour}, “{step.instruction}”"
    )


def _snapshot(axes: Axes, shots: list[Shot], graph: RoadGraph, passed: str) -> None:
    """Draw road, regions in their states, everybody with his velocity, C, and the trace of M, as of the last shot."""
    shot = shots[-1]
    _carriageway(axes, graph)
    _region_states(axes, shot, graph)
    _vehicles(axes, shot, passed, moving=True)
    curve = shot.plan.curve
    here, _ = project_on_curve(*shot.front_axle, curve.x, curve.y, curve.step, shot.step.s, FIELD_GUESS_M)
    ahead = np.arange(len(curve.x)) * curve.step >= here
    axes.plot(curve.x[ahead], curve.y[ahead], color=INK, lw=MEDIUM, ls="-.", zorder=LINES)
    _trace(axes, shots)
    _aims(axes, shot)


def _carriageway(axes: Axes, graph: RoadGraph) -> None:
    """Draw the ground of the roads and the borders of their lanes."""
    for lane in graph.lanes.values():
        if not lane.is_internal:
            band = shapely.LineString(lane.spine.points).buffer(0.5 * lane.width, cap_style="flat")
            _region(axes, band, facecolor="none", edgecolor=PALE, lw=THIN, zorder=ROAD)
    _roads(axes, graph)


def _region_states(axes: Axes, shot: Shot, graph: RoadGraph) -> None:
    """Draw the conflict regions on the way, those in one state as one area."""
    polygons = {region.id: shapely.Polygon(region.polygon) for region in graph.regions.values()}
    for occupancy, style in STATE_STYLES.items():
        mine = [polygons[state.region] for state in shot.step.regions if state.occupancy is occupancy]
        for part in shapely.get_parts(shapely.union_all(mine)):
            _region(axes, part, zorder=FIELD, **style)


def _vehicles(axes: Axes, shot: Shot, passed: str, *, moving: bool) -> None:
    """Draw M, X and the others; `moving`: with their velocities and names."""
    window = shapely.box(*np.array((axes.get_xlim(), axes.get_ylim())).T.ravel())
    step, length, width = shot.step, shot.limits.length, shot.limits.width
    cars = [(step.x, step.y, step.heading, step.speed, length, width, INK, "$M$")]
    for u in shot.others:
        colour, name = (OTHER, "$X$") if u.id == passed else (GREY, "$D$")
        cars.append((u.x, u.y, u.heading, u.speed, u.body.length, u.body.width, colour, name))
    for x, y, heading, speed, length, width, colour, name in cars:
        body = Footprint(x, y, heading, length, width)
        if not window.intersects(shapely.Polygon(body.corners())):
            continue
        _body(axes, body, colour, opaque=True)
        if moving:
            _moving(axes, body, speed, colour, name)


def _moving(axes: Axes, body: Footprint, speed: float, colour: str, name: str) -> None:
    """Draw the velocity of a car at its front, and write its name beside it."""
    if speed >= STANDING_SPEED:
        way = VELOCITY_S * speed
        _arrow(axes, (body.x, body.y), (way * math.cos(body.heading), way * math.sin(body.heading)), colour)
    front_left, rear_left, rear_right, front_right = body.corners()
    if name == "$X$":
        _label(axes, _between(front_right, rear_right), name, "s", colour, boxed=True)
    elif name == "$M$":
        _label(axes, _between(front_left, rear_left), name, "n", colour, boxed=True)
    else:
        _label(axes, (rear_left[0], rear_left[1]), name, "w" if math.sin(body.heading) > 0.0 else "e", colour)


def _trace(axes: Axes, shots: list[Shot]) -> None:
    """Draw where F has been, with a dot each second."""
    trace = np.array([shot.front_axle for shot in shots])
    axes.plot(*trace.T, color=INK, lw=MEDIUM, zorder=LINES)
    ages = np.array([shots[-1].step.time - shot.step.time for shot in shots])
    full = np.abs(ages / TRACE_DOT_S - np.round(ages / TRACE_DOT_S)) < 1e-6
    axes.plot(*trace[full & (ages > 0.0)].T, ".", color=INK, zorder=LINES)


def _aims(axes: Axes, shot: Shot) -> None:
    """Draw the direction of g, and the place to stop at if there is one."""
    plan_now, step = shot.plan, shot.step
    if plan_now.goal is not None:
        x, y, _ = plan_now.curve.at(plan_now.goal)
        tail = (axes.get_xlim()[1] - GOAL_INSET_M, y - GOAL_BESIDE_M)
        _label(axes, _arrow(axes, tail, (GOAL_ARROW_M, 0.0), INK), "$g$", "e")
    if not math.isnan(step.stop_s):
        x, y, heading = plan_now.curve.at(step.stop_s)
        ends = [(x - d * math.sin(heading), y + d * math.cos(heading)) for d in (-STOP_BAR_M, STOP_BAR_M)]
        axes.plot(*zip(*ends, strict=True), color=OTHER, lw=BOLD, zorder=MARKS)


def _field(axes: Axes, shot: Shot, graph: RoadGraph, passed: str) -> ContourSet:
    """Draw w₁U₁ + w₂U₂ over the places of M's middle, with the vehicles over it; contact in grey."""
    x, y = _grid((*axes.get_xlim(), *axes.get_ylim()), FIELD_CELL_M)
    values = _potentials(shot, graph, x, y)
    ground = Polygon(np.array(_ground(graph).exterior.coords), facecolor=PALE, zorder=GROUND)
    axes.add_patch(ground)
    image = axes.contourf(x, y, values, levels=FIELD_LEVELS, norm=_field_norm(), cmap=TINT, extend="max", zorder=ROAD)
    image.set_clip_path(ground)
    axes.plot(shot.plan.curve.x, shot.plan.curve.y, color=INK, lw=MEDIUM, ls="-.", zorder=LINES)
    _roads(axes, graph)
    _vehicles(axes, shot, passed, moving=False)
    w = shot.weights
    axes.set_title(
        rf"$w_1$ = {w.valley:g},  $w_2$ = {w.shadow:g};  not shown: "
        rf"$w_3U_3=|v-v_d|$,  $v_d$ = {shot.step.desired_speed:.1f} m/s"
    )
    return image


def _field_norm() -> BoundaryNorm:
    """Return the steps of colour: even for each level, so about logarithmic."""
    return BoundaryNorm(FIELD_LEVELS, TINT.N, extend="max")


def _potentials(shot: Shot, graph: RoadGraph, x: Array, y: Array) -> Array:
    """Return w₁U₁ + w₂U₂ for M's middle at each place of the grid, shape (len(y), len(x)); contact is masked."""
    users = [(u.x, u.y, u.heading, u.speed, u.body.length, u.body.width) for u in shot.others]
    boxes = np.array(users, dtype=np.float64).reshape(-1, 6)
    step, front = shot.step, (shot.step.x, shot.step.y)
    static = static_within(graph, shot.plan, "passenger", front, FIELD_STATIC_M)
    ground = Ground(shot.plan.curve, step.s or 0.0, front, boxes, static, step.speed, shot.weights, shot.limits)
    places = np.meshgrid(x, y)
    values = ground.potentials(places[0].ravel(), places[1].ravel()).reshape(len(y), len(x))
    return np.ma.masked_invalid(values)


def _experiment_keys(figure: Figure, grid: Any, image: ContourSet, seen: set[Occupancy]) -> None:
    """Say what lines and colours mean, of the regions' states those that are seen."""
    place: dict[str, Any] = {"ax": grid, "location": "bottom", "shrink": 0.6, "aspect": 50, "pad": 0.02}
    bar = figure.colorbar(image, ticks=FIELD_LEVELS, format="%g", **place)
    bar.set_label("$w_1U_1+w_2U_2$ with the middle of $M$ here, headed along $C$ at the speed $v$ above (grey: contact)")
    lines = [
        Line2D([], [], color=INK, lw=MEDIUM, ls="-.", label="$C$"),
        Line2D([], [], color=INK, lw=MEDIUM, marker=".", label=f"trace of $F$, a dot each {TRACE_DOT_S:g} s"),
        Line2D([], [], color=GREY, lw=BOLD, marker=">", label=f"velocity: way of {VELOCITY_S:g} s"),
        Line2D([], [], color=OTHER, lw=BOLD, label="place to stop at"),
    ]
    areas = [Patch(label=STATE_NAMES[state], **style) for state, style in STATE_STYLES.items() if state in seen]
    cars = [
        Patch(facecolor=mpl.colors.to_rgba(colour, BODY_ALPHA), edgecolor=colour, lw=MEDIUM, label=name)
        for name, colour in (("$M$", INK), ("$X$, overtaken", OTHER), ("$D$, crossing", GREY))
    ]
    figure.legend(handles=[*cars, *areas, *lines], loc="outside upper center", ncols=4, frameon=False)


# --- parts of every figure --------------------------------------------------------------------------------------------
def _map_axes(axes: Axes, window: tuple[float, float, float, float]) -> None:
    """Show this part of the ground (x from, x to, y from, y to, m) in true proportion."""
    axes.set(xlim=window[:2], ylim=window[2:], xlabel="$x$ (m)", ylabel="$y$ (m)", aspect="equal")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(integer=True, steps=TICK_STEPS))
    axes.spines[["top", "right"]].set_visible(False)


def _save(figure: Figure, path: Path) -> Path:
    """Write the figure without anything that differs between two runs."""
    figure.savefig(path, metadata={"Software": None})
    plt.close(figure)
    return path


def _in_world(pose: Pose, ahead: float, left: float) -> Point:
    """Return the place `ahead` m before and `left` m beside the rear axle's midpoint."""
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    return pose.x + ahead * c - left * s, pose.y + ahead * s + left * c


def _front_axle(pose: Pose) -> Point:
    """Return F of a car at q."""
    return _in_world(pose, CAR.wheelbase, 0.0)


def _behind(place: Point, heading: float, way: float) -> Pose:
    """Return q of a car whose rear axle is `way` m behind a place."""
    return Pose(*_in_world(Pose(*place, heading), -way, 0.0), heading)


def _footprint(pose: Pose) -> Footprint:
    """Return the body of a car at q."""
    return Footprint(*_in_world(pose, CAR.front_to_rear_axle, 0.0), pose.heading, CAR.length, CAR.width)


def _centred(centre: Point, heading: float) -> Footprint:
    """Return a car's body around `centre`."""
    front = _in_world(Pose(*centre, heading), 0.5 * CAR.length, 0.0)
    return Footprint(*front, heading, CAR.length, CAR.width)


def _corner(body: Footprint, side: str) -> Point:
    """Return the corner of a body that lies farthest to this side of the compass."""
    corners = body.corners()
    x, y = corners[int(np.argmax(corners @ np.array(COMPASS[side])))]
    return float(x), float(y)


def _grid(window: tuple[float, float, float, float], cell: float) -> tuple[Array, Array]:
    """Return the x and the y of a grid over a window, m."""
    return np.arange(window[0], window[1] + cell, cell), np.arange(window[2], window[3] + cell, cell)


def _body(axes: Axes, body: Footprint, colour: str, *, opaque: bool = False, ghost: bool = False) -> None:
    """Draw a body's outline; `opaque` on white ground, `ghost` dashed."""
    if opaque:
        axes.add_patch(Polygon(body.corners(), facecolor="white", edgecolor="none", zorder=BODIES))
    fill = mpl.colors.to_rgba(colour, GHOST_ALPHA if ghost else BODY_ALPHA)
    dashes = "--" if ghost else "-"
    axes.add_patch(Polygon(body.corners(), facecolor=fill, edgecolor=colour, lw=MEDIUM, ls=dashes, zorder=BODIES))


def _region(axes: Axes, region: shapely.Geometry, **style: Any) -> None:
    """Draw the outline of a polygon, and what `style` says of its inside."""
    if not region.is_empty:
        axes.add_patch(Polygon(np.array(region.exterior.coords), **style))


def _between(first: Point | Array, last: Point | Array) -> Point:
    """Return the middle of two places."""
    return 0.5 * float(first[0] + last[0]), 0.5 * float(first[1] + last[1])


def _arrow(axes: Axes, tail: Point, way: Point | Array, colour: str) -> Point:
    """Draw an arrow of `way` m; return its tip."""
    tip = (tail[0] + float(way[0]), tail[1] + float(way[1]))
    style = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0, "mutation_scale": SYMBOL_PT, "lw": BOLD}
    axes.annotate("", tip, tail, arrowprops=style, zorder=MARKS)
    return tip


def _measure(axes: Axes, first: Point, last: Point, colour: str) -> None:
    """Draw a line that ends in an arrow on both sides."""
    style = {"arrowstyle": "<->", "color": colour, "lw": MEDIUM, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", last, first, arrowprops=style, zorder=MARKS)


def _degrees(angle: float) -> str:
    """Return an angle (rad) as text."""
    return f"{math.degrees(angle):.0f}°"


def _angle(axes: Axes, at: Point, radius: float, first: float, last: float, name: str) -> None:
    """Draw the arc of an angle (rad) and its name in the middle."""
    span = (math.degrees(first), math.degrees(last))
    axes.add_patch(Arc(at, 2.0 * radius, 2.0 * radius, theta1=span[0], theta2=span[1], color=OTHER, lw=MEDIUM, zorder=MARKS))
    middle = 0.5 * (first + last)
    _label(axes, (at[0] + radius * math.cos(middle), at[1] + radius * math.sin(middle)), name, "e", OTHER)


def _label(axes: Axes, at: Point, text: str, side: str, colour: str = INK, *, boxed: bool = False) -> None:
    """Write a symbol or words on this side of a place; `boxed` on white ground."""
    dx, dy = COMPASS[side]
    box = {"facecolor": "white", "edgecolor": "none", "pad": BOX_PAD_PT, "alpha": BOX_ALPHA} if boxed else None
    is_symbol = text[0] == text[-1] == "$" and text.count("$") == 2
    axes.annotate(
        text, at, xytext=(dx * LABEL_GAP_PT, dy * LABEL_GAP_PT), textcoords="offset points", color=colour,
        ha=("center", "left", "right")[dx], va=("center", "bottom", "top")[dy], bbox=box, zorder=MARKS,
        size=SYMBOL_PT if is_symbol else WORDS_PT,
    )  # fmt: skip


FIGURES: dict[str, Callable[[Path], Path]] = {"model": model, "shadow": shadow, "valley": valley, "figure4": figure4}

if __name__ == "__main__":
    main()
