"""Where SUMO writes trips, how its figures are written, and what means become of several egos, case by case."""

from pathlib import Path

import pytest
from scripted import Domain, script
from trip_rows import EGO, MEANS, PLAIN, ROW, TIMES, trips_of, written

from sumo_reactive.sumo.recount import Driven, Recount, TripFiles, put_right, trip_files


@pytest.mark.parametrize(
    ("trips", "means", "prefix", "files"),
    [
        ("", "", "", (None, None)),
        ("out/t.xml", "", "", ("out/t.xml", None)),
        ("", "s.xml", "", (None, "s.xml")),
        ("out/t.xml", "s.xml", "a_", ("out/a_t.xml", "a_s.xml")),
        ("NUL", "/dev/null", "a_", (None, None)),
        ("nul", "nul.xml", "", (None, "nul.xml")),
    ],
)
def test_files_lie_where_sumo_has_been_told_to_write_them(monkeypatch, trips, means, prefix, files):
    options = {"tripinfo-output": trips, "statistic-output": means, "output-prefix": prefix}
    script(monkeypatch, simulation=Domain(getOption=options))
    assert trip_files() == TripFiles(*(name and Path(name) for name in files))


def used_of(folder, ego, **values):
    """What the ego's row says afterwards, by attribute; its row said `values`."""
    trips = written(folder / "t.xml", trips_of(ROW.format(id="ego", **(PLAIN | values))))
    return {one.attribute: one.used for one in put_right(TripFiles(trips, None), {"ego": ego})}


@pytest.mark.parametrize(
    ("said", "distance", "used"),
    [("900.00", 300.006, "300.01"), ("900", 299.6, "300"), ("900.0", 7.0, "7.0"), ("900.000", 0.0, "0.000")],
)
def test_a_figure_has_as_many_decimals_as_sumos(tmp_path, said, distance, used):
    assert used_of(tmp_path, EGO._replace(distance=distance), length=said) == {"routeLength": used}


@pytest.mark.parametrize(
    ("loss", "stopped", "used"),
    [
        ("01:01:01.50", 1.25, "01:01:00.25"),
        ("01:00:00.00", 0.01, "00:59:59.99"),
        ("01:01:01", 1.4, "01:01:00"),
        ("23:46:40", 40.0, "23:46:00"),
        ("00:00:09.5", 10.0, "00:00:00.0"),
        ("00:10:05.125", 5.0, "00:10:00.125"),
        ("00:01:00.004", 0.0041, "00:01:00.000"),
        ("9.5", 10.0, "0.0"),
        ("00:02:00.00", 0.004, "00:02:00.00"),
    ],
)
def test_a_time_is_written_as_sumo_has_written_it_and_never_below_nothing(tmp_path, loss, stopped, used):
    assert used_of(tmp_path, EGO._replace(stopped=stopped), loss=loss)["timeLoss"] == used


@pytest.mark.parametrize(
    ("said", "duration", "is_same"),
    [
        ("30.00", 30.0059, True), ("30.00", 30.0061, False), ("30.00", 29.9941, True), ("30", 30.59, True),
        ("30", 29.39, False), ("30.0", 30.07, False), ("00:00:30", 30.5, True), ("00:00:30.00", 30.1, False),
    ],
)  # fmt: skip
def test_a_trip_ended_with_the_ego_if_it_lasted_as_long_to_the_decimals_that_are_written(tmp_path, said, duration, is_same):
    used = used_of(tmp_path, EGO._replace(duration=duration), duration=said)["routeLength"]
    assert used == ("300.00" if is_same else "left as counted: SUMO's own driver drove on")


def test_at_a_stop_the_ego_has_neither_waited_nor_lost_time_and_each_figure_is_told(tmp_path):
    trips = written(tmp_path / "t.xml", trips_of(ROW.format(id="ego", **TIMES)))
    found = put_right(TripFiles(trips, None), {"ego": EGO._replace(stopped=0.5)})
    assert found == tuple(
        Recount("t.xml", "ego", *one)
        for one in (
            ("routeLength", "900.00", "300.00"), ("waitingTime", "00:00:14", "00:00:14"),
            ("stopTime", "00:00:00", "00:00:00"), ("timeLoss", "00:01:16.50", "00:01:16.00"),
        )
    )  # fmt: skip


def means_of(folder, egos, rows=None, means=MEANS):
    """What is told of the means, and the file, where the trips have these rows (None: nobody asks for trips)."""
    trips = None if rows is None else written(folder / "t.xml", rows)
    file = written(folder / "s.xml", means)
    found = put_right(TripFiles(trips, file), egos)
    return [one for one in found if one.file == "s.xml"], file.read_text()


def test_means_move_with_every_ego_and_each_is_told(tmp_path):
    egos = {"a": Driven(30.0, 300.0, 10.0), "b": Driven(60.0, 780.0, 0.0)}
    rows = ROW.format(id="a", **PLAIN), ROW.format(id="b", **(PLAIN | {"duration": "60.00"})), ROW.format(id="c", **PLAIN)
    told, text = means_of(tmp_path, egos, trips_of(*rows))
    assert [(one.vehicle, one.attribute, one.sumo, one.used) for one in told] == [
        ("", "routeLength", "500.00", "320.00"),  # 600 m and 120 m less, of four
        ("", "speed", "10.00", "4.50"),  # 20 m/s and 2 m/s less, of four
        ("", "waitingTime", "8.00", "5.50"),
        ("", "timeLoss", "9.00", "6.50"),
    ]
    assert all(one.is_put_right for one in told)
    wanted = 'routeLength="320.00" speed="4.50" duration="40.00" waitingTime="5.50" timeLoss="6.50"'
    assert wanted in text and 'loaded="4"' in text and text.count("\n") == MEANS.count("\n")


def test_an_ego_that_drove_for_no_time_changes_no_mean_beyond_numbers(tmp_path):
    row = ROW.format(id="a", **(PLAIN | {"duration": "0.00"}))
    told, _ = means_of(tmp_path, {"a": Driven(0.0, 899.0, 0.0)}, trips_of(row))
    assert {one.attribute: one.used for one in told} == {"routeLength": "499.75", "speed": "-240.00"}


def test_an_ego_that_is_left_as_counted_moves_no_mean(tmp_path):
    told, text = means_of(tmp_path, {"a": Driven(99.0, 300.0, 0.0)}, trips_of(ROW.format(id="a", **PLAIN)))
    assert (told, text) == ([], MEANS)


@pytest.mark.parametrize("rows", [None, "trip;length\na;900\n"])
def test_means_are_left_and_named_where_no_row_in_xml_tells_of_an_ego(tmp_path, rows):
    told, text = means_of(tmp_path, {"a": Driven(30.0, 300.0, 10.0)}, rows)
    why = "left as counted: no tripinfo-output in XML tells what SUMO has counted of an ego"
    assert told == [Recount("s.xml", "", "routeLength", "500.00", why)]
    assert text == MEANS and not told[0].is_put_right


def test_means_that_are_no_xml_are_left_and_named_too(tmp_path):
    told, text = means_of(tmp_path, {"ego": EGO}, trips_of(ROW.format(id="ego", **PLAIN)), "count;4\n")
    assert (told, text) == ([Recount("s.xml", "", "routeLength", "", "left as counted: not XML")], "count;4\n")
