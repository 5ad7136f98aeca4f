"""The page of the commands: arguments and options as the application knows them."""

from __future__ import annotations

import inspect
import typing
from enum import Enum
from pathlib import Path
from typing import Any

import typer

from reference.markdown import page, table
from sumo_reactive.cli.app import app

INTRODUCTION = """`sumo-reactive --version` tells the version, `sumo-reactive COMMAND --help` what stands here; how they end:
[exit codes](exit_codes.md). What is repeatable may be given several times."""

KINDS = {int: "whole number", float: "number", str: "text", Path: "path"}
"""What an option takes, in words."""


def commands() -> str:
    """Return the page."""
    parts = [INTRODUCTION]
    for name, command in sorted(typer.main.get_command(app).commands.items()):  # type: ignore[attr-defined]
        note, _, example = (command.epilog or "").rpartition("Example: ")
        parts += [f"## {name}", " ".join((command.help or "").split()), _options(command), f"{note}Example: `{example}`"]
    return page("Commands", *parts)


def _options(command: Any) -> str:
    hints = typing.get_type_hints(inspect.unwrap(command.callback), include_extras=True)
    rows = []
    for one in command.params:
        usual = "needed" if one.required else "" if one.default in (None, False) else f"`{_plain(one.default)}`"
        is_argument = one.param_type_name == "argument"
        names = [one.metavar or one.name.upper()] if is_argument else one.opts
        value = "" if is_argument else _value(hints[one.name], one.metavar)
        rows.append((", ".join(f"`{name}`" for name in names), value, usual, one.help))
    return table(("name", "value", "default", "meaning"), rows)


def _plain(value: object) -> object:
    return value.value if isinstance(value, Enum) else value


def _value(hint: Any, metavar: str | None) -> str:
    """Return what an option takes; nothing: it is a flag."""
    kind, told = typing.get_args(hint)[:2]
    kind = next(one for one in (*typing.get_args(kind), kind) if one is not type(None))
    if typing.get_origin(kind) is list:
        (kind,) = typing.get_args(kind)
    if kind is bool:
        return ""
    if metavar:
        return f"`{metavar}`"
    if issubclass(kind, Enum):
        return " or ".join(f"`{choice.value}`" for choice in kind)
    limits = ", ".join(f"{sign} {limit:g}" for sign, limit in (("≥", told.min), ("≤", told.max)) if limit is not None)
    return f"{KINDS[kind]} {limits}".rstrip()
