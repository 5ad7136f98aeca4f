"""The frame of every page: one file that asks nobody for anything, readable in light and dark; its style and numbers."""

from __future__ import annotations

import base64
import gzip
import json
import math
import re
from collections.abc import Iterable, Sequence
from functools import cache
from html import escape
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any, NamedTuple

from sumo_reactive.driver.nouns.decision import Behaviour
from sumo_reactive.lab.drivers.choice import REACTIVE_NAME, SUMO_NAME
from sumo_reactive.lab.metric_names import EVERY, metric_of

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

    from sumo_reactive.lab.comparison.statistics import ConfidenceInterval, PairedDifference

_DIGITS = 4
_NUMBER = r"(<strong>)?[+−-]?\d[\d.,e+-]*( … [+−-]?\d[\d.,e+-]*)?(</strong>)?"
"""What stands right in a table: a number, or the two limits of an interval."""

_NO_SITE = {"displaylogo": False, "showSendToCloud": False, "plotlyServerURL": ""}
"""No button opens a site."""

_CONFIG = {**_NO_SITE, "responsive": True, "scrollZoom": True, "modeBarButtonsToRemove": ["select2d", "lasso2d"]}

# Colours that are told apart by colour-blind people, too (Okabe and Ito 2008), on light and on dark.
BEHAVIOUR_COLOURS = {
    Behaviour.NORMAL: "#0072b2", Behaviour.CAUTIOUS: "#e69f00", Behaviour.OVERTAKING: "#cc79a7",
    Behaviour.STOPPING: "#d55e00", Behaviour.CROSSING: "#009e73", Behaviour.CHANGING_LANES: "#56b4e9",
    Behaviour.CHANGING_QUEUES: "#8a8f2a", Behaviour.TURNING_ROUND: "#7a5fb5", Behaviour.BACKING_UP: "#a0522d",
    Behaviour.TAKING_ANOTHER_WAY: "#5f6b75", Behaviour.GIVING_WAY: "#b8860b",
}  # fmt: skip

UNTOLD = "driving"
"""What an ego does whose driver has no behaviours."""


def behaviour_colour(behaviour: Behaviour | None) -> str:
    """Return the colour of a behaviour; None: the driver tells none."""
    return SOFT if behaviour is None else BEHAVIOUR_COLOURS[behaviour]


def behaviour_name(behaviour: Behaviour | None) -> str:
    """Return what a behaviour is called; None: the driver tells none."""
    return UNTOLD if behaviour is None else behaviour.value


PALETTE = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8a8f2a", "#7a5fb5")
"""For what has no colour of its own, in order."""

FAULT, STOP, SOFT = "#d32f2f", "#d55e00", "#808a94"
ROAD, JUNCTION, EDGE = "rgba(128,138,148,0.45)", "rgba(128,138,148,0.28)", "rgba(128,138,148,0.6)"

_DRIVER_NAMES = {REACTIVE_NAME: "this\u00a0driver", SUMO_NAME: "SUMO's\u00a0own"}


def driver_name(driver: str) -> str:
    """Return what a driver is called on a page; a user's by its own name."""
    return _DRIVER_NAMES.get(driver, driver)


def driver_colour(driver: str, drivers: Sequence[str]) -> str:
    """Return the colour of a driver among others; the two that are built in have theirs everywhere."""
    ordered = [*_DRIVER_NAMES, *(one for one in drivers if one not in _DRIVER_NAMES)]
    return PALETTE[ordered.index(driver) % len(PALETTE)]


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

_TEMPLATE = Path(__file__).with_name("page.html")
"""The document around a page's parts. It has the browser itself refuse every request that a page might make."""

_LIBRARY, _FIGURE = "library", "figure"
"""What kind of stored text is the packed plotting library, and what a figure: its div comes before it."""

_SCRIPT = Path(__file__).with_name("page.js")
"""Unpacks the library, draws the figures, and then resolves `figuresDrawn`; a button shows a part of a figure it names."""


class Html(str):
    """Text that is HTML already; every other text is escaped when it is put on a page."""

    __slots__ = ()


class Section(NamedTuple):
    """A part of a page: its anchor, its heading, what stands below."""

    anchor: str
    heading: str
    parts: Sequence[str]


