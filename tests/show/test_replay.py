"""The replay: what the record keeps of the surroundings, what the page makes of it, and that damaged ones are refused."""

import base64
import gzip
import json
import math
import re
import shutil
from pathlib import Path

import duckdb
import numpy as np
import pytest
from helpers.browser import BROWSER, NO_BROWSER, browsed
from helpers.programs import sumo_reactive

from sumo_reactive.driver.nouns.decision import Occupancy
from sumo_reactive.errors import ScenarioError
from sumo_reactive.lab.recorder import SUMMARY, Recorder
from sumo_reactive.lab.scenario import load_scenario
from sumo_reactive.lab.simulation import run_trial
from sumo_reactive.lab.surroundings_record import RECORDED_M, SURROUNDINGS, USERS, SurroundingsRecord
from sumo_reactive.lab.under_way import PROCESS
from sumo_reactive.show import replay
from sumo_reactive.show.recording import read_run, read_steps
from sumo_reactive.show.replay import payload_of, replay_of, room_told
from sumo_reactive.show.reports import page_of

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """The scenes of a trip through a light, who was around in each, and its record with every field."""
    found, around = [], []
    folder = tmp_path_factory.mktemp("driven") / "run"
    recorder = Recorder(folder, every_field=True)

    def see(scene):
        found.append(scene)
        around.append(scene.around())
        recorder.see(scene)

    recorder.write(run_trial(load_scenario(ROOT / "scenarios" / "signalised_left_turns.toml"), observer=see))
    return found, around, folder


@pytest.fixture(scope="module")
def scenes(driven):
    """The scenes of the trip."""
    return driven[0]


@pytest.fixture
def record(tmp_path, driven):
    """A copy of its record."""
    return Path(shutil.copytree(driven[2], tmp_path / "run"))


def told(record):
    """Return what the player gets."""
    recording = read_run(record)
    return payload_of(recording, read_steps(recording))


def test_everybody_within_sight_is_recorded_where_he_was_with_his_signals(record, driven):
    found, around, _ = driven
    rows = duckdb.sql(f"SELECT time_s, \"user\", x_m, y_m, speed_m_s, signals FROM '{record / USERS}'").fetchall()
    for scene, some in list(zip(found, around, strict=True))[::50]:
        assert max(math.dist((one.x, one.y), (scene.step.x, scene.step.y)) for one in some) < RECORDED_M
        kept = {row[1]: row[2:5] for row in rows if abs(row[0] - scene.step.time) < 1e-3}
        assert kept.keys() == {one.id for one in (*some, *scene.users, *scene.beside)}
        assert {one.id: kept[one.id] for one in some} == {
            one.id: pytest.approx((one.x, one.y, one.speed), abs=1e-3) for one in some
        }
    assert all(any(row[-1] & bit for row in rows) for bit in (1, 2, 8))


def test_u_on_the_ground_is_least_along_c_and_none_where_there_would_be_a_contact(record, scenes):
    grounds = told(record)["grounds"]
    decided = [scene for scene in scenes if scene.step.pilot]
    assert len(grounds) == len(decided) > 10
    contacts = 0
    for (time, _, ahead, left, rows), scene in zip(grounds, decided, strict=True):
        assert time == pytest.approx(scene.step.time, abs=1e-3)
        contacts += sum(u is None for row in rows for u in row)
        if not scene.users and abs(scene.step.d) < 0.1:
            row = rows[ahead.index(0.0)]
            assert row.index(min(row)) == left.index(0.0)
    assert contacts


def test_the_shadows_of_whom_the_ego_heeds_are_recorded_and_no_others(record, scenes):
    recorded = dict(json.loads((record / SURROUNDINGS).read_text(encoding="utf-8"))["shadows"])
    assert len(recorded) == len(scenes)
    for scene in scenes:
        cast = recorded[round(scene.step.time, 3)]
        assert (scene.step.u2 == 0.0) or cast
        assert all(user and weight > 0.0 for user, weight, _ in cast)
    assert {len(shadows) for shadows in recorded.values()} >= {0, 1}
    kept = SurroundingsRecord()
    for scene in scenes:
        kept.see(scene._replace(around=None))
    assert len(kept.told()["shadows"]) == len([scene for scene in scenes if scene.step.pilot])


def test_every_field_is_kept_on_request_and_else_those_of_decisions(tmp_path, scenes, record):
    assert len(told(record)["fields"]) > 2 * len([scene for scene in scenes if scene.step.pilot])
    kept = SurroundingsRecord()
    for scene in scenes:
        kept.see(scene._replace(around=None))
    kept.write_into(tmp_path)
    written = json.loads((tmp_path / SURROUNDINGS).read_text(encoding="utf-8"))
    assert [field[0] for field in written["fields"]] == [round(s.step.time, 3) for s in scenes if s.step.pilot and s.field()]
    assert written["grounds"] == []


