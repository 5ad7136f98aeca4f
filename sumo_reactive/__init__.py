"""`sumo_reactive`: a reactive external driver for SUMO after Fraichard & Laugier (ICRA 1991).

What programs need is here; it is loaded when it is first asked for.
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_PLACES = {
    "Controller": "driver.controller", "Driver": "lab.drivers.protocol", "compare": "lab.comparison.comparison",
    "load_scenario": "lab.scenario", "read_run": "show.recording", "run_fleet": "lab.fleet",
    "run_trial": "lab.simulation",
}  # fmt: skip


def __getattr__(name: str) -> Any:
    """Load what is named from the module that holds it."""
    if name not in _PLACES:
        raise AttributeError(f"module 'sumo_reactive' has no attribute '{name}'")
    return getattr(import_module(f"sumo_reactive.{_PLACES[name]}"), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return [*_PLACES, "__version__"]
