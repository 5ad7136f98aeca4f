"""Equipment of vehicles, in SUMO's own convention for devices: `<param key="has.reactive.device" value="true"/>`."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree.ElementTree import iterparse

import libsumo

from sumo_reactive.errors import ScenarioError
from sumo_reactive.files import content_of, is_there
from sumo_reactive.sumo.config import SumoConfig, is_true, xml_read

HAS_DEVICE = "has.reactive.device"
"""A `<param>` of a vehicle, trip, flow or type: "true" or "false"."""

PROBABILITY = "device.reactive.probability"
"""A `<param>` of the same: share of those so equipped, 0 to 1."""

_OF_VEHICLES = ("vehicle", "trip", "flow")
_FALSE = ("false", "0", "no", "off", "-", "f")


class Equipment:
    """Which vehicles are equipped with this driver, by what files and types say of them.

    SUMO answers for types, but not for a single vehicle's device that it does not know: those are read from the files.
    """

    def __init__(self, config: SumoConfig) -> None:
        self.is_named = config.mentions((HAS_DEVICE.encode(), PROBABILITY.encode()))
        files = (*config.route_files, *config.additional_files) if self.is_named else ()
        self._shares = dict(share for file in files if is_there(file) for share in _in_file(file))
        self._of_types: dict[str, float | None] = {}

    def share(self, vehicle_id: str) -> float | None:
        """Return the probability that a vehicle in the simulation is equipped; None where nothing is said of it."""
        if not self.is_named:
            return None
        of_vehicle = self._shares.get(vehicle_id, self._shares.get(vehicle_id.rpartition(".")[0]))
        return self._of_type(str(libsumo.vehicle.getTypeID(vehicle_id))) if of_vehicle is None else of_vehicle

    def _of_type(self, name: str) -> float | None:
        if name not in self._of_types:
            said = {key: str(libsumo.vehicletype.getParameter(name, key)) for key in (HAS_DEVICE, PROBABILITY)}
            self._of_types[name] = _share(said, f"vType '{name}'")
        return self._of_types[name]


def _in_file(file: Path) -> Iterator[tuple[str, float]]:
    """Yield the share for each vehicle, trip or flow of which a file says one."""
    with xml_read(file):
        for _, node in iterparse(io.BytesIO(content_of(file))):
            if node.tag in _OF_VEHICLES:
                said = {param.get("key", ""): param.get("value", "") for param in node.findall("param")}
                share = _share(said, f"{file}: {node.tag} '{node.get('id')}'")
                if share is not None:
                    yield node.get("id", ""), share
                node.clear()


def _share(said: Mapping[str, str], place: str) -> float | None:
    """Return the share that the parameters of one thing state."""
    has, text = said.get(HAS_DEVICE, "").strip(), said.get(PROBABILITY, "").strip()
    if has:
        if not is_true(has) and has.lower() not in _FALSE:
            raise ScenarioError(f"{place}: {HAS_DEVICE} is '{has}', neither true nor false")
        return float(is_true(has))
    if not text:
        return None
    try:
        share = float(text)
    except ValueError:
        share = -1.0
    if not 0.0 <= share <= 1.0:
        raise ScenarioError(f"{place}: {PROBABILITY} is '{text}', not a number within 0 and 1")
    return share
