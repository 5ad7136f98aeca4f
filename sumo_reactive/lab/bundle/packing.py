"""A bundle is made: the record, every file that its runs read or their digests, and the manifest, in one archive."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from pydantic import ValidationError

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.trials import digest_of_files
from sumo_reactive.lab.bundle.manifest import BUNDLE_VERSION, INPUTS, MANIFEST, RECORD, InputKeys, Manifest, RunKeys
from sumo_reactive.lab.bundle.records import Record, read_record
from sumo_reactive.lab.bundle.unpacking import copied, opened_bundle, relocated, require_closed, task_in, unpack_inputs
from sumo_reactive.lab.task import Task, replay_command
from sumo_reactive.sumo.config import OUTPUT_FILES, canonical
from sumo_reactive.sumo.input_files import inputs_of, words_of
from sumo_reactive.writing import whole_file

_BEGIN = (1980, 1, 1, 0, 0, 0)
"""Time of every file in an archive: the same record makes the same bundle."""

_READABLE = 0o644 << 16

Names = Mapping[Path, str]
"""The name in the bundle of each file that runs read."""


def write_bundle(
    path: Path, target: Path, *, has_inputs: bool = True, progress: Callable[[str], None] = lambda name: None
) -> Manifest:
    """Write the bundle of a record to `target`; return what it says of itself. `progress` gets each file's name.

    Without inputs it holds their digests alone. Raises ScenarioError for what is no such record, and for inputs that would
    not lead to the same runs elsewhere; OutputError if it cannot be written.
    """
    record = read_record(path)
    names = _names(record)
    with whole_file(target) as partial:
        with ZipFile(partial, "w") as archive:
            kept = archive if has_inputs else None
            inputs = {name: _packed(kept, file, name, progress) for file, name in names.items()}
            manifest = _manifest(path, record, names, inputs, has_inputs=has_inputs)
            archive.writestr(_entry(MANIFEST), manifest.model_dump_json(indent=2) + "\n")
            for file in record.files:
                _packed(archive, file, f"{RECORD}/{file.name}", progress)
        if has_inputs:
            progress(f"checking {target.name}")
            _require_whole(partial, record)
    return manifest


def _manifest(
    path: Path, record: Record, names: Names, inputs: Mapping[str, tuple[str, int]], *, has_inputs: bool
) -> Manifest:
    """Return the manifest of a record at `path`; raise ScenarioError for what no bundle may say."""
    seeds = sorted({run.task.scenario.seed for run in record.runs})
    try:
        runs = [RunKeys(command=_command(run.task, names), trajectory=run.trajectory) for run in record.runs]
        found = [InputKeys(name=name, sha256=digest, bytes=size) for name, (digest, size) in inputs.items()]
        return Manifest(
            version=BUNDLE_VERSION, versions=list(record.versions), seeds=seeds, runs=runs, has_inputs=has_inputs,
            inputs=found,
        )  # fmt: skip
    except ValidationError as error:
        problem = error.errors()[0]
        raise ScenarioError(f"{path}: cannot be in a bundle: {problem['msg']}: {problem['input']!r}") from error


def _names(record: Record) -> dict[Path, str]:
    """Return the name in the bundle of every file that the runs read: they lie to each other as they did."""
    asked = dict.fromkeys((run.task.scenario.config, words_of(run.task.scenario.sumo_options)) for run in record.runs)
    found = {_place(file) for one in asked for file in (one[0], *inputs_of(*one).files)}
    root = os.path.commonpath([file.parent for file in found])
    return {file: f"{INPUTS}/{file.relative_to(root).as_posix()}" for file in sorted(found)}


def _place(file: Path) -> Path:
    """Return a file's path from the root, with the links in it as they are."""
    return Path(os.path.normpath(file.absolute()))


def _command(task: Task, names: Names) -> str:
    """Return the command of a run as it is given in the unpacked bundle: by the configuration, and without outputs."""
    scenario = task.scenario
    config = Path(names[_place(scenario.config)])
    options = relocated(_without_outputs(scenario.sumo_options), lambda path: names.get(_place(Path(path)), path))
    return replay_command(replace(task, scenario=replace(scenario, source=config, sumo_options=tuple(options))))


def _without_outputs(words: Sequence[str]) -> Iterator[str]:
    is_left_out = False
    for word in words:
        if word.startswith("-"):
            name, is_joined, _ = word.partition("=")
            is_output = canonical(name.lstrip("-")) in OUTPUT_FILES
            is_left_out = is_output and not is_joined
            if not is_output:
                yield word
        elif not is_left_out:
            yield word


def _packed(archive: ZipFile | None, file: Path, name: str, progress: Callable[[str], None]) -> tuple[str, int]:
    """Add a file to the archive, if there is one; return its digest and size."""
    progress(name)
    with file.open("rb") as source:
        if archive is None:
            return copied(source, None)
        with archive.open(_entry(name), "w", force_zip64=True) as target:
            return copied(source, target)


def _entry(name: str) -> ZipInfo:
    entry = ZipInfo(name, _BEGIN)
    entry.compress_type, entry.external_attr = ZIP_DEFLATED, _READABLE
    return entry


def _require_whole(bundle: Path, record: Record) -> None:
    """Raise ScenarioError unless the unpacked bundle asks SUMO for the same as the record's own files."""
    with tempfile.TemporaryDirectory(prefix="sumo_reactive_") as folder, opened_bundle(bundle) as (archive, manifest):
        root = Path(folder).resolve()
        unpack_inputs(archive, manifest, root)
        checked = set()
        for run, packed in zip(record.runs, manifest.runs, strict=True):
            asked, task = run.task.scenario, task_in(packed, manifest, root)
            if (files := (asked.config, words_of(asked.sumo_options))) in checked:
                continue
            checked.add(files)
            require_closed(task, root)
            if digest_of_files(*files) != digest_of_files(task.scenario.config, task.scenario.sumo_options):
                raise ScenarioError(f"{asked.config}: would not read the same files in a bundle")
