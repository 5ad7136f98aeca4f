"""Other values for the constants of `parameters.py`, for one process: a JSON object in an environment variable."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, MutableMapping
from difflib import get_close_matches
from typing import Any

from sumo_reactive.errors import ParameterError

VARIABLE = "SUMO_REACTIVE_PARAMETERS"
"""Environment variable that holds `{"NAME": number, …}`."""


def overrides() -> dict[str, float]:
    """Return what the environment asks for, by name; raise ParameterError if that is no object of numbers."""
    text = os.environ.get(VARIABLE, "").strip()
    try:
        asked = json.loads(text) if text else {}
    except ValueError as error:
        raise ParameterError(f"{VARIABLE}: not JSON: {error}") from error
    if not isinstance(asked, dict):
        raise ParameterError(f"{VARIABLE}: not a JSON object of parameters and numbers")
    return asked


def apply_overrides(parameters: MutableMapping[str, Any]) -> None:
    """Put what the environment asks for in place of values of `parameters`; raise ParameterError for what cannot be."""
    parameters.update({name: overridden(parameters, name, value) for name, value in overrides().items()})


def overridden(parameters: Mapping[str, Any], name: str, value: object) -> float | int:
    """Return the value that `parameters[name]` would take; raise ParameterError for an unknown name or another kind."""
    present = parameters.get(name) if name.isupper() else None
    if not _is_number(present):
        raise ParameterError(f"unknown parameter '{name}'{_nearest(parameters, name)}")
    if not isinstance(value, float | int) or isinstance(value, bool) or not math.isfinite(value):
        raise ParameterError(f"parameter '{name}': {value!r} is not a finite number")
    if isinstance(present, float):
        return float(value)
    if value != int(value):
        raise ParameterError(f"parameter '{name}': {value!r} is not a whole number")
    return int(value)


def _nearest(parameters: Mapping[str, Any], name: str) -> str:
    known = [one for one, value in parameters.items() if one.isupper() and _is_number(value)]
    near = get_close_matches(name.upper(), known, n=3, cutoff=0.5)
    return f"; near it: {', '.join(near)}" if near else ""


def _is_number(value: object) -> bool:
    return isinstance(value, float | int) and not isinstance(value, bool)
