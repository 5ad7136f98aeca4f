"""What a bundle says of itself, in `manifest.json`: its runs, the files that they need, the versions that drove them."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Annotated

from pydantic import AfterValidator, Field

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.schema import Keys, checked, require_version

MANIFEST = "manifest.json"
"""The file in a bundle that names all others."""

BUNDLE_VERSION = 1
"""Version of the keys below; a bundle of another is refused."""

INPUTS, RECORD = "inputs", "record"
"""Folders in a bundle: what the runs read, and what they wrote."""

MOST_BYTES = 2**33
"""No bundle holds more, unpacked: 8 GB."""

_SHA256 = r"[0-9a-f]{64}"


def _name_within(name: str) -> str:
    """Return a name that leads to no other folder than the bundle's own, on any system."""
    parts = PurePosixPath(name).parts
    is_plain = name.isprintable() and not set(name) & set('\\:*?"<>|') and str(PurePosixPath(name)) == name
    if not is_plain or len(parts) < 2 or parts[0] != INPUTS or ".." in parts:
        raise ValueError(f"'{name}' is no name of a file below '{INPUTS}'")
    return name


class InputKeys(Keys):
    """A file that runs read: its name in the bundle, its digest and its size."""

    name: Annotated[str, AfterValidator(_name_within)]
    sha256: Annotated[str, Field(pattern=f"^{_SHA256}$")]
    bytes: Annotated[int, Field(ge=0, le=MOST_BYTES)]


class RunKeys(Keys):
    """A run: the command that drives it in the unpacked bundle, and the digest of its steps."""

    command: Annotated[str, Field(min_length=1)]
    trajectory: Annotated[str, Field(pattern=f"^{_SHA256}$")]


class Manifest(Keys):
    """`manifest.json`: `has_inputs` whether the files are in the bundle, else their digests alone are known.

    `versions` are those of this package, SUMO and the libraries that numbers depend on, each set of them once.
    """

    version: int
    versions: list[dict[str, str]]
    seeds: list[int]
    runs: Annotated[list[RunKeys], Field(min_length=1)]
    has_inputs: bool
    inputs: Annotated[list[InputKeys], Field(min_length=1)]


class _VersionKeys(Keys):
    version: int


def manifest_of(text: bytes, place: str) -> Manifest:
    """Return what a `manifest.json` says; raise ScenarioError for another version, or for what is none."""
    require_version(checked(text, _VersionKeys, place, "the manifest of a bundle").version, BUNDLE_VERSION, place)
    found = checked(text, Manifest, place, "the manifest of a bundle")
    if len({one.name.casefold() for one in found.inputs}) < len(found.inputs):
        raise ScenarioError(f"{place}: not the manifest of a bundle: two inputs have one name")
    if sum(one.bytes for one in found.inputs) > MOST_BYTES:
        raise ScenarioError(f"{place}: more than {MOST_BYTES / 1e9:.1f} GB of inputs")
    return found
