"""Parts of the map worth a button: the whole trip, and each place at which the ego did more than drive along."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from html import escape
from itertools import groupby
from typing import NamedTuple

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.show.frame.page import Html
from sumo_reactive.show.run.steps import Band, Steps

NAME = "map"
"""The figure's name on the page."""

MARGIN_M = 25.0
"""Left around what a view shows, m."""

MOST_VIEWS = 12
"""So many places have a button."""


class View(NamedTuple):
    """A part of the map: what it shows, and its limits (low, high) in x and y, m."""

    label: str
    x: tuple[float, float]
    y: tuple[float, float]


def views_of(steps: Steps, bands: Sequence[Band]) -> list[View]:
    """Return the whole trip, and the places at which the ego did something else than normal driving.

    What was cautious driving before something or after it belongs to that.
    """
    found = [_view("whole trip", steps, 0, len(steps.times) - 1)]
    for is_normal, inside in groupby(bands, key=lambda band: band.behaviour is Behaviour.NORMAL):
        together = list(inside)
        busy = [band for band in together if band.behaviour is not Behaviour.CAUTIOUS] or together
        if not is_normal:
            label = f"{busy[0].behaviour.value}, {busy[0].start:.1f} s"
            found.append(_view(label, steps, busy[0].first, busy[-1].last))
    return found[: MOST_VIEWS + 1]


def buttons_of(views: Iterable[View]) -> Html:
    """Return a button for each view."""
    told = "".join(
        f"<button data-plot=\"plot-{NAME}\" data-view='{json.dumps({'xaxis.range': view.x, 'yaxis.range': view.y})}'>"
        f"{escape(view.label)}</button>"
        for view in views
    )
    return Html(f'<div class="views">{told}</div>')


def _view(label: str, steps: Steps, first: int, last: int) -> View:
    xs, ys = steps["x_m"][first : last + 1], steps["y_m"][first : last + 1]
    return View(label, (min(xs) - MARGIN_M, max(xs) + MARGIN_M), (min(ys) - MARGIN_M, max(ys) + MARGIN_M))
