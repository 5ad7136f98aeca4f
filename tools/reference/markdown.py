"""Pages and tables in Markdown, and what the source says below a field."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from api_pages import source_of

Rows = Iterable[Sequence[object]]


def page(title: str, *parts: str) -> str:
    """Return a page of paragraphs and tables."""
    return "\n\n".join((f"# {title}", *parts)) + "\n"


def table(head: Sequence[str], rows: Rows) -> str:
    """Return a table."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines)


def _cell(text: object) -> str:
    return str(text).replace("|", "\\|")


def coded(meanings: Mapping[str, Any]) -> Rows:
    """Return rows of names as code, each with what it means."""
    return ((f"`{name}`", told) for name, told in meanings.items())


def said_below(one: type) -> dict[str, str]:
    """Return what stands below each field or choice of a class, in one line."""
    found = {}
    for field, after in itertools.pairwise(source_of(one).body):
        if isinstance(field, ast.AnnAssign | ast.Assign) and isinstance(after, ast.Expr):
            target = field.target if isinstance(field, ast.AnnAssign) else field.targets[0]
            found[ast.unparse(target)] = " ".join(str(ast.literal_eval(after.value)).split())
    return found
