"""Small simulations in this process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import libsumo


@contextmanager
def running(net: Path, folder: Path, content: str, *options: str, step: float = 0.1) -> Iterator[None]:
    """Run a simulation of what a file of routes holds, and end it."""
    routes = folder / "routes.rou.xml"
    routes.write_text(f"<routes>{content}</routes>", encoding="utf-8")
    start = ["sumo", "-n", str(net), "-r", str(routes), "--no-step-log", "--no-warnings", "--step-length", str(step)]
    libsumo.start([*start, *options])
    try:
        yield
    finally:
        libsumo.close()


def simulated(steps: int = 1) -> None:
    """Simulate some steps."""
    for _ in range(steps):
        libsumo.simulationStep()


def vehicle(name: str, edges: str, inner: str = "", **attributes: object) -> str:
    """Return a vehicle that departs at once unless told otherwise; a trailing underscore of an attribute is dropped."""
    said = {"depart": 0} | {key.rstrip("_"): value for key, value in attributes.items()}
    text = " ".join(f'{key}="{value}"' for key, value in said.items())
    return f'<vehicle id="{name}" {text}><route edges="{edges}"/>{inner}</vehicle>'
