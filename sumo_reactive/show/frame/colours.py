"""Colours that are told apart by colour-blind people, too (Okabe and Ito 2008), on light and on dark."""

from __future__ import annotations

from typing import Any

from sumo_reactive.driver.nouns.decision import Behaviour

BEHAVIOUR_COLOURS: dict[Behaviour, str] = {
    Behaviour.NORMAL: "#0072b2",
    Behaviour.CAUTIOUS: "#e69f00",
    Behaviour.OVERTAKING: "#cc79a7",
    Behaviour.STOPPING: "#d55e00",
    Behaviour.CROSSING: "#009e73",
    Behaviour.CHANGING_LANES: "#56b4e9",
    Behaviour.CHANGING_QUEUES: "#8a8f2a",
    Behaviour.TURNING_ROUND: "#7a5fb5",
    Behaviour.BACKING_UP: "#a0522d",
    Behaviour.TAKING_ANOTHER_WAY: "#5f6b75",
}

PALETTE = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8a8f2a", "#7a5fb5")
"""For what has no colour of its own, in order."""

FAULT, STOP, SOFT = "#d32f2f", "#d55e00", "#808a94"
ROAD, JUNCTION, EDGE = "rgba(128,138,148,0.45)", "rgba(128,138,148,0.28)", "rgba(128,138,148,0.6)"

DRIVER_COLOURS = {"reactive": "#0072b2", "sumo": "#e69f00"}
DRIVER_NAMES = {"reactive": "this\u00a0driver", "sumo": "SUMO's\u00a0own"}

FRAME: dict[str, Any] = {
    "template": "none",
    "paper_bgcolor": "rgba(0,0,0,0)",
    "plot_bgcolor": "rgba(0,0,0,0)",
    "font": {"family": "system-ui, 'Liberation Sans', sans-serif", "size": 13},
    "hoverlabel": {"bgcolor": "#ffffff", "bordercolor": "#808a94", "font": {"color": "#1c2024"}, "align": "left"},
    "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": "#a3adb8", "activecolor": "#0072b2"},
    "margin": {"l": 70, "r": 20, "t": 75, "b": 55},
}
"""The layout that all figures share; the page's style colours text and grid."""


def colour_of(index: int) -> str:
    """Return the colour of the n-th of several things."""
    return PALETTE[index % len(PALETTE)]