def page(title: str, subtitle: str, sections: Iterable[Section], *, is_drawn: bool = True) -> str:
    """Return a whole page; `is_drawn`: it holds figures, which share one copy of the plotting library."""
    kept = [section for section in sections if section.parts]
    return Template(_TEMPLATE.read_text(encoding="utf-8")).substitute(
        title=escape(title),
        subtitle=_cell(subtitle),
        links=" · ".join(f'<a href="#{escape(one.anchor)}">{escape(one.heading)}</a>' for one in kept),
        body="".join(map(_section, kept)),
        script=f"<script>{_SCRIPT.read_text(encoding='utf-8')}</script>{_library()}\n" if is_drawn else "",
    )


@cache
def _library() -> Html:
    from plotly.offline import get_plotlyjs

    return stored(_LIBRARY, packed(get_plotlyjs()))


def packed(text: str) -> str:
    """Return a text as gzip in base64; the same text gives the same."""
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode()


def stored(kind: str, text: str) -> Html:
    """Return a text that a script of the page reads by its kind; a browser neither shows nor runs it."""
    return Html(f'<script type="text/plain" data-kind="{kind}">{text}</script>')


def table(head: Sequence[str], rows: Iterable[Sequence[str]], *, is_long: bool = False) -> Html:
    """Return a table whose cells are escaped unless they are HTML; numbers stand right, a long table scrolls."""
    titles = "".join(f"<th>{_cell(one)}</th>" for one in head)
    body = "".join(f"<tr>{''.join(map(_td, row))}</tr>" for row in rows)
    kind = "wide long" if is_long else "wide"
    return Html(f'<div class="{kind}"><table><thead><tr>{titles}</tr></thead><tbody>{body}</tbody></table></div>')


def paragraph_of(*texts: str, kind: str = "") -> Html:
    """Return a paragraph, of a `kind` that the style knows."""
    opening = f'<p class="{kind}">' if kind else "<p>"
    return Html(f"{opening}{''.join(map(_cell, texts))}</p>")


def link(target: str, text: str) -> Html:
    """Return a link to an anchor or a file beside the page."""
    return Html(f'<a href="{escape(target)}">{escape(text)}</a>')


def code(text: str) -> Html:
    """Return a command to copy."""
    return Html(f"<code>{escape(text)}</code>")


def figure_html(figure: Figure, name: str) -> Html:
    """Return a figure, as high as its layout says, under an id of its own; the library is the page's."""
    drawn = json.loads(figure.to_json()) | {"config": _CONFIG}
    text = json.dumps(drawn, separators=(",", ":")).replace("<", "\\u003c")
    div = f'<div id="plot-{escape(name)}" style="height:{int(figure.layout.height)}px"></div>'
    return Html(f'<div class="plot">{div}{stored(_FIGURE, text)}</div>')


def side_by_side(parts: Iterable[str]) -> Html:
    """Return parts in columns where the window is wide enough."""
    return Html(f'<div class="grid">{"".join(parts)}</div>')


def _section(section: Section) -> str:
    parts = "\n".join(_cell(part) for part in section.parts)
    return f'<section id="{escape(section.anchor)}"><h2>{escape(section.heading)}</h2>\n{parts}</section>\n'


def _td(text: str) -> str:
    is_number = re.fullmatch(_NUMBER, text) is not None
    return f'<td class="number">{text}</td>' if is_number else f"<td>{_cell(text)}</td>"


def _cell(text: str) -> str:
    return text if isinstance(text, Html) else escape(text)


def is_count(metric: str) -> bool:
    """Whether a metric counts something, or says yes (1) or no (0)."""
    return metric in EVERY and EVERY[metric].is_count


def title_of(metric: str) -> str:
    """Return a metric as the title of a column or an axis, with its unit; one that is not of this release by its key."""
    return metric_of(metric).title


def number(value: float | None) -> str:
    """Return a number with the digits that count, a dash for none."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == round(value) and abs(value) < 10**_DIGITS * 100:
        return f"{value:.0f}".replace("-", "−")
    return f"{value:.{_DIGITS}g}".replace("-", "−")


def signed(value: float) -> str:
    """Return a difference with its sign."""
    return f"+{number(value)}" if value > 0.0 else number(value + 0.0)


def difference_cells(found: PairedDifference) -> tuple[str, ...]:
    """Return both means, the difference and its interval as cells of a row; the interval in bold if it is sure."""
    told = limits(found.interval, is_difference=True)
    means = number(found.first), number(found.second), signed(found.difference)
    return *means, Html(f"<strong>{told}</strong>") if found.is_sure else told


def limits(interval: ConfidenceInterval | None, *, is_difference: bool = False) -> str:
    """Return an interval, or that there is none."""
    if interval is None:
        return "none: n = 1"
    told = signed if is_difference else number
    return f"{told(interval.low)} … {told(interval.high)}"
