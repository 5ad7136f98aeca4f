"""A moment of a recorded run, drawn in the style of the paper's figure 4: a figure that can be moved to another moment."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from matplotlib.ticker import MaxNLocator

from sumo_reactive.driver.geometry.footprint import Footprint
from sumo_reactive.driver.nouns.decision import Occupancy
from sumo_reactive.lab.trace import Entry
from sumo_reactive.show.page import behaviour_colour, behaviour_name
from sumo_reactive.show.recording import CLOSE_S, Recording, Steps, read_steps
from sumo_reactive.show.run_map import RoadMap, roads_of
from sumo_reactive.show.run_timeline import spans_of
from sumo_reactive.writing import whole_file

CAR_LENGTH_M, CAR_WIDTH_M, CAR_OVERHANG_M = 4.7, 1.8, 0.9
"""A usual car's length, width, and front bumper before front axle, where a record does not hold the ego's own."""

SIZE_NOTE = f"the record does not hold the size of the ego: drawn as a car of {CAR_LENGTH_M:g} × {CAR_WIDTH_M:g} m"
FIELD_NOTE = "drawn is U of the chosen command over time; the run's page shows U over the commands at each decision"

INK, OTHER, GREY, PALE, GROUND = "#1f3b5c", "#b5482a", "#6b7178", "#c3c8ce", "#eef0f2"
"""The ego and what belongs to it; others; what helps to read; borders of lanes; roads."""

STYLE: dict[Any, Any] = {
    "font.size": 10.0, "axes.titlesize": 10.0, "axes.edgecolor": GREY, "axes.linewidth": 0.7, "axes.titlelocation": "left",
    "xtick.color": GREY, "ytick.color": GREY, "xtick.labelsize": 9.0, "ytick.labelsize": 9.0, "legend.fontsize": 9.0,
    "hatch.linewidth": 0.5, "pdf.fonttype": 42, "svg.fonttype": "path", "svg.hashsalt": "sumo_reactive",
    "savefig.dpi": 150.0,
}  # fmt: skip
"""Fonts are embedded in a PDF and drawn as outlines in an SVG; the same record gives the same bytes."""

_METADATA = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
"""What would differ between two drawings of the same, by format."""

FORMATS = tuple(_METADATA)

_THIN, _MEDIUM, _BOLD = 0.8, 1.3, 2.2
_Y_TICKS = 5
_AHEAD_SHARE, _MAP_RATIO = 0.5, 3.1
"""How far the ego stands behind the middle of the map, and the map's width by its height."""

_TIME_S, _SPEED_ROOM = 15.0, 1.15
"""Time shown before and after the moment; the axis of speed reaches this much beyond the highest."""

_BAR_M, _LABEL_GAP_PT, _LINES_MOST = 1.8, 10.0, 2
"""Half the bar where the ego is to stop, from a leader's place to his name, reasons told at most."""

_NAMED_S, _NAME_PT = 3.0, 8.0
"""What the ego did for so long is named in words, so large."""

_SIZE_IN, _FIELD_HEIGHT_IN = (9.0, 6.0), 1.7
_TOP_IN, _BOTTOM_IN, _LEFT, _RIGHT = 1.15, 0.55, 0.075, 0.985
"""What is left free above and below (inches), and at the sides (shares of the width)."""

_BETWEEN, _RATIOS, _FIELD_RATIO = 0.42, [3.4, 1.2], 1.2
"""Room between map and axes of time (shares of their mean height), and their heights beside each other."""

_REGION_STYLES: dict[Occupancy, dict[str, Any]] = {
    Occupancy.FREE: {"facecolor": "white", "edgecolor": GREY, "hatch": "", "zorder": 2.0},
    Occupancy.OWN: {"facecolor": "#9fb6cd", "edgecolor": INK, "hatch": "", "zorder": 2.1},
    Occupancy.CLAIMED: {"facecolor": "white", "edgecolor": OTHER, "hatch": "////", "zorder": 2.2},
    Occupancy.OCCUPIED: {"facecolor": "#dfa795", "edgecolor": OTHER, "hatch": "xxxx", "zorder": 2.3},
}
"""How a region looks in each state; hatches tell them apart without colour, later ones lie over earlier ones."""

