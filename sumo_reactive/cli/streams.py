"""What is printed: whoever reads it may stop reading (`| head`), and the work goes on."""

from __future__ import annotations

import io
import os
import sys
from typing import Any


class _Outlet(io.FileIO):
    """A file descriptor to write to; once nobody reads it any more, what is written is lost and nothing else."""

    def write(self, data: Any) -> int:
        """Return how many bytes are done with."""
        try:
            return super().write(data) or 0
        except BrokenPipeError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.fileno())
            os.close(nowhere)
            return len(data)


def outlive_readers() -> None:
    """Let standard output and error be closed at their other end; streams that the caller has put in their place stay."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None or stream is not getattr(sys, f"__{name}__"):
            continue
        stream.flush()
        outlet = io.BufferedWriter(_Outlet(stream.fileno(), "w", closefd=False))
        text = io.TextIOWrapper(outlet, stream.encoding, stream.errors, line_buffering=name == "stderr" or stream.isatty())
        setattr(sys, name, text)
