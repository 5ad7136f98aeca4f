"""The drawing of a run: what stands in it at a moment, and that it is the same each time."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.recordings import made_record, step

from sumo_reactive.driver.nouns.decision import Behaviour, Decision, Occupancy, Reason, RegionState
from sumo_reactive.errors import ScenarioError
from sumo_reactive.show.film import Cut, frames_of, write_film
from sumo_reactive.show.recording import read_run, read_steps
from sumo_reactive.show.run_drawing import CAR_OVERHANG_M, RunDrawing, Shown, drawn_in_style, save_figure

WAITS = Decision(behaviour=Behaviour.CAUTIOUS, reason=Reason.REGION_OCCUPIED, region="a|b", cause="veh_7", passes=False)
HELD = RegionState("a|b", Occupancy.OCCUPIED, "veh_7")
STEPS = [
    *(step(k, gap=5.0) for k in range(10)),
    *(
        step(k, Behaviour.CAUTIOUS, stop_s=25.0, leader="", gap=float("nan"), decisions=(WAITS,), regions=(HELD,))
        for k in range(10, 20)
    ),
    *(step(k, Behaviour.CROSSING, leader="", gap=float("nan")) for k in range(20, 40)),
]


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    folder = tmp_path_factory.mktemp("record") / "out"
    return read_run(made_record(folder, STEPS, {"a|b": [[26.0, 0.0], [30.0, 0.0], [30.0, 4.0]]}))


@pytest.fixture
def drawing(recording):
    with drawn_in_style():
        yield RunDrawing(recording, Shown())


def lines_of(drawing):
    return {line.get_linestyle(): line for line in drawing.figure.axes[0].lines if line.get_visible()}


def test_the_body_stands_where_the_ego_was(drawing):
    drawing.show(12)
    body = drawing.figure.axes[0].patches[-1].get_xy()
    assert body[:, 0].max() == pytest.approx(12.0)
    assert body[:, 1].mean() == pytest.approx(2.0, abs=0.5)


def test_the_way_driven_ends_where_the_way_ahead_begins(drawing):
    drawing.show(12)
    driven, ahead = drawing.figure.axes[0].lines[:2]
    assert [driven.get_xdata()[-1], ahead.get_xdata()[0], ahead.get_xdata()[-1]] == [12.0, 12.0, 39.0]


def test_the_bar_stands_where_the_front_bumper_is_to_stop(drawing):
    drawing.show(12)
    bar = drawing.figure.axes[0].lines[2]
    assert bar.get_visible()
    assert list(bar.get_xdata()) == pytest.approx([25.0 - CAR_OVERHANG_M] * 2)
    drawing.show(5)
    assert not bar.get_visible()


def test_the_leader_is_named_at_the_end_of_the_gap(drawing):
    drawing.show(3)
    (label,) = drawing.figure.axes[0].texts
    assert label.get_text() == "van, 5.0 m ahead"
    assert label.xy == pytest.approx((8.0, 2.0))
    drawing.show(12)
    assert not label.get_visible()


def test_a_region_is_shown_in_the_state_of_the_last_decision(drawing):
    region = drawing.figure.axes[0].patches[0]
    drawing.show(12)
    assert (region.get_visible(), region.get_hatch()) == (True, "xxxx")
    drawing.show(5)
    assert not region.get_visible()


def test_the_title_tells_behaviour_and_reason(drawing):
    drawing.show(12)
    first, second = drawing.figure.axes[0].get_title(loc="left").splitlines()
    assert first.startswith("1.2 s, 10.0 m/s: cautious driving")
    assert second == f"{Reason.REGION_OCCUPIED.value} (veh_7)"


def test_metres_are_as_long_in_x_as_in_y(drawing):
    drawing.show(12)
    assert drawing.figure.axes[0].get_aspect() == 1.0


def test_what_the_record_lacks_is_told(recording):
    summary = {name: value for name, value in recording.summary.items() if name not in ("length_m", "width_m")}
    with drawn_in_style():
        drawing = RunDrawing(replace(recording, summary=summary), Shown())
    assert [note.split(":")[0] for note in drawing.notes] == [
        "the record does not hold the size of the ego", "drawn without the roads",
    ]  # fmt: skip


def test_the_body_has_the_size_that_the_record_tells(recording):
    with drawn_in_style():
        drawing = RunDrawing(replace(recording, summary={**recording.summary, "length_m": 12.0, "width_m": 2.5}), Shown())
    drawing.show(12)
    body = drawing.figure.axes[0].patches[-1].get_xy()
    assert np.ptp(body, axis=0) == pytest.approx([12.0, 2.5])
    assert [note.split(":")[0] for note in drawing.notes] == ["drawn without the roads"]


def test_the_field_adds_u_and_its_terms_over_time(recording):
    with drawn_in_style():
        drawing = RunDrawing(recording, Shown(has_field=True))
    values = {line.get_label(): line.get_ydata() for line in drawing.figure.axes[2].lines if line.get_label()[0] == "$"}
    assert [float(np.mean(one)) for one in values.values()] == pytest.approx([0.3, 0.1, 0.2, 0.0])


@pytest.mark.parametrize(("suffix", "begins"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml")])
def test_a_figure_is_the_same_bytes_each_time(recording, tmp_path, suffix, begins):
    written = []
    for name in ("one", "two"):
        with drawn_in_style():
            drawing = RunDrawing(recording, Shown())
            drawing.show(12)
            save_figure(drawing.figure, tmp_path / f"{name}.{suffix}")
        written.append((tmp_path / f"{name}.{suffix}").read_bytes())
    assert written[0] == written[1]
    assert written[0].startswith(begins)


def test_fonts_are_embedded_in_a_pdf(recording, tmp_path):
    with drawn_in_style():
        drawing = RunDrawing(recording, Shown())
        drawing.show(12)
        save_figure(drawing.figure, tmp_path / "a.pdf")
    assert b"/FontFile2" in (tmp_path / "a.pdf").read_bytes()


def test_a_film_shows_the_step_nearest_to_each_frame(recording):
    steps = read_steps(recording)
    assert frames_of(steps, Cut(1.0, 2.0, fps=5)) == [10, 12, 14, 16, 18, 20]
    assert frames_of(steps, Cut(1.0, 2.0, fps=5, speed=2.0)) == [10, 14, 18]
    assert frames_of(steps, Cut(fps=1)) == [0, 10, 20, 30]


@pytest.mark.parametrize("cut", [Cut(2.0, 1.0), Cut(0.0, 9.0), Cut(-1.0, 1.0)])
def test_a_film_of_no_part_of_the_run_is_an_error(recording, cut):
    with pytest.raises(ScenarioError, match="no part of the run"):
        frames_of(read_steps(recording), cut)


def test_a_film_without_end_is_an_error(recording):
    with pytest.raises(ScenarioError, match="more than 20000"):
        frames_of(read_steps(recording), Cut(fps=60, speed=0.01))


@pytest.mark.parametrize(("suffix", "begins"), [("gif", b"GIF89a"), ("mp4", b"ftyp")])
def test_a_film_is_written_frame_by_frame(recording, tmp_path, suffix, begins):
    said, path = [], tmp_path / f"film.{suffix}"
    with drawn_in_style():
        count = write_film(RunDrawing(recording, Shown(dpi=50)), Cut(0.0, 0.4, fps=5), path, said.append)
    assert (count, said) == (3, ["frame 1 of 3", "frame 2 of 3", "frame 3 of 3"])
    assert begins in path.read_bytes()[:12]


def test_a_film_that_breaks_off_leaves_nothing(recording, tmp_path):
    def fail(_):
        raise KeyboardInterrupt

    with drawn_in_style(), pytest.raises(KeyboardInterrupt):
        write_film(RunDrawing(recording, Shown(dpi=50)), Cut(0.0, 0.4, fps=5), tmp_path / "film.mp4", fail)
    assert list(tmp_path.iterdir()) == []