_REGION_NAMES = {
    Occupancy.FREE: "region free", Occupancy.OWN: "region held by the ego", Occupancy.CLAIMED: "region claimed by another",
    Occupancy.OCCUPIED: "region occupied",
}  # fmt: skip
_POTENTIALS = {
    "u": ("$U=w_1U_1+w_2U_2+w_3U_3$", GREY, "-", 3.0), "u1": ("$U_1$ (valley of $C$)", INK, "-", _MEDIUM),
    "u2": ("$U_2$ (moving obstacles)", OTHER, "--", _MEDIUM), "u3": ("$U_3$ (speed)", "#0b7a4b", ":", _BOLD),
}  # fmt: skip


class Shown(NamedTuple):
    """What a drawing shows of a run: the map's height (m), its resolution (dots an inch), whether U is drawn, too."""

    height: float = 20.0
    dpi: float = 150.0
    has_field: bool = False


@contextmanager
def drawn_in_style() -> Iterator[None]:
    """Draw without a window, and leave what others draw as it is."""
    with mpl.rc_context(STYLE):
        yield


class RunDrawing:
    """The figure of a run; `show` moves it to a step. Raises ScenarioError for a record that lacks what is drawn."""

    def __init__(self, recording: Recording, shown: Shown) -> None:
        self.steps = steps = read_steps(recording)
        self._recording, self._half = recording, 0.5 * shown.height
        size = recording.summary.get("length_m"), recording.summary.get("width_m")
        self._length, self._width = size[0] or CAR_LENGTH_M, size[1] or CAR_WIDTH_M
        self._has_size = None not in size
        self._times = [entry.time for entry in recording.entries]
        track = [*zip(steps["x_m"], steps["y_m"], strict=True)]
        self._track = np.array(track)
        self._way = np.array([*accumulate((math.dist(*two) for two in pairwise(track)), initial=0.0)])
        height = _SIZE_IN[1] + (_FIELD_HEIGHT_IN if shown.has_field else 0.0)
        self.figure = Figure(figsize=(_SIZE_IN[0], height), dpi=shown.dpi)
        FigureCanvasAgg(self.figure)
        ratios = [*_RATIOS, *([_FIELD_RATIO] if shown.has_field else [])]
        sides = {"left": _LEFT, "right": _RIGHT, "top": 1.0 - _TOP_IN / height, "bottom": _BOTTOM_IN / height}
        grid = self.figure.subplots(len(ratios), 1, height_ratios=ratios, gridspec_kw={**sides, "hspace": _BETWEEN})
        self._map, self._over_time = grid[0], [*grid[1:]]
        self.roads = roads_of(recording, steps)
        _draw_roads(self._map, self.roads)
        self._regions = {name: self._region(corners) for name, corners in recording.regions.items()}
        self._add_artists()
        self._cursors = [axes.axvline(0.0, color=INK, lw=_MEDIUM) for axes in self._over_time]
        _draw_speed(self._over_time[0], steps)
        if shown.has_field:
            _draw_potentials(self._over_time[1], steps)
        self._over_time[-1].set_xlabel("simulation time (s)")
        _add_keys(self.figure)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the record lacks, a line each."""
        missing = [] if self._has_size else [SIZE_NOTE]
        return (*missing, *([f"drawn without the roads: {self.roads.missing}"] if self.roads.missing else []))

    def _region(self, corners: Sequence[Sequence[float]]) -> Polygon:
        patch = Polygon(np.asarray(corners, dtype=float), lw=_THIN, zorder=2, visible=False)
        self._map.add_patch(patch)
        return patch

    def _add_artists(self) -> None:
        """Make what moves from moment to moment."""
        axes = self._map
        (self._driven,) = axes.plot([], [], color=INK, lw=_MEDIUM, zorder=3)
        (self._ahead,) = axes.plot([], [], color=INK, lw=_MEDIUM, ls="-.", zorder=3)
        (self._stop,) = axes.plot([], [], color=OTHER, lw=_BOLD, zorder=5)
        (self._gap,) = axes.plot([], [], color=OTHER, lw=_MEDIUM, ls=":", marker="|", ms=9, mew=_BOLD, zorder=5)
        aside = {"xytext": (0.0, _LABEL_GAP_PT), "textcoords": "offset points"}
        self._leader = axes.annotate("", (0.0, 0.0), **aside, color=OTHER, zorder=6)
        box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0}
        self._leader.set(ha="center", annotation_clip=True, bbox=box)
        self._body = Polygon(np.zeros((4, 2)), facecolor="white", edgecolor=INK, lw=_BOLD, zorder=4)
        axes.add_patch(self._body)
        axes.set(xlabel="$x$ (m)", ylabel="$y$ (m)", aspect="equal", adjustable="box")
        axes.yaxis.set_major_locator(MaxNLocator(_Y_TICKS, integer=True))
        axes.spines[["top", "right"]].set_visible(False)

    def show(self, k: int) -> None:
        """Move the figure to step `k`."""
        steps, (x, y) = self.steps, self._track[k]
        heading = steps["heading_rad"][k]
        self._body.set_xy(Footprint(x, y, heading, self._length, self._width).corners())
        self._body.set_facecolor(mpl.colors.to_rgba(behaviour_colour(steps.behaviour(k)), 0.55))
        self._driven.set_data(*self._track[: k + 1].T)
        self._ahead.set_data(*self._track[k:].T)
        self._show_stop(k)
        self._show_leader(k)
        self._show_regions(self._entry_at(steps.times[k]))
        ahead = _AHEAD_SHARE * self._half
        self._show_window(x + ahead * math.cos(heading), y + ahead * math.sin(heading))
        for axes, cursor in zip(self._over_time, self._cursors, strict=True):
            cursor.set_xdata([steps.times[k], steps.times[k]])
            axes.set_xlim(steps.times[k] - _TIME_S, steps.times[k] + _TIME_S)
        entry = self._entry_at(steps.times[k])
        what = f"{steps.times[k]:.1f} s, {steps['speed_m_s'][k]:.1f} m/s: {behaviour_name(steps.behaviour(k))}"
        self._map.set_title("\n".join([what + (f", “{entry.instruction.value}”" if entry else ""), *_reasons(entry)]))

    def _entry_at(self, time: float) -> Entry | None:
        """Return what was in force at a time (s)."""
        found = [entry for entry, when in zip(self._recording.entries, self._times, strict=True) if when <= time + CLOSE_S]
        return found[-1] if found else None

    def _place(self, k: int, ahead: float) -> tuple[float, float, float] | None:
        """Return x, y and heading of the way that was driven `ahead` m after step `k`; None where it ends before."""
        wanted = self._way[k] + ahead
        if not 0.0 <= wanted <= self._way[-1]:
            return None
        at = min(int(np.searchsorted(self._way, wanted)), len(self._way) - 1)
        x, y = (float(np.interp(wanted, self._way, column)) for column in self._track.T)
        return x, y, self.steps["heading_rad"][at]

    def _show_stop(self, k: int) -> None:
        stop, s = self.steps["stop_m"][k], self.steps["s_m"][k]
        place = None if stop is None or s is None else self._place(k, stop - s - CAR_OVERHANG_M)
        self._stop.set_visible(place is not None)
        if place is not None:
            x, y, heading = place
            self._stop.set_data(*zip(*((x - d * math.sin(heading), y + d * math.cos(heading)) for d in (-_BAR_M, _BAR_M)),
                                     strict=True))  # fmt: skip

    def _show_leader(self, k: int) -> None:
        gap, name = self.steps["gap_m"][k], self.steps["leader"][k]
        place = None if gap is None or not name else self._place(k, gap)
        for artist in (self._gap, self._leader):
            artist.set_visible(place is not None)
        if place is not None:
            first, last = (int(np.searchsorted(self._way, self._way[k] + way)) for way in (0.0, gap or 0.0))
            between = self._track[first + 1 : last]
            self._gap.set_data(*np.vstack([self._track[k], between, place[:2]]).T)
            self._gap.set_markevery([-1])
            self._leader.xy = place[:2]
            self._leader.set_text(f"{name}, {gap:.1f} m ahead")

    def _show_regions(self, entry: Entry | None) -> None:
        states = {state.region: state.occupancy for state in entry.regions} if entry else {}
        for name, patch in self._regions.items():
            patch.set_visible(name in states)
            if name in states:
                patch.set(**_REGION_STYLES[states[name]])

    def _show_window(self, x: float, y: float) -> None:
        self._map.set_xlim(x - self._half * _MAP_RATIO, x + self._half * _MAP_RATIO)
        self._map.set_ylim(y - self._half, y + self._half)


def save_figure(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the file's name ends with, whole or not at all; raise OutputError."""
    form = path.suffix.lower().removeprefix(".")
    with whole_file(path) as partial:
        figure.savefig(partial, format=form, metadata=_METADATA[form])


