"""Every file has a version, which is raised when its keys or columns change, and one of another version is refused."""

import hashlib
import json
import typing
from dataclasses import fields

import duckdb
import pytest
from helpers.recordings import made_record, step
from pydantic import BaseModel

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.batch.store_file import STORE_TABLES
from sumo_reactive.lab.batch.store_file import VERSION as STORE_VERSION
from sumo_reactive.lab.bundle.manifest import BUNDLE_VERSION, Manifest
from sumo_reactive.lab.columns import STEP_COLUMNS
from sumo_reactive.lab.comparison.record import COMPARISON_VERSION, CSV_MEANINGS, JSON_FILE, JSON_MEANINGS
from sumo_reactive.lab.comparison.recorded import PairKeys, SideKeys, read_comparison
from sumo_reactive.lab.metrics.safety.series import ENCOUNTER_MEANINGS
from sumo_reactive.lab.recorder import FLEET, FLEET_MEANINGS, SUMMARY, TRAJECTORY, read_fleet
from sumo_reactive.lab.result import TrialResult
from sumo_reactive.lab.schema import RECORD_VERSION
from sumo_reactive.lab.surroundings_record import SURROUNDINGS_MEANINGS, USER_MEANINGS
from sumo_reactive.lab.trace import EntryKeys
from sumo_reactive.show.recording import read_run


def keys_of(keys, place=""):
    """Yield the path of each key of a table, and of those in its tables and lists of tables."""
    for name, field in keys.model_fields.items():
        path = f"{place}{field.alias or name}"
        yield path
        for inner in (field.annotation, *typing.get_args(field.annotation)):
            if isinstance(inner, type) and issubclass(inner, BaseModel):
                yield from keys_of(inner, f"{path}.")


SHAPES = {
    "record": (
        RECORD_VERSION,
        [
            [field.name for field in fields(TrialResult)], [(one.name, one.kind.__name__) for one in STEP_COLUMNS.values()],
            [*ENCOUNTER_MEANINGS], [*USER_MEANINGS], [*SURROUNDINGS_MEANINGS], [*FLEET_MEANINGS], [*keys_of(EntryKeys)],
        ],
    ),
    "comparison": (
        COMPARISON_VERSION,
        [[*JSON_MEANINGS], [*CSV_MEANINGS], [*keys_of(PairKeys)], [*keys_of(SideKeys)]],
    ),
    "store": (STORE_VERSION, STORE_TABLES),
    "bundle": (BUNDLE_VERSION, [*keys_of(Manifest)]),
}  # fmt: skip
"""What each kind of file holds."""

KNOWN = {
    "record": (4, "4fec0b2c942cc45e"),
    "comparison": (1, "a38044ef41c3d21e"),
    "store": (2, "a6e956dadfa42ee2"),
    "bundle": (1, "966ac041fec91487"),
}
"""The version that each was given with that shape."""


@pytest.mark.parametrize("kind", SHAPES)
def test_another_shape_has_another_version(kind):
    version, shape = SHAPES[kind]
    digest = hashlib.sha256(json.dumps(shape, sort_keys=True).encode()).hexdigest()[:16]
    assert (version, digest) == KNOWN[kind], f"raise the version of a {kind}, and note it here with its shape"


@pytest.fixture
def record(tmp_path):
    return made_record(tmp_path / "record", [step(0), step(1)])


def older(file, **changes):
    """Let a JSON file be of no version, but for `changes`."""
    told = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    told.pop("version", None)
    file.write_text(json.dumps(told | changes), encoding="utf-8")


def test_a_record_of_another_version_is_refused(record):
    older(record / SUMMARY)
    with pytest.raises(ScenarioError, match=rf"summary\.json: of version 0, and this release reads {RECORD_VERSION}"):
        read_run(record)


def test_a_record_of_several_egos_of_another_version_is_refused(tmp_path):
    older(tmp_path / FLEET, egos=[], refused=[], version=99)
    with pytest.raises(ScenarioError, match=rf"fleet\.json: of version 99, and this release reads {RECORD_VERSION}"):
        read_fleet(tmp_path)


def test_a_comparison_of_another_version_is_refused(tmp_path):
    older(tmp_path / JSON_FILE, drivers=["sumo", "reactive"], pairs=[])
    with pytest.raises(ScenarioError, match=rf"comparison\.json: of version 0, and this release reads {COMPARISON_VERSION}"):
        read_comparison(tmp_path)


def test_a_parquet_file_tells_its_version_and_the_units_of_its_columns(record):
    query = f"SELECT decode(key), decode(value) FROM parquet_kv_metadata('{record / TRAJECTORY}')"
    told = dict(duckdb.sql(query).fetchall())
    units = json.loads(told["units"])
    assert told["version"] == str(RECORD_VERSION)
    assert (units["time_s"], units["acceleration_m_s2"], units["steering_angle_rad"]) == ("s", "m/s²", "rad")
    assert "lane_id" not in units and "emergency" not in units