def test_the_record_of_a_trip_stays_small(record, scenes):
    found = scenes
    size = sum((record / name).stat().st_size for name in (USERS, SURROUNDINGS))
    assert size * 600.0 / (found[-1].step.time - found[0].step.time) < 20e6


def test_five_minutes_fit_a_page_of_six_megabytes(record, scenes):
    page = page_of(record, record / "report.html")
    library = len(re.search(r'data-kind="library">([^<]+)<', page)[1])
    assert library + (len(page) - library) * 300.0 / (scenes[-1].step.time - scenes[0].step.time) < 6e6


def test_the_field_is_that_of_the_kernel_which_chose(scenes):
    decided = [scene for scene in scenes if scene.step.pilot and scene.field() is not None]
    assert len(decided) > 20
    chosen = 0
    for scene in decided:
        field, step = scene.field(), scene.step
        i = int(np.abs(field.accelerations - step.command_acceleration).argmin())
        j = int(np.abs(field.steering_rates - step.command_steering_rate).argmin())
        is_node = abs(field.accelerations[i] - step.command_acceleration) < 1e-9
        if is_node and abs(field.steering_rates[j] - step.command_steering_rate) < 1e-9:
            stays = step.speed == 0.0 and step.command_acceleration == 0.0  # then there is nothing to choose
            assert step.u == (0.0 if stays else field.potentials[i, j])
            chosen += not stays
        assert step.u <= field.potentials.min() + 1e-9 or step.emergency  # the finer lattices do no worse
    assert chosen >= 10


def test_the_player_gets_what_the_record_holds(record, scenes):
    found, data = scenes, told(record)
    assert len(data["times"]) == len(found)
    assert any(label.startswith("red: ") for _, some in data["constraints"] for *_, label in some)
    assert {name for _, letters in data["letters"] for name in letters} == {light[0] for light in data["lights"]}
    assert data["ego"]["length"] == read_run(record).summary["length_m"]


def test_the_tracks_of_the_player_are_who_was_where_at_every_step(record):
    data, found = told(record), set()
    for user, first, *columns in data["users"]["tracks"]:
        places = zip(*(np.cumsum(np.cumsum(column)).tolist() for column in columns), strict=True)
        found |= {(data["users"]["ids"][user], first + k, *place) for k, place in enumerate(places)}
    columns, units = '"user", time_s, x_m, y_m, heading_rad, speed_m_s, signals', (100, 100, 1000, 100, 1)
    rows = duckdb.sql(f"SELECT {columns} FROM '{record / USERS}'").fetchall()
    step = {round(time, 2): k for k, time in enumerate(data["times"])}
    assert found == {
        (name, step[round(time, 2)], *(round(one * unit) for one, unit in zip(place, units, strict=True)))
        for name, time, *place in rows
    }
    assert len(data["users"]["tracks"]) < len(found) / 20


def test_a_post_conflict_region_is_on_c_and_says_who_takes_it(record, scenes):
    told_rooms = told(record)["rooms"]
    taken = [room for _, some in told_rooms for room in some if room[1] == "occupied"]
    assert {room[1] for _, some in told_rooms for room in some} == {"free", "occupied", "held by the ego"}
    assert all("stops before connection from_south_1->to_west_1, since west_north.1" in room[2] for room in taken)
    step = next(scene.step for scene in scenes if any(room.waits for room in scene.step.rooms))
    assert {room.cause for room in step.rooms} & {decision.cause for decision in step.decisions}
    assert all(min(math.dist(room[0][:2], point) for point in zip(curve[::2], curve[1::2], strict=True)) < 2.0
               for time, some in told_rooms for room in some
               for _, curve in [next(one for one in reversed(told(record)["curves"]) if one[0] <= time)])  # fmt: skip


@pytest.mark.parametrize(
    ("room", "colour", "sentence"),
    [
        (("a->b", [], Occupancy.OCCUPIED, "x", True), "occupied", "taken: the ego stops before connection a->b, since x"),
        (("a->b", [], Occupancy.FREE, "x", True), "claimed by another", "it would have to stop for x in the room behind"),
        (("a->b", [], Occupancy.OWN, "", False), "held by the ego", "behind connection a->b is held by the ego"),
    ],
)
def test_a_click_on_a_post_conflict_region_says_its_state(room, colour, sentence):
    found = room_told(room)
    assert found[0] == colour and sentence in found[1]


def test_the_player_knows_a_colour_for_every_state():
    script = Path(replay.__file__).with_name("replay.js").read_text(encoding="utf-8")
    colours = re.search(r"const STATES = \{(.*)\}", script)[1]
    assert all(re.search(rf'(^|[ "]){one.value}"?: "rgba', colours) for one in Occupancy)


def test_the_page_holds_the_data_packed_and_no_name_breaks_out_of_it(record):
    text = (record / SURROUNDINGS).read_text(encoding="utf-8")
    hostile = text.replace('"the light is red","', '"the light is red","</script><b>red')
    (record / SURROUNDINGS).write_text(hostile, encoding="utf-8")
    page = page_of(record, record / "report.html")
    packed = re.search(r'<script type="text/plain" data-kind="replay">([A-Za-z0-9+/=]+)</script>', page)[1]
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