def _reasons(entry: Entry | None) -> list[str]:
    """Return the first reasons of what is done, a line each."""
    told = [f"{one.reason.value}{f' ({one.cause})' if one.cause else ''}" for one in entry.decisions] if entry else []
    return [*dict.fromkeys(told)][:_LINES_MOST]


def _draw_roads(axes: Axes, roads: RoadMap) -> None:
    for areas, line in ((roads.junctions, _THIN), (roads.inside, 0.0), (roads.lanes, _THIN)):
        for corners in areas.values():
            axes.add_patch(Polygon(corners, facecolor=GROUND, edgecolor=PALE if line else "none", lw=line, zorder=1))


def _draw_speed(axes: Axes, steps: Steps) -> None:
    """Draw speed and v_d over time, and what the ego did as a band with its name in words."""
    axes.plot(steps.times, steps["speed_m_s"], color=INK, lw=_MEDIUM, label="speed $v$")
    axes.plot(steps.times, steps["desired_speed_m_s"], color=OTHER, lw=_MEDIUM, ls="--", label="desired speed $v_d$")
    top = _SPEED_ROOM * max(*steps["speed_m_s"], *(speed for speed in steps["desired_speed_m_s"] if speed is not None), 1.0)
    for span in spans_of(steps):
        axes.axvspan(span.start, span.end, color=behaviour_colour(span.behaviour), alpha=0.18, lw=0.0)
        axes.axvline(span.start, color=PALE, lw=_THIN, zorder=0)
        if span.end - span.start >= _NAMED_S:
            named = f" {behaviour_name(span.behaviour)}"
            axes.text(span.start, 0.02 * top, named, size=_NAME_PT, color=GREY, va="bottom", clip_on=True)
    axes.set(ylim=(0.0, top), ylabel="m/s")
    axes.legend(loc="upper right", frameon=False, ncols=2, borderaxespad=0.0, bbox_to_anchor=(1.0, 1.28))


def _draw_potentials(axes: Axes, steps: Steps) -> None:
    for name, (label, colour, dashes, width) in _POTENTIALS.items():
        axes.plot(steps.times, steps[name], color=colour, ls=dashes, lw=width, label=label)
    axes.set(ylabel="potential", yscale="symlog")
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="upper right", frameon=False, ncols=len(_POTENTIALS), borderaxespad=0.0, bbox_to_anchor=(1.0, 1.28))


def _add_keys(figure: Figure) -> None:
    """Say what lines and areas mean, above all."""
    lines = [
        Line2D([], [], color=INK, lw=_MEDIUM, label="way driven (front bumper)"),
        Line2D([], [], color=INK, lw=_MEDIUM, ls="-.", label="way that it then drove"),
        Line2D([], [], color=OTHER, lw=_BOLD, label="place to stop at"),
        Line2D([], [], color=OTHER, lw=_MEDIUM, ls=":", label="gap to the leader"),
    ]
    areas = [Patch(label=_REGION_NAMES[state], lw=_THIN, **style) for state, style in _REGION_STYLES.items()]
    figure.legend(handles=[*lines, *areas], loc="upper center", ncols=4, frameon=False)
