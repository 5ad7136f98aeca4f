"""A recorded run as a film: the drawing of a moment, moved from frame to frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
from matplotlib.animation import FFMpegWriter, PillowWriter

from sumo_reactive.errors import ScenarioError
from sumo_reactive.show.recording import CLOSE_S, Steps
from sumo_reactive.show.run_drawing import RunDrawing
from sumo_reactive.writing import whole_file

FILM_FORMATS = ("mp4", "gif")

FILM_DPI = 100.0
"""Dots an inch: a whole even number of pixels, as encoders want it."""

MOST_FRAMES = 20_000
"""A film of more would hardly be meant: 11 minutes at 30 frames a second."""

_CODEC, _QUALITY = "libx264", ["-crf", "20", "-pix_fmt", "yuv420p", "-fflags", "+bitexact", "-flags:v", "+bitexact"]
"""What players everywhere play; the same frames give the same bytes."""


class Cut(NamedTuple):
    """What of a run is filmed: from and to (s; None: its begin, its end), frames a second, times faster than life."""

    start: float | None = None
    end: float | None = None
    fps: int = 20
    speed: float = 1.0


def frames_of(steps: Steps, cut: Cut) -> list[int]:
    """Return the step that each frame shows; raise ScenarioError for a cut that shows nothing, or too much."""
    first = steps.times[0] if cut.start is None else cut.start
    last = steps.times[-1] if cut.end is None else cut.end
    if not steps.times[0] - CLOSE_S <= first < last <= steps.times[-1] + CLOSE_S:
        run = f"{steps.times[0]:.1f} to {steps.times[-1]:.1f} s"
        raise ScenarioError(f"{first:g} to {last:g} s is no part of the run ({run})")
    count = int((last - first) * cut.fps / cut.speed) + 1
    if count > MOST_FRAMES:
        raise ScenarioError(f"a film of {count} frames: more than {MOST_FRAMES}; film a part of the run, or faster")
    return [*_nearest(steps.times, (first + k * cut.speed / cut.fps for k in range(count)))]


def _nearest(times: list[float], wanted: Iterator[float]) -> Iterator[int]:
    """Yield for each time, in order, the index of the step nearest to it."""
    k = 0
    for time in wanted:
        while k + 1 < len(times) and abs(times[k + 1] - time) <= abs(times[k] - time):
            k += 1
        yield k


def write_film(drawing: RunDrawing, cut: Cut, path: Path, progress: Callable[[str], None] | None = None) -> int:
    """Write a film in the format that the file's name ends with, whole or not at all; return how many frames it has.

    Raises ScenarioError for a cut that shows nothing, OutputError if the film cannot be written.
    """
    frames, writer = frames_of(drawing.steps, cut), _writer(path, cut.fps)
    with whole_file(path) as partial, writer.saving(drawing.figure, str(partial), dpi=FILM_DPI):
        for number, k in enumerate(frames, start=1):
            drawing.show(k)
            writer.grab_frame()
            if progress is not None:
                progress(f"frame {number} of {len(frames)}")
    return len(frames)


def _writer(path: Path, fps: int) -> Any:
    if path.suffix.lower() == ".gif":
        return PillowWriter(fps=fps)
    from imageio_ffmpeg import get_ffmpeg_exe

    mpl.rcParams["animation.ffmpeg_path"] = get_ffmpeg_exe()
    return FFMpegWriter(fps=fps, codec=_CODEC, extra_args=_QUALITY)
