"""Files that follow a schema: every problem of a TOML or JSON file is one line that names file, place and key."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import content_of, text_of

Model = TypeVar("Model", bound=BaseModel)
KeyPath = Sequence[str | int]

MOST_NAMES = 3
"""So many of the nearest names are shown for one that is unknown."""

MOST_TOML_BYTES = 2**20
"""A file that people write is smaller."""

MOST_LINES = 1000
"""In a longer file the line of a problem is not looked for: that takes a time that grows with its square."""


class TomlTable(BaseModel):
    """A table with these keys, of these types, and no others."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def read_toml(path: Path, schema: type[Model]) -> Model:
    """Return the contents of `path` as `schema` describes them; raise ScenarioError naming file, line and key."""
    text = text_of(path, most=MOST_TOML_BYTES)
    try:
        return schema.model_validate(tomllib.loads(text))
    except ValidationError as error:
        problem = error.errors()[0]
        keys = (*problem["loc"], *problem.get("ctx", {}).get("keys", ()))
        line = line_number_of(text, keys)
        raise ScenarioError(f"{path}{f':{line}' if line else ''}: {_told(problem, keys, schema)}") from error
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"{path}{_line_in(str(error))}: not TOML: {_without_place(str(error))}") from error
    except ValueError as error:  # a date that is none, a number of too many digits
        raise ScenarioError(f"{path}: not TOML: {error}") from error
    except RecursionError as error:
        raise ScenarioError(f"{path}: nested too deeply") from error


def line_number_of(text: str, keys: KeyPath) -> int | None:
    """Return the line at which the statement begins that first gives the value at `keys`, or the nearest table above it.

    `text` is TOML. A prefix that ends within a statement is no TOML, so each prefix that is ends a statement.
    """
    lines = text.splitlines()
    if len(lines) > MOST_LINES:
        return None
    for depth in range(len(keys), 0, -1):
        begin = 1
        for end in range(1, len(lines) + 1):
            try:
                table = tomllib.loads("\n".join(lines[:end]) + "\n")
            except tomllib.TOMLDecodeError:
                continue
            if _holds(table, keys[:depth]):
                return begin
            begin = end + 1
    return None


def problem_at(key: str | int, message: str) -> PydanticCustomError:
    """Return what a validator of a table raises for one key of it."""
    return PydanticCustomError("key", "{message}", {"message": message, "keys": (key,)})


def problem_in(path: Path, keys: KeyPath, message: str) -> ScenarioError:
    """Return the error that names a TOML file, and the line of a key in it."""
    line = line_number_of(text_of(path, most=MOST_TOML_BYTES), keys)
    return ScenarioError(f"{path}{f':{line}' if line else ''}: key '{'.'.join(map(str, keys))}': {message}")


def nearest(name: str, names: Iterable[str]) -> str:
    """Return "; near it: a, b" for a name that is unknown, or nothing if none is near."""
    found = difflib.get_close_matches(name.lower(), [one.lower() for one in names], n=MOST_NAMES, cutoff=0.5)
    spelt = {one.lower(): one for one in names}
    return f"; near it: {', '.join(spelt[one] for one in found)}" if found else ""


def _holds(table: Any, keys: KeyPath) -> bool:
    for key in keys:
        try:
            table = table[key]
        except (KeyError, IndexError, TypeError):
            return False
    return True


def _told(problem: Any, keys: KeyPath, schema: type[BaseModel]) -> str:
    """Return a problem that pydantic found in words: what is wrong with which key."""
    place = ".".join(str(part) for part in keys)
    if problem["type"] == "missing":
        return f"missing key '{place}'"
    if problem["type"] == "extra_forbidden":
        return f"unknown key '{place}'{nearest(str(keys[-1]), _fields(schema, keys[:-1]))}"
    message = str(problem["msg"]).removeprefix("Value error, ")
    shown = problem["input"]
    return f"key '{place}': {message}" + ("" if isinstance(shown, dict | BaseModel) else f", got {shown!r}")


def _fields(schema: type[BaseModel], keys: KeyPath) -> list[str]:
    """Return the keys that the table at `keys` knows; none where the schema does not say."""
    for key in keys:
        field = schema.model_fields.get(str(key))
        inner = field.annotation if field else None
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            return []
        schema = inner
    return list(schema.model_fields)


def _line_in(message: str) -> str:
    found = re.search(r"at line (\d+)", message)
    return f":{found[1]}" if found else ""


def _without_place(message: str) -> str:
    return re.sub(r" \(at .*\)$", "", message)


Schema = TypeVar("Schema")

RECORD_VERSION = 4
"""Version of all files of a record: what keys and columns they have, and what these mean. A record of another is refused."""


MOST_RECORD_BYTES = 2**28
"""No file of a record is larger."""

LARGEST_NUMBER = 1e12
"""No number of a record is larger, whatever its unit."""


def _whole(value: float) -> float:
    return int(value) if value.is_integer() else value


Number = Annotated[float, Field(ge=-LARGEST_NUMBER, le=LARGEST_NUMBER, allow_inf_nan=False), AfterValidator(_whole)]
"""A number of a record; a whole one stays whole, as counts are."""


class Keys(BaseModel):
    """A JSON object with keys of these types; others are left alone."""

    model_config = ConfigDict(strict=True, extra="ignore", frozen=True)


def read_json(path: Path, schema: type[Schema], what: str) -> Schema:
    """Return the contents of `path`, which is `what` ("the summary of a run"); raise ScenarioError for something else."""
    return checked(content_of(path, most=MOST_RECORD_BYTES), schema, str(path), what)


def checked(text: str | bytes, schema: type[Schema], place: str, what: str) -> Schema:
    """Return JSON as `schema` describes it; raise ScenarioError naming the place and the key if it is not `what`."""
    try:
        return TypeAdapter(schema).validate_json(text)
    except ValidationError as error:
        problem = error.errors(include_url=False, include_context=False)[0]
        key = ".".join(str(part) for part in problem["loc"])
        if problem["type"] == "missing":
            told = f"key '{key}' is missing"
        else:
            told = (f"key '{key}': " if key else "") + str(problem["msg"]).removeprefix("Value error, ")
        raise ScenarioError(f"{place}: not {what}: {told}") from error


def require_version(found: int, known: int, place: str) -> None:
    """Raise ScenarioError for a file of another version than this release writes; 0: of a release before there were any."""
    if found != known:
        raise ScenarioError(f"{place}: of version {found}, and this release reads {known}: make it again")
