#!/usr/bin/env python3
"""Write docs/reference/: commands, exit codes, parameters, keys of files, metrics, reasons, and the files that are written.

    python tools/reference_pages.py [--check] [--folder FOLDER]

Everything is from the code: options of the commands, docstrings, the lines below fields, tables of meanings. Columns and
their types are those of a run that is recorded for it. Exit codes: 0 written or up to date, 1 out of date, 2 wrong usage.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from api_pages import ROOT, write_or_compare
from reference.commands import commands
from reference.file_keys import file_keys
from reference.files import files
from reference.markdown import coded, page, said_below, table

from sumo_reactive.driver.ablation import Mechanism
from sumo_reactive.driver.nouns.decision import INSTRUCTION_NUMBERS, Occupancy
from sumo_reactive.driver.nouns.record import BEND, STOP_PLACE, TOO_NEAR
from sumo_reactive.driver.parameters import LEAST, NAMES, USUAL, Parameters
from sumo_reactive.driver.vehicle.limits import VehicleLimits
from sumo_reactive.errors import ExitCode
from sumo_reactive.lab.fault import FAULT_MEANINGS
from sumo_reactive.lab.metric_names import BASELINE, METRICS, NETWORK, OTHERS, TIMINGS, Metric, event_key, unit_of_parameter
from sumo_reactive.lab.task import Ending
from sumo_reactive.show import sentences
from sumo_reactive.sumo.launch import OVERRIDES

FOLDER = ROOT / "docs" / "reference"

FIGURES: Mapping[str, Mapping[str, Metric]] = {
    "Of a trip": METRICS, "Of SUMO's own driver alone": BASELINE, "Of all others, in a comparison": OTHERS,
    "Of a run with a share of egos": NETWORK, "Wall-clock": TIMINGS,
}  # fmt: skip

BY_NAME = """Other values are given by name, in small letters or capitals: `--parameter stuck_s=120` of `run` and `compare`,
`parameters` of a [scenario or experiment file](file_keys.md), `Parameters.of({"stuck_s": 120.0})` in Python. An unknown
name, what is no finite number and what is less than the least is told in one line."""

WORDS = """As files have them, and as `explain` tells them: `{cause}` stands for another's id, `{place}` for a region,
`{order}` for before or after."""

OF_THE_VEHICLE = """By `<param key="reactive.NAME" value="…"/>` of a vehicle or its type; [what they are
otherwise](../run.md#the-vehicle)."""

OF_SUMO = """In force unless the command line says otherwise behind `--`; [why](../run.md#what-it-changes-in-a-scenario)."""


def main() -> None:
    """Write or compare the pages."""
    write_or_compare(lambda: {name: make() for name, make in PAGES.items()}, FOLDER, __doc__ or "")


def exit_codes() -> str:
    """Return the page of the exit codes."""
    said, told = said_below(ExitCode), inspect.getdoc(ExitCode) or ""
    return page("Exit codes", told, table(("code", "meaning"), ((f"{one:d}", said[one.name]) for one in ExitCode)))


def parameters() -> str:
    """Return the page of the driver's parameters, and of what else of a scenario is overridden."""
    mechanisms = said_below(Mechanism)
    limits = [name for name in VehicleLimits.__dataclass_fields__ if name not in ("parameters", "vehicle_class")]
    return page(
        "Parameters and overrides", BY_NAME, *_sections(),
        "## Numbers of instructions",
        table(("`shares_of`", "instruction"), ((f"{number:g}", one.value) for one, number in INSTRUCTION_NUMBERS.items())),
        "## Numbers of mechanisms",
        table(("`without`", "what is then so"), ((one.value, mechanisms[one.name]) for one in Mechanism)),
        "## Overrides of the vehicle", OF_THE_VEHICLE, ", ".join(f"`{name}`" for name in limits),
        "## Overrides of SUMO's options", OF_SUMO,
        table(("option", "used", "SUMO's default"), ((f"`{name}`", *values) for name, values in OVERRIDES.items())),
    )  # fmt: skip


def _sections() -> Iterator[str]:
    """Yield the headings among the fields of `Parameters`, each with a table of those below it."""
    said = said_below(Parameters)
    for part in re.split(r"^    # --- (?=.* ---$)", inspect.getsource(Parameters), flags=re.MULTILINE)[1:]:
        yield f"## {part[0].upper()}{part.partition(' ---')[0][1:]}"
        names = [name for name in re.findall(r"^    (\w+): \w+ = ", part, re.MULTILINE) if name in NAMES]
        rows = (
            (f"`{one}`", f"{getattr(USUAL, one):g}", unit_of_parameter(one), f"{LEAST.get(one, 0):g}", said[one])
            for one in names
        )
        yield table(("name", "default", "unit", "least", "what it is"), rows)


def metrics() -> str:
    """Return the page of every figure."""
    told = "Each has one key, in records, `[expect.metrics]`, comparisons, batches and their stores; [more](../metrics.md)."
    return page("Metrics", told, *(part for title, those in FIGURES.items() for part in (f"## {title}", _figures(those))))


def _figures(those: Mapping[str, Metric]) -> str:
    rows = ((f"`{one.key}`", one.label, one.unit, one.meaning) for one in those.values())
    return table(("key", "shown as", "unit", "what it is"), rows)


def reasons() -> str:
    """Return the page of what a record or `explain` names in words of its own."""
    endings = said_below(Ending)
    waits = ((one.value, wording.waits, wording.passes) for one, wording in sentences.REASONS.items())
    events = ((one.value, wording, f"`{event_key(one)}`") for one, wording in sentences.EVENTS.items())
    hazards = ((STOP_PLACE,), (BEND,), (TOO_NEAR,), ("the id of a leader",), ("empty: no command is admissible",))
    parts = {
        "Behaviours": table(("behaviour", "told as"), _worded(sentences.BEHAVIOURS)),
        "Instructions": table(("instruction", "told as"), _worded(sentences.INSTRUCTIONS)),
        "Reasons": table(("reason", "where the ego waits", "where it goes on"), waits),
        "Figures of a decision": table(("figure", "told as"), coded(sentences.FIGURES)),
        "Events": table(("event", "told as", "counted by"), events),
        "Outcomes of the assessment": table(("outcome", "told as"), _worded(sentences.OUTCOMES)),
        "States of a region": table(("state",), ((one.value,) for one in Occupancy)),
        "Hazards of an emergency": table(("hazard",), hazards),
        "Faults": table(("kind", "meaning"), FAULT_MEANINGS.items()),
        "Endings of a trial": table(("ending", "meaning"), ((one.value, endings[one.name]) for one in Ending)),
    }
    return page("Reasons and events", WORDS, *(part for title, found in parts.items() for part in (f"## {title}", found)))


def _worded(wordings: Mapping[Any, str]) -> Iterator[tuple[str, str]]:
    return ((one.value, wording) for one, wording in wordings.items())


PAGES: Mapping[str, Callable[[], str]] = {
    f"{make.__name__}.md": make for make in (commands, exit_codes, parameters, file_keys, metrics, reasons, files)
}


if __name__ == "__main__":
    main()
