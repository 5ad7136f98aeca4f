"""A simulation that writes nothing: the same as one that does, in another process."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Sequence
from pathlib import Path

from sumo_reactive.sumo.config import given_options, option_words

_PREFIX_OPTION = "output-prefix"
_OPEN = Path("/proc/self/fd")


def prefix_of(process: int) -> str:
    """Return what the names of the files begin with that a process's SUMO opens to write."""
    return f".sumo_reactive.{process}."


def with_prefix(sumo_options: Sequence[str], prefix: str) -> tuple[str, ...]:
    """Return SUMO's options with which it writes files of its own, beside those that it is asked for."""
    return tuple(option_words(given_options(sumo_options) | {_PREFIX_OPTION: prefix}))


def mute(prefix: str) -> None:
    """Let go of what SUMO has opened to write under a prefix: it goes on writing, to nowhere."""
    for link in _OPEN.iterdir():
        with contextlib.suppress(OSError):  # what lists the folder is listed, and is closed by now
            file = link.readlink()
            if file.name.startswith(prefix):
                mute_descriptor(int(link.name))
                file.unlink()


def mute_descriptor(number: int) -> None:
    """Have what is written to an open file written nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, number)
    os.close(nowhere)
