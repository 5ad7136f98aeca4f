"""A bundle is opened: nothing is believed before it is checked, and no file lands outside the folder asked for."""

from __future__ import annotations

import hashlib
import shlex
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import IO
from zipfile import BadZipFile, ZipFile

from sumo_reactive.errors import OutputError, ScenarioError
from sumo_reactive.files import require_file
from sumo_reactive.lab.bundle.manifest import INPUTS, MANIFEST, MOST_BYTES, InputKeys, Manifest, RunKeys, manifest_of
from sumo_reactive.lab.schema import MOST_RECORD_BYTES
from sumo_reactive.lab.task import Task, task_of
from sumo_reactive.sumo.config import INSTEAD_OF_RUNNING, OUTPUT_FILES, given_options, option_words, read_config
from sumo_reactive.sumo.input_files import inputs_of, words_of
from sumo_reactive.sumo.outputs import silenced
from sumo_reactive.sumo.outside_paths import leads_out, path_outside

_PART_BYTES = 1 << 20
_SOURCE = 2
"""Where a command names the configuration."""


@contextmanager
def opened_bundle(path: Path) -> Iterator[tuple[ZipFile, Manifest]]:
    """Open a bundle and read its manifest; raise ScenarioError for what is none, also while it is read."""
    require_file(path)
    try:
        with ZipFile(path) as archive:
            names = archive.namelist()
            if len(set(names)) < len(names) or MANIFEST not in names:
                problem = "two files of one name" if MANIFEST in names else f"no {MANIFEST}"
                raise ScenarioError(f"{path}: not a bundle: {problem}")
            with archive.open(MANIFEST) as file:
                text = file.read(MOST_RECORD_BYTES + 1)
            if len(text) > MOST_RECORD_BYTES:
                raise ScenarioError(f"{path}: not a bundle: a manifest of more than {MOST_RECORD_BYTES / 1e6:.0f} MB")
            yield archive, manifest_of(text, f"{path}, {MANIFEST}")
    except FileNotFoundError as error:
        raise ScenarioError(f"{path}: no such file") from error
    except (BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise ScenarioError(f"{path}: not a bundle: {error}") from error


def unpack_inputs(archive: ZipFile, manifest: Manifest, root: Path) -> None:
    """Write the files that the runs read into the folder `root`; raise ScenarioError if one is not as the manifest says."""
    for one in manifest.inputs:
        target = place_of(one.name, root)
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            with archive.open(one.name) as source, target.open("xb") as file:
                digest, size = copied(source, file, one.bytes)
        except KeyError as error:
            raise ScenarioError(f"{archive.filename}: lacks '{one.name}'") from error
        except OSError as error:
            raise OutputError(f"{target}: cannot be written: {error.strerror or error}") from error
        _require_same(one, digest, size, f"{archive.filename}, {one.name}")


def require_inputs(manifest: Manifest, root: Path) -> None:
    """Raise ScenarioError unless the files in the folder `root` are those that the runs read."""
    for one in manifest.inputs:
        file = place_of(one.name, root)
        require_file(file)
        try:
            with file.open("rb") as source:
                digest, size = copied(source, None, one.bytes)
        except OSError as error:
            raise ScenarioError(f"{file}: cannot be read: {error.strerror or error}") from error
        _require_same(one, digest, size, str(file))


def copied(source: IO[bytes], target: IO[bytes] | None, most: int = MOST_BYTES) -> tuple[str, int]:
    """Copy a file to another, if there is one, little more than `most` bytes of it; return digest and size of what was."""
    digest, size = hashlib.sha256(), 0
    while size <= most and (part := source.read(_PART_BYTES)):
        size += len(part)
        digest.update(part)
        if target is not None:
            target.write(part)
    return digest.hexdigest(), size


def place_of(name: str, root: Path) -> Path:
    """Return where in the folder `root` a file lies that the bundle calls `name`."""
    return root / PurePosixPath(name).relative_to(INPUTS)


def task_in(run: RunKeys, manifest: Manifest, root: Path) -> Task:
    """Return what a run of a bundle asks for with the inputs in the folder `root`, and without anything that is written.

    Raises ScenarioError for a command that leads elsewhere, and for inputs that do.
    """
    places = {one.name: str(place_of(one.name, root)) for one in manifest.inputs}
    try:
        words = shlex.split(run.command)
    except ValueError:
        words = []
    if len(words) <= _SOURCE or words[_SOURCE] not in places or words[_SOURCE].endswith(".toml"):
        raise ScenarioError(f"not a run of a configuration in the bundle: {run.command}")
    words[_SOURCE] = places[words[_SOURCE]]
    task = task_of(shlex.join(words))
    scenario = task.scenario
    _require_harmless(scenario.sumo_options, root)
    asked = relocated(scenario.sumo_options, lambda name: places.get(name, name))
    quiet = option_words(silenced(read_config(scenario.config).options))
    return replace(task, scenario=replace(scenario, sumo_options=(*asked, *quiet)))


def relocated(words: Iterable[str], place: Callable[[str], str]) -> Iterator[str]:
    """Yield options for SUMO with every path in them, alone or in a list, as `place` has it."""
    for word in words:
        option, split, value = word.rpartition("=") if word.startswith("-") else ("", "", word)
        yield option + split + ",".join(map(place, value.split(",")))


def require_closed(task: Task, root: Path) -> None:
    """Raise ScenarioError if what a task reads, or a path in it, lies outside the folder `root`."""
    scenario = task.scenario
    for file in (scenario.config, *inputs_of(scenario.config, words_of(scenario.sumo_options)).files):
        if not file.resolve().is_relative_to(root.resolve()):
            raise ScenarioError(f"{file}: lies outside the bundle, though '{scenario.config.name}' needs it")
        if outside := path_outside(file, root):
            raise ScenarioError(f"{file.relative_to(root)}: '{outside}' leads out of the bundle: let it be a relative path")


def _require_harmless(options: Sequence[str], root: Path) -> None:
    given = given_options(options)
    for name in given:
        if name in OUTPUT_FILES or name in INSTEAD_OF_RUNNING or name == "configuration-file":
            raise ScenarioError(f"SUMO option '{name}' is none that a bundle may give")
    for word in options:
        if leads_out(word.partition("=")[2] or word, root, root):
            raise ScenarioError(f"SUMO option '{word}' leads out of the bundle")


def _require_same(one: InputKeys, sha256: str, size: int, place: str) -> None:
    if (sha256, size) != (one.sha256, one.bytes):
        raise ScenarioError(f"{place}: not the file that was driven with: its digest differs")
