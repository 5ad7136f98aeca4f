"""JSON files that follow a schema: every problem becomes one line that names file and key."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import content_of

Schema = TypeVar("Schema")

MOST_BYTES = 2**28
"""No file of a record is larger."""

LARGEST = 1e12
"""No number of a record is larger, whatever its unit."""


def _whole(value: float) -> float:
    return int(value) if value.is_integer() else value


Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST, allow_inf_nan=False), AfterValidator(_whole)]
"""A number of a record; a whole one stays whole, as counts are."""


class Keys(BaseModel):
    """A JSON object with keys of these types; others are left alone."""

    model_config = ConfigDict(strict=True, extra="ignore", frozen=True)


def read_json(path: Path, schema: type[Schema], what: str) -> Schema:
    """Return the contents of `path`, which is `what` ("the summary of a run"); raise ScenarioError for something else."""
    return checked(content_of(path, most=MOST_BYTES), schema, str(path), what)


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
