"""Options by which a command takes several egos at once: by kind, by where they depart, by share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from sumo_reactive.lab.ego_rule import EgoRule

TypeOption = Annotated[list[str] | None, typer.Option(help="drive every vehicle of this type (repeatable)")]
"""The option `--ego-type` of a command."""

ClassOption = Annotated[list[str] | None, typer.Option(help="… of this vehicle class (repeatable)")]
"""The option `--ego-class` of a command."""

RegionOption = Annotated[
    str | None, typer.Option(metavar="X1,Y1,X2,Y2", help="… that departs within this rectangle, by two corners, m")
]
"""The option `--ego-region` of a command."""

ShareOption = Annotated[
    float | None, typer.Option(min=0.0, max=1.0, help="drive this share of them, or of all, drawn by id and seed")
]
"""The option `--ego-probability` of a command."""


def rule_asked(
    ids: Sequence[str], types: Sequence[str] | None, classes: Sequence[str] | None, region: str | None, share: float | None
) -> EgoRule | None:
    """Return the rule of the command line if it asks for several egos; else None."""
    from sumo_reactive.lab.ego_rule import EgoRule, region_of, several

    try:
        corners = region_of([float(value) for value in region.split(",")]) if region is not None else None
    except ValueError as error:
        raise typer.BadParameter(f"{region!r} is not four numbers", param_hint="--ego-region") from error
    kinds = {"types": tuple(types or ()), "classes": tuple(classes or ())}
    return several(EgoRule(ids=tuple(ids), **kinds, region=corners, share=share))
