"""The command line: one file a command, which imports heavy packages only when it is called."""

from sumo_reactive.cli import explain, run
from sumo_reactive.cli.main import main

__all__ = ["explain", "main", "run"]
