"""The frame of every page: one file that asks nobody for anything, readable in light and dark."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING, NamedTuple

from sumo_reactive.show.frame.style import POLICY, SCRIPT, STYLE

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_NUMBER = r"(<strong>)?[+−-]?\d[\d.,e+-]*( … [+−-]?\d[\d.,e+-]*)?(</strong>)?"
"""What stands right in a table: a number, or the two limits of an interval."""

_NO_SITE = {"displaylogo": False, "showSendToCloud": False, "plotlyServerURL": ""}
"""No button opens a site."""

_CONFIG = {**_NO_SITE, "responsive": True, "scrollZoom": True, "modeBarButtonsToRemove": ["select2d", "lasso2d"]}


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
    links = " · ".join(f'<a href="#{escape(one.anchor)}">{escape(one.heading)}</a>' for one in kept)
    body = "".join(_section(one) for one in kept)
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>\n{POLICY}'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<style>{STYLE}</style>\n'
        f"{_library() if is_drawn else ''}</head>\n<body><header><h1>{escape(title)}</h1><p>{_cell(subtitle)}</p>"
        f"<nav>{links}</nav></header>\n<main>{body}</main>\n{SCRIPT if is_drawn else ''}</body></html>\n"
    )


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


def subheading(anchor: str, text: str) -> Html:
    """Return a heading below that of a section."""
    return Html(f'<h3 id="{escape(anchor)}">{escape(text)}</h3>')


def link(target: str, text: str) -> Html:
    """Return a link to an anchor or a file beside the page."""
    return Html(f'<a href="{escape(target)}">{escape(text)}</a>')


def code(text: str) -> Html:
    """Return a command to copy."""
    return Html(f"<code>{escape(text)}</code>")


def figure_html(figure: Figure, name: str, height: int) -> Html:
    """Return a figure of `height` pixels under an id of its own; the library is the page's."""
    from plotly.io import to_html

    drawn = to_html(
        figure, config=_CONFIG, include_plotlyjs=False, full_html=False, default_height=f"{height}px", div_id=f"plot-{name}"
    )
    return Html(f'<div class="plot">{drawn}</div>')


def side_by_side(parts: Iterable[str]) -> Html:
    """Return parts in columns where the window is wide enough."""
    return Html(f'<div class="grid">{"".join(parts)}</div>')


def _section(section: Section) -> str:
    parts = "\n".join(_cell(part) for part in section.parts)
    return f'<section id="{escape(section.anchor)}"><h2>{escape(section.heading)}</h2>\n{parts}</section>\n'


def _library() -> str:
    from plotly.offline import get_plotlyjs

    return f"<script>{get_plotlyjs()}</script>\n"


def _td(text: str) -> str:
    is_number = re.fullmatch(_NUMBER, text) is not None
    return f'<td class="number">{text}</td>' if is_number else f"<td>{_cell(text)}</td>"


def _cell(text: str) -> str:
    return text if isinstance(text, Html) else escape(text)