CLICKED = """<script>
addEventListener("load", () => setTimeout(async () => {
  const wait = (ms) => new Promise((done) => setTimeout(done, ms)), [time, ahead, up] = WHERE, seen = [];
  const player = document.getElementById("replay-player"), part = (name) => player.querySelector(`[data-part="${name}"]`);
  const map = part("map"), box = map.getBoundingClientRect(), PX_PER_M = 6;
  map.setPointerCapture = () => {};
  part("time").value = time;
  part("time").dispatchEvent(new Event("input"));
  await wait(200);
  for (const side of [0, 60]) {
    const x = box.left + box.width / 2 + PX_PER_M * ahead, y = box.top + box.height / 2 - PX_PER_M * (up + side);
    for (const kind of ["pointerdown", "pointerup"]) map.dispatchEvent(new PointerEvent(kind, { clientX: x, clientY: y }));
    seen.push(part("about").textContent);
  }
  document.body.dataset.seen = JSON.stringify(seen);
}, 1500));
</script>"""


def taken_room(data):
    """Return when a post-conflict region is taken, a place of it from the ego, m, where nobody else is, and its sentence."""
    for time, some in data["rooms"]:
        k = int(np.searchsorted(data["times"], time))
        ego, others = (data["ego"]["x"][k], data["ego"]["y"][k]), []
        for _, first, xs, ys, *_ in data["users"]["tracks"]:
            if first <= k < first + len(xs):
                others.append(tuple(float(np.cumsum(np.cumsum(column))[k - first]) / 100 for column in (xs, ys)))
        for line, state, sentence in some:
            for place in zip(line[::2], line[1::2], strict=True):
                is_alone = all(math.dist(place, other) > 8.0 for other in others)
                if state == "occupied" and is_alone and math.dist(place, ego) < 30.0:
                    return data["times"][k], place[0] - ego[0], place[1] - ego[1], sentence
    raise AssertionError("no post-conflict region is taken")


@pytest.mark.skipif(BROWSER is None, reason=NO_BROWSER)
def test_a_click_on_a_post_conflict_region_tells_its_state_in_the_browser(record, tmp_path):
    page = record / "report.html"
    page.write_text(page_of(record, page), encoding="utf-8")
    *where, sentence = taken_room(told(record))
    seen, console = browsed(page, tmp_path, CLICKED.replace("WHERE", json.dumps(where)), "seen")
    assert console == [] and sentence in seen[0] and sentence not in seen[1]


def test_run_keeps_every_field_on_request_and_only_in_a_folder(tmp_path):
    scenario = str(ROOT / "scenarios" / "blocked_lane.toml")
    assert "there is no --out" in sumo_reactive("run", scenario, "--record", "field").stderr
    answer = sumo_reactive("run", scenario, "--record", "field", "--out", str(tmp_path / "run"), "-q")
    assert answer.returncode == 0, answer.stderr
    data = told(tmp_path / "run")
    assert data["grounds"] and len(data["fields"]) > 0.8 * len(data["times"])


LEFT_AND_FOUND = """<script>
addEventListener("load", () => setTimeout(() => {
  const player = document.getElementById("replay-player"), part = (name) => player.querySelector(`[data-part="${name}"]`);
  const visits = Number(sessionStorage.getItem("visits") || 0) + 1, clock = () => parseFloat(part("clock").textContent);
  sessionStorage.setItem("visits", visits);
  if (visits === 1) {
    sessionStorage.setItem("first", clock());
    part("time").value = Number(part("time").min) + 1;
    part("time").dispatchEvent(new Event("input"));
    part("names").click();
  } else {
    Object.defineProperty(document, "hidden", { get: () => true });
    const seen = { visits, first: Number(sessionStorage.getItem("first")), now: clock(), begin: Number(part("time").min),
      end: Number(part("time").max), names: part("names").getAttribute("aria-pressed") };
    document.body.dataset.seen = JSON.stringify(seen);
  }
}, 700));
</script>"""


@pytest.mark.skipif(BROWSER is None, reason=NO_BROWSER)
def test_the_page_of_a_run_that_drives_is_opened_at_its_end_and_again_where_it_was_left(record, tmp_path):
    summary = json.loads((record / SUMMARY).read_text(encoding="utf-8"))
    (record / SUMMARY).write_text(json.dumps(summary | {PROCESS: [1, 0.0]}), encoding="utf-8")
    page = tmp_path / "page.html"
    page.write_text(page_of(record, page), encoding="utf-8")
    seen, console = browsed(page, tmp_path, LEFT_AND_FOUND, "seen")
    assert console == [] and seen["visits"] == 2
    assert seen["first"] == pytest.approx(seen["end"], abs=0.06) and seen["names"] == "true"
    assert seen["now"] == pytest.approx(seen["begin"] + 1.0, abs=0.06)
