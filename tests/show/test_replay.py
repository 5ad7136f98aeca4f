"""The replay: what the record keeps of the surroundings, what the page makes of it, and that damaged ones are refused."""

import base64
import gzip
import json
import re
from pathlib import Path

import duckdb
import numpy as np
import pytest
from helpers.browser import BROWSER, NO_BROWSER, browsed

from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.recorder import Recorder
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.lab.surroundings_record import SURROUNDINGS, USERS
from sumo_reactive.show.recording import read_run, read_steps
from sumo_reactive.show.replay import payload_of, replay_of
from sumo_reactive.show.reports import page_of

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def scenes():
    """The scenes of a trip through a light, and its result."""
    found = []
    result = run_trial(load_scenario(ROOT / "scenarios" / "signalised_left_turns.toml"), observer=found.append)
    return found, result


@pytest.fixture
def record(tmp_path, scenes):
    """Its record."""
    found, result = scenes
    recorder = Recorder(tmp_path / "run")
    for scene in found:
        recorder.see(scene)
    recorder.write(result)
    return tmp_path / "run"


def told(record):
    """Return what the player gets."""
    recording = read_run(record)
    return payload_of(recording, read_steps(recording))


def test_everybody_is_where_he_was_seen(record, scenes):
    found, _ = scenes
    rows = duckdb.sql(f"SELECT \"user\", x_m, y_m, speed_m_s FROM '{record / USERS}' ORDER BY time_s").fetchall()
    expected = [user for scene in found for user in {u.id: u for u in (*scene.users, *scene.beside)}.values()]
    assert len(rows) == len(expected) > 1000
    assert sorted(rows)[0][0] == min(user.id for user in expected)
    assert np.isclose(sum(row[1] for row in rows), sum(user.x for user in expected), rtol=1e-5)


def test_the_record_of_a_trip_stays_small(record, scenes):
    found, _ = scenes
    size = sum((record / name).stat().st_size for name in (USERS, SURROUNDINGS))
    assert size * 600.0 / (found[-1].step.time - found[0].step.time) < 20e6


def test_the_field_is_that_of_the_kernel_which_chose(scenes):
    found, _ = scenes
    decided = [scene for scene in found if scene.field is not None and scene.field() is not None]
    assert len(decided) > 20
    chosen = 0
    for scene in decided:
        field, step = scene.field(), scene.step
        i = int(np.abs(field.accelerations - step.command_acceleration).argmin())
        j = int(np.abs(field.steering_rates - step.command_steering_rate).argmin())
        is_node = abs(field.accelerations[i] - step.command_acceleration) < 1e-9
        if is_node and abs(field.steering_rates[j] - step.command_steering_rate) < 1e-9:
            assert field.potentials[i, j] == step.u
            chosen += 1
        assert step.u <= field.potentials.min() + 1e-9 or step.emergency  # the finer lattices do no worse
    assert chosen >= 10


def test_the_player_gets_what_the_record_holds(record, scenes):
    found, _ = scenes
    data = told(record)
    assert len(data["times"]) == len(data["users"]["steps"]) == len(found)
    assert any(label.startswith("red: ") for _, some in data["constraints"] for *_, label in some)
    assert {name for _, letters in data["letters"] for name in letters} == {light[0] for light in data["lights"]}
    assert data["ego"]["length"] == read_run(record).summary["length_m"]
    assert all(len(row) % 5 == 0 for row in data["users"]["steps"])


def test_the_page_holds_the_data_packed_and_no_name_breaks_out_of_it(record):
    text = (record / SURROUNDINGS).read_text(encoding="utf-8")
    hostile = text.replace('"the light is red","', '"the light is red","</script><b>red')
    (record / SURROUNDINGS).write_text(hostile, encoding="utf-8")
    page = page_of(record, record / "report.html")
    packed = re.search(r'<script type="text/plain" id="replay-data">([A-Za-z0-9+/=]+)</script>', page)[1]
    assert "</script><b>" in gzip.decompress(base64.b64decode(packed)).decode()
    assert "<b>red" not in page


def test_an_older_record_has_a_page_without_a_replay(record):
    (record / SURROUNDINGS).unlink()
    assert replay_of(read_run(record), read_steps(read_run(record))) is None
    assert 'id="replay"' not in page_of(record, record / "report.html")


@pytest.mark.parametrize(
    ("name", "text", "place"),
    [
        (SURROUNDINGS, "{}", "version"), (SURROUNDINGS, "[", "surroundings.json"), (USERS, "nothing", "users.parquet"),
    ],
)  # fmt: skip
def test_damaged_surroundings_are_refused_by_name(record, name, text, place):
    (record / name).write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError, match=place):
        told(record)


def test_surroundings_of_another_version_are_refused(record):
    data = json.loads((record / SURROUNDINGS).read_text(encoding="utf-8"))
    (record / SURROUNDINGS).write_text(json.dumps(data | {"version": 99}), encoding="utf-8")
    with pytest.raises(ScenarioError, match="of version 99"):
        told(record)


PLAYED = """<script>
addEventListener("load", () => setTimeout(async () => {
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const player = document.getElementById("replay-player"), part = (name) => player.querySelector(`[data-part="${name}"]`);
  const clock = () => parseFloat(part("clock").textContent), seen = { ready: player.dataset.ready, begin: clock() };
  part("play").click();
  await wait(1500);
  part("play").click();
  seen.played = clock();
  seen.frames = player.dataset.frames;
  seen.label = part("play").textContent;
  document.querySelector("#decisions tbody tr:nth-child(5)").click();
  await wait(200);
  seen.went = clock();
  seen.row = parseFloat(document.querySelector("#decisions tbody tr:nth-child(5)").cells[0].textContent);
  seen.said = part("said").textContent;
  part("map").dispatchEvent(new KeyboardEvent("keydown", { key: "." }));
  await wait(200);
  seen.next = clock();
  const box = part("map").getBoundingClientRect();
  seen.size = [box.width, box.height];
  document.body.dataset.seen = JSON.stringify(seen);
}, 1500));
</script>"""


@pytest.mark.skipif(BROWSER is None, reason=NO_BROWSER)
def test_the_player_plays_goes_to_a_decision_and_says_it(record, tmp_path):
    page = record / "report.html"
    page.write_text(page_of(record, page), encoding="utf-8")
    seen, console = browsed(page, tmp_path, PLAYED, "seen")
    assert console == []
    assert seen["ready"] == "yes"
    assert seen["played"] > seen["begin"] + 0.5
    assert int(seen["frames"]) > 20
    assert seen["went"] == seen["row"]
    assert seen["said"].startswith(f"{seen['row']:.1f} s")
    assert seen["next"] > seen["went"]
    assert min(seen["size"]) > 200
