"""Who drives the ego of a trial."""

from enum import Enum


class Driver(Enum):
    """This project's controller, or SUMO's own driver (the baseline)."""

    REACTIVE = "reactive"
    SUMO = "sumo"
