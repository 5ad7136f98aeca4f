"""The command line: one file a command, which imports heavy packages only when it is called."""

from sumo_reactive.cli import batch, check, compare, demo, publish, results, run, see, tell
from sumo_reactive.cli.main import main

__all__ = ["batch", "check", "compare", "demo", "main", "publish", "results", "run", "see", "tell"]
