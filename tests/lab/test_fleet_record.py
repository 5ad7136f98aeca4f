"""The record of several egos: a folder each, whatever their ids are, and nothing outside the folder asked for."""

import json
from urllib.parse import unquote

import pytest
from helpers.results import result
from hypothesis import given
from hypothesis import strategies as st
from scenes import record

from sumo_reactive.driver.nouns.record import Scene
from sumo_reactive.errors import OutputError, ScenarioError
from sumo_reactive.lab.recorder import EgoFolders, FleetRecorder, Recorder
from sumo_reactive.lab.result import FleetResult

HARD = (
    "..", ".", "", "...", "a/b", "a_b", "a b", "../../x", "/etc", "a\\b", "a\nb", "a\0b", "100%", "%2E%2E", "x" * 300,
    "x" * 301, "Cab", "cab", "CAB", "cab.", "cab ", ".hidden", "fleet.json", "summary.json", "report.html", "Fleet.JSON",
    "NUL", "com1.x", "a~b", "ümlaut", "自动车", "\udc80", "*", "?", '"', "<b>", "|", ":",
)  # fmt: skip
FILES = [
    "decisions.jsonl", "encounters.parquet", "regions.json", "summary.json", "surroundings.json", "trajectory.parquet",
    "users.parquet",
]  # fmt: skip


def fleet_of(*results):
    """Return the result of a run with these egos."""
    return FleetResult(results=results, refused=(), on_their_way=frozenset(), until=60.0, step_us=1.0, wall_s=1.0)


def driven(folder, egos, **options):
    recorder = FleetRecorder(folder, **options)
    for ego in egos:
        recorder.see(Scene(record(0.1, x=1.0), (), ego=ego))
    recorder.write(fleet_of(*(result(ego=ego) for ego in egos)))


def told(folder):
    """Return the folder of each ego as `fleet.json` says."""
    return {one["ego"]: one["folder"] for one in json.loads((folder / "fleet.json").read_text(encoding="utf-8"))["egos"]}


def test_each_ego_gets_a_folder_of_its_own_inside_whatever_its_id_is(tmp_path):
    driven(tmp_path / "out", HARD)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    folders = told(tmp_path / "out")
    assert list(folders) == list(HARD)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(["fleet.json", *folders.values()])
    for ego, folder in folders.items():
        assert sorted(path.name for path in (tmp_path / "out" / folder).iterdir()) == FILES
        summary = json.loads((tmp_path / "out" / folder / "summary.json").read_text(encoding="utf-8"))
        assert summary["ego"] == ego


IDS = st.lists(st.one_of(st.text(), st.text("aA./%~", max_size=4), st.sampled_from(HARD)), unique=True)


@given(IDS)
def test_names_of_folders_are_safe_and_never_alike(ids):
    folders = EgoFolders(("fleet.json",))
    names = [folders.of(one) for one in ids]
    assert len({name.casefold() for name in names} | {"fleet.json"}) == len(ids) + 1
    assert all(name.isascii() and name[0] != "." and name[-1] not in ". " and len(name) <= 100 for name in names)
    assert not any(sign in name for name in names for sign in '/\\:*?"<>|\0\n ')
    assert [folders.of(one) for one in ids] == names
    whole = [(one, name) for one, name in zip(ids, names, strict=True) if "~" not in name]
    assert all(unquote(name, errors="surrogatepass") == (one or "%") for one, name in whole)


def test_an_ordinary_id_is_the_name_of_its_folder():
    folders = EgoFolders(())
    assert [folders.of(name) for name in ("veh_1", "flow.0", "left-5")] == ["veh_1", "flow.0", "left-5"]


def test_overwriting_leaves_nothing_of_the_fleet_before_and_all_that_is_not_of_it(tmp_path):
    out = tmp_path / "out"
    driven(out, ["a", "b", "c/d"])
    (out / "a" / "report.html").touch()
    (out / "report.html").touch()
    (out / "b" / "notes").touch()
    (out / "mine").mkdir()
    driven(out, ["e", "b"], overwrite=True)
    assert sorted(path.name for path in out.iterdir()) == ["b", "e", "fleet.json", "mine"]
    assert sorted(path.name for path in (out / "b").iterdir()) == sorted([*FILES, "notes"])


def test_a_single_run_and_a_fleet_do_not_mix(tmp_path):
    out = tmp_path / "out"
    driven(out, ["a", "b"])
    with pytest.raises(ScenarioError, match=r"holds another run \(fleet\.json\)"):
        Recorder(out)
    Recorder(out, overwrite=True).write(result())
    assert sorted(path.name for path in out.iterdir()) == FILES
    with pytest.raises(ScenarioError, match="holds another run"):
        FleetRecorder(out)
    driven(out, ["a"], overwrite=True)
    assert sorted(path.name for path in out.iterdir()) == ["a", "fleet.json"]


def test_a_folder_of_single_runs_is_no_place_for_a_fleet(tmp_path):
    Recorder(tmp_path / "a").write(result())
    with pytest.raises(ScenarioError, match="a: holds another run"):
        FleetRecorder(tmp_path)


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"egos": [{"folder": "../victim"}]}', "[" * 100_000])
def test_a_damaged_fleet_is_not_overwritten_but_told(tmp_path, text):
    Recorder(tmp_path / "victim").write(result())
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "fleet.json").write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"fleet\.json: not the record of several egos"):
        FleetRecorder(tmp_path / "out", overwrite=True)
    assert sorted(path.name for path in (tmp_path / "victim").iterdir()) == FILES


def test_an_earlier_folder_that_has_become_a_link_is_left_to_where_it_leads(tmp_path):
    out = tmp_path / "out"
    driven(out, ["a"])
    (out / "a").rename(tmp_path / "victim")
    (out / "a").symlink_to(tmp_path / "victim")
    before = (tmp_path / "victim" / "summary.json").read_bytes()
    driven(out, ["a", "b"], overwrite=True)
    assert (tmp_path / "victim" / "summary.json").read_bytes() == before
    assert sorted(path.name for path in (tmp_path / "victim").iterdir()) == FILES
    assert not (out / "a").is_symlink()


def test_a_fleet_that_cannot_be_written_leaves_nothing(tmp_path, monkeypatch):
    def no_room(*_):
        raise OSError(28, "No space left on device")

    recorder = FleetRecorder(tmp_path / "new" / "out")
    monkeypatch.setattr("sumo_reactive.lab.recorder.write_trajectory", no_room)
    with pytest.raises(OutputError, match="out: cannot be written: No space left on device"):
        recorder.write(fleet_of(result(ego="a")))
    assert list(tmp_path.iterdir()) == []
