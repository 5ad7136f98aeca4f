"""Which folder an ego's record has among those of the others: ids are names, whatever they hold, and not paths."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection
from pathlib import Path
from urllib.parse import quote

from sumo_reactive.errors import ScenarioError

FLEET = "fleet.json"

_LONGEST, _KEPT = 100, 80
"""Letters of a folder's name at most, and how many of a longer one stay before its digest."""

_SYSTEM_NAMES = {"con", "prn", "aux", "nul", *(f"{port}{k}" for port in ("com", "lpt") for k in range(1, 10))}
"""What is a device on some systems, with whatever suffix."""


class EgoFolders:
    """A folder's name for each ego id: two ids never share one, also where a file system does not tell capitals apart.

    A name is the id with all but letters, digits and `._-` percent-encoded; where it is too long, or another's but for
    capitals, it ends with `~` and a digest of the id. `taken` are names of files beside the folders.
    """

    def __init__(self, taken: Collection[str]) -> None:
        self._taken = {name.casefold() for name in taken}
        self._names: dict[str, str] = {}

    def of(self, ego_id: str) -> str:
        """Return the name of an ego's folder, the same every time."""
        if ego_id not in self._names:
            name = _encoded(ego_id)
            if len(name) > _LONGEST or name.casefold() in self._taken:
                digest = hashlib.sha256(ego_id.encode("utf-8", errors="surrogatepass")).hexdigest()
                name = f"{name[:_KEPT]}~{digest[:16]}"
            self._taken.add(name.casefold())
            self._names[ego_id] = name
        return self._names[ego_id]


def _encoded(ego_id: str) -> str:
    name = quote(ego_id, safe="", errors="surrogatepass").replace("~", "%7E")
    if name.startswith(".") or name.partition(".")[0].casefold() in _SYSTEM_NAMES:
        name = f"%{ord(name[0]):02X}{name[1:]}"
    return f"{name[:-1]}%2E" if name.endswith(".") else name or "%"


def is_folder_name(name: object) -> bool:
    """Whether a record's word for an ego's folder is the name of one in the record's own folder."""
    return isinstance(name, str) and name not in ("", ".", "..") and not any(sign in name for sign in "/\\\0")


def folders_in(fleet: Path) -> list[str]:
    """Return the folders of the egos that a `fleet.json` names; raise ScenarioError if it is none."""
    try:
        if not fleet.is_file():
            raise ValueError("not a file")
        names = [one["folder"] for one in json.loads(fleet.read_text(encoding="utf-8"))["egos"]]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        raise ScenarioError(f"{fleet}: not the record of several egos: {error}") from error
    if not all(map(is_folder_name, names)):
        raise ScenarioError(f"{fleet}: not the record of several egos: an ego's folder is no name")
    return names
