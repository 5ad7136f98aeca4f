"""Judges: each looks at one moment a step and gives its figures at the end; one metric a file."""

from sumo_reactive.lab.metrics.jury import Jury

__all__ = ["Jury"]
