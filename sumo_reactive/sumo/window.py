"""SUMO's own window on a run: each ego coloured by behaviour, with C, its stop, the regions ahead, and why in words."""

from __future__ import annotations

import math
import os
import sys
import time as clock
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

import libsumo
import numpy as np

from sumo_reactive.driver.nouns.decision import Occupancy
from sumo_reactive.driver.nouns.plan import NominalPlan
from sumo_reactive.driver.nouns.record import Scene, StepRecord
from sumo_reactive.errors import ScenarioError

_Colour = tuple[int, int, int, int]
_Place = tuple[float, float]

_VIEW, _ZOOM = "View #0", 1000.0
"""SUMO's name of the first view, and how near it is in the beginning."""

_TYPE = "sumo_reactive"
"""Type of all that is drawn, so that nothing of it is taken for an obstacle."""

_LAYER, _WIDTH_M, _BAR_M, _LABEL_M = 10, 0.3, 1.8, 9.0
"""Above roads and below cars; width of lines; half the bar at a stop; how far beside the ego the label stands."""

_CURVE_STEP_M, _CURVE_M = 2.0, 150.0
"""C is drawn with a corner each so many metres, so far ahead."""

_CURVE_COLOUR, _STOP_COLOUR, _LABEL_COLOUR = (86, 180, 233, 255), (213, 94, 0, 255), (0, 0, 0, 0)
_REGION_COLOURS: Mapping[Occupancy, _Colour] = MappingProxyType({
    Occupancy.FREE: (128, 138, 148, 110), Occupancy.OWN: (0, 114, 178, 140), Occupancy.CLAIMED: (230, 159, 0, 140),
    Occupancy.OCCUPIED: (213, 94, 0, 170),
})  # fmt: skip

SETTINGS = """<viewsettings>
    <scheme name="sumo_reactive">
        <background backgroundColor="white" showGrid="0"/>
        <vehicles vehicleQuality="2" vehicle_minSize="1" vehicle_exaggeration="1"/>
        <pois poi_minSize="0" poi_exaggeration="1" poiName_show="0" poiType_show="1" poiType_size="60"
              poiType_color="black" poiType_constantSize="1" poiType_bgColor="255,255,255,200"/>
    </scheme>
    <viewport x="0" y="0" zoom="1000"/>
</viewsettings>
"""
"""How the window looks: the type of a point of interest is written beside it."""


def window_arguments(settings: Path) -> list[str]:
    """Return what SUMO's program with a window is started with; write how it looks to a file.

    Raises ScenarioError where there is no display: that program would end this process.
    """
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        raise ScenarioError("SUMO's window needs a display: DISPLAY is not set (without a screen: xvfb-run)")
    settings.write_text(SETTINGS, encoding="utf-8")
    return ["sumo-gui", "--start", "--quit-on-end", "--gui-settings-file", str(settings)]


class Window:
    """Draws what is seen of each ego, and keeps pace: `speed` times faster than life. The view follows the first ego."""

    def __init__(self, colours: Mapping[str, str], speed: float) -> None:
        self._colours = {behaviour: _rgba(colour) for behaviour, colour in colours.items()}
        self._speed = speed
        self._drawn: set[str] = set()
        self._followed = ""
        self._due = (-math.inf, 0.0)

    def see(self, scene: Scene) -> None:
        """Draw a step of an ego; wait until it is time for it."""
        step, ego = scene.step, scene.ego
        if step.behaviour in self._colours:
            libsumo.vehicle.setColor(ego, self._colours[step.behaviour])
        if not self._followed:
            self._followed = ego
            libsumo.gui.setZoom(_VIEW, _ZOOM)
            libsumo.gui.trackVehicle(_VIEW, ego)
        self._draw_plan(ego, step, scene.plan)
        self._draw_regions(ego, scene)
        self._draw_label(ego, step)
        if ego == self._followed:
            self._wait(step.time)

    def _draw_plan(self, ego: str, step: StepRecord, plan: NominalPlan | None) -> None:
        """Draw C ahead, and a bar across it where the ego is to stop."""
        if plan is None or step.s is None:
            return
        curve = plan.curve
        end = min(step.s + _CURVE_M, curve.step * (len(curve.x) - 1))
        places = [curve.at(float(s)) for s in np.arange(step.s, end, _CURVE_STEP_M)]
        self._line(f"{ego}.C", [(x, y) for x, y, _ in places], _CURVE_COLOUR)
        bar: list[_Place] = []
        if step.stop_s is not None and not math.isnan(step.stop_s):
            x, y, heading = curve.at(step.stop_s)
            bar = [(x - d * math.sin(heading), y + d * math.cos(heading)) for d in (-_BAR_M, _BAR_M)]
        self._line(f"{ego}.stop", bar, _STOP_COLOUR)

    def _draw_regions(self, ego: str, scene: Scene) -> None:
        states = {state.region: state.occupancy for state in scene.step.regions}
        known = scene.world.regions.values() if scene.world is not None else ()
        for region in known:
            name = f"{ego}.region.{region.id}"
            if region.id not in states:
                self._remove(name)
                continue
            corners = [(float(x), float(y)) for x, y in region.polygon]
            self._polygon(name, corners, _REGION_COLOURS[states[region.id]], is_filled=True)

    def _draw_label(self, ego: str, step: StepRecord) -> None:
        name = f"{_TYPE}.{ego}"
        place = step.x - _LABEL_M * math.sin(step.heading), step.y + _LABEL_M * math.cos(step.heading)
        if name not in self._drawn:
            libsumo.poi.add(name, *place, _LABEL_COLOUR)
            self._drawn.add(name)
        libsumo.poi.setPosition(name, *place)
        libsumo.poi.setType(name, _words(step))

    def _line(self, name: str, places: Sequence[_Place], colour: _Colour) -> None:
        if len(places) < 2:
            self._remove(name)
        else:
            self._polygon(name, places, colour, is_filled=False)

    def _polygon(self, name: str, corners: Sequence[_Place], colour: _Colour, *, is_filled: bool) -> None:
        if name not in self._drawn:
            libsumo.polygon.add(name, corners, colour, is_filled, _TYPE, _LAYER, _WIDTH_M)
            self._drawn.add(name)
        libsumo.polygon.setShape(name, corners)
        libsumo.polygon.setColor(name, colour)

    def _remove(self, name: str) -> None:
        if name in self._drawn:
            libsumo.polygon.remove(name)
            self._drawn.remove(name)

    def _wait(self, time: float) -> None:
        """Sleep until the wall's clock is as far as simulation time (s)."""
        before, due = self._due
        now = clock.monotonic()
        due = max(due + (time - before) / self._speed, now) if math.isfinite(before) else now
        clock.sleep(due - now)
        self._due = time, due


def _words(step: StepRecord) -> str:
    """Say what the ego does and why: the first decision with its cause."""
    why = [f"{one.reason.value}{f' ({one.cause})' if one.cause else ''}" for one in step.decisions[:1]]
    return ": ".join(filter(None, [step.behaviour, *why, step.reason]))


def _rgba(colour: str) -> _Colour:
    red, green, blue = bytes.fromhex(colour.removeprefix("#"))
    return red, green, blue, 255
