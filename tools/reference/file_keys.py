"""The page of the keys of scenario and experiment files: as their schemas know them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from reference.markdown import page, said_below, table
from sumo_reactive.lab.batch.experiment import EgoKeys, ExperimentFile, ExperimentKeys, SampleKeys
from sumo_reactive.lab.batch.network_keys import NetworkKeys
from sumo_reactive.lab.scenario import Expectation, Limit, RuleKeys, ScenarioKeys

MODELS: Mapping[str, Mapping[str, type[BaseModel]]] = {
    "Scenario files": {
        "[scenario]": ScenarioKeys, "[egos] of a scenario": RuleKeys, "[expect]": Expectation,
        "[expect.metrics] NAME = { … }": Limit,
    },
    "Experiment files": {
        "[experiment]": ExperimentKeys, "[egos]": EgoKeys, "[samples]": SampleKeys, "[network]": NetworkKeys,
        "All tables": ExperimentFile,
    },
}  # fmt: skip

SOURCES = {model.__module__ for models in MODELS.values() for model in models.values()}
"""Modules whose models, and those that they extend, say what each key means."""

_LIMITS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤"}
_WORDS = {"integer": "whole number", "string": "text", "boolean": "true or false", "object": "table"}


def file_keys() -> str:
    """Return the page."""
    parts = ["TOML. Another key, or a value of another type or beyond its limits, is told with file and line."]
    for title, models in MODELS.items():
        parts.append(f"## {title}")
        for name, model in models.items():
            parts += [f"### {f'`{name}`' if '[' in name else name}", _keys(model)]
    return page("Keys of files", *parts)


def _keys(model: type[BaseModel]) -> str:
    told = model.model_json_schema()
    said = {key: text for one in reversed(model.mro()) if one.__module__ in SOURCES for key, text in said_below(one).items()}
    rows = []
    for name, field in told["properties"].items():
        default = field.get("default")
        usual = "" if default is None else f"`{json.dumps(default)}`"
        is_needed = name in told.get("required", ())
        rows.append((f"`{name}`", value_told(field, told.get("$defs", {})), "needed" if is_needed else usual, said[name]))
    return table(("key", "value", "default", "meaning"), rows)


def value_told(field: Mapping[str, Any], types: Mapping[str, Any]) -> str:
    """Return in words what a JSON schema allows."""
    if "$ref" in field:
        return value_told(types[field["$ref"].rpartition("/")[2]], types)
    if "enum" in field:
        return " or ".join(f"`{json.dumps(one)}`" for one in field["enum"])
    if "anyOf" in field:
        kinds = (value_told(one, types) for one in field["anyOf"] if one.get("type") != "null")
        return " or ".join(dict.fromkeys(kinds))
    if field.get("type") == "array":
        return f"list of {value_told(field['items'], types).replace('number', 'numbers')}"
    kind = field.get("type", "")
    limits = ", ".join(f"{sign} {field[key]:.12g}" for key, sign in _LIMITS.items() if key in field)
    return " ".join((_WORDS.get(kind, kind), limits)).rstrip()
